"""The end of a link's session, which must not hold its process up."""

from __future__ import annotations

import threading
import time

import pytest

from server.link import session
from server.link.session import LinkSession, Transport

PATIENCE = 60.0


@pytest.fixture
def open_session(monkeypatch):
    """A session whose close takes until the event that comes with it, as zenoh's does while it looks a name up."""
    link, answered, closed = LinkSession(Transport()), threading.Event(), threading.Event()
    close = link._session.close

    class Held:
        def close(self) -> None:
            answered.wait(PATIENCE)
            close()
            closed.set()

    monkeypatch.setattr(link, "_session", Held())
    yield link, answered
    answered.set()
    assert closed.wait(PATIENCE)


def test_a_session_that_does_not_close_is_left_to_the_system(open_session, monkeypatch, caplog):
    link, answered = open_session
    monkeypatch.setattr(session, "CLOSING_TIME", 0.1)
    began = time.monotonic()
    assert not link.close()
    assert time.monotonic() - began < PATIENCE / 2
    assert not answered.is_set()
    assert "did not close" in caplog.text


def test_a_session_that_closes_is_waited_for(open_session, caplog):
    link, answered = open_session
    answered.set()
    assert link.close()
    assert caplog.text == ""
