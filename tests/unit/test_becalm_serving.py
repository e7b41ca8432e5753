"""Signals end the service in order, whichever of them come; `nohup` is heeded."""

from __future__ import annotations

import os
import signal

import pytest
import uvicorn

from becalm.ending import ENDING_SIGNALS
from becalm.serving import UNHEEDED_SIGNALS, _Server


@pytest.fixture
def server(monkeypatch):
    again: list[int] = []
    monkeypatch.setattr(signal, "raise_signal", again.append)  # which uvicorn does when all is closed
    before = {number: signal.getsignal(number) for number in (*ENDING_SIGNALS, *UNHEEDED_SIGNALS)}
    yield _Server(uvicorn.Config(lambda: None), lambda: None, lambda: None)
    for number, handler in before.items():
        signal.signal(number, handler)


def sent(server, number: signal.Signals) -> bool:
    """Whether a signal has the server end, which is asked to do so in order."""
    with server.capture_signals():
        os.kill(os.getpid(), number)
        return server.should_exit


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, *ENDING_SIGNALS])
def test_what_ends_it(server, number):
    assert sent(server, number)


@pytest.mark.parametrize("number", UNHEEDED_SIGNALS)
def test_what_does_not(server, number):
    assert not sent(server, number)


def test_a_lost_terminal_is_no_matter_where_nohup_says_so(server):
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    assert not sent(server, signal.SIGHUP)
