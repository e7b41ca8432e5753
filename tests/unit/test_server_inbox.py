"""The inbox: bounded, STOP beside it, and nothing done for who has given up."""

from __future__ import annotations

import pytest

from server.errors import ServiceBusy
from server.mission.inbox import CAPACITY, Inbox, Request
from sim.errors import MissionRefused


def test_requests_come_out_in_order():
    inbox = Inbox()
    for command in ("pause", "run", "hold"):
        inbox.put(Request(command))
    assert [request.command for request, _ in inbox.requests()] == ["pause", "run", "hold"]
    assert list(inbox.requests()) == []
    assert inbox.wake.is_set()


def test_it_is_bounded_but_for_stop():
    inbox = Inbox()
    for _ in range(CAPACITY):
        inbox.put(Request("hold"))
    with pytest.raises(ServiceBusy, match=str(CAPACITY)):
        inbox.put(Request("hold"))
    inbox.put(Request("stop"))
    assert [request.command for request, _ in inbox.stops()] == ["stop"]
    assert inbox.stops() == []


def test_what_was_given_up_is_not_done():
    inbox = Inbox()
    inbox.put(Request("capture")).cancel()
    inbox.put(Request("hold"))
    assert [request.command for request, _ in inbox.requests()] == ["hold"]


def test_a_stop_is_obeyed_even_if_nobody_waits_for_its_answer():
    inbox = Inbox()
    inbox.put(Request("stop")).cancel()
    ((request, answer),) = inbox.stops()
    assert request.command == "stop"
    assert answer.cancelled()


def test_refuse_all():
    inbox = Inbox()
    waiting, given_up = inbox.put(Request("hold")), inbox.put(Request("stop"))
    given_up.cancel()
    inbox.refuse_all(ServiceBusy("ending"))
    with pytest.raises(ServiceBusy, match="ending"):
        waiting.result(0)


def test_nothing_more_is_taken_once_a_stop_is_asked_for():
    inbox = Inbox()
    for command in ("pause", "reset", "capture"):
        inbox.put(Request(command))
    taken = []
    for request, _ in inbox.requests():
        taken.append(request.command)
        inbox.put(Request("stop"))
    assert taken == ["pause"]
    assert len(inbox.stops()) == 1


def test_what_waits_when_a_stop_comes_is_refused():
    inbox = Inbox()
    waiting = [inbox.put(Request(command)) for command in ("reset", "capture")]
    inbox.put(Request("stop"))
    inbox.refuse_requests(MissionRefused("a STOP came first"))
    assert all(isinstance(answer.exception(timeout=0), MissionRefused) for answer in waiting)
    assert list(inbox.requests()) == []
    assert len(inbox.stops()) == 1
