"""The service's log: one line each, with its run and tick, and nobody waits for whoever reads it."""

from __future__ import annotations

import io
import json
import logging

import pytest

from server.process.service_log import Moment, ServiceLog


@pytest.fixture
def written():
    """Runs something with a log of these settings; what it wrote."""

    def write(act, log_level="warning", log_format="text") -> str:
        stream = io.StringIO()
        lines = ServiceLog(log_level, log_format, lambda: Moment("run-1", 7), stream)
        lines.start()
        try:
            act()
        finally:
            lines.shutdown()
        return stream.getvalue()

    return write


def test_a_json_line_has_its_run_and_tick(written):
    line = json.loads(written(lambda: logging.getLogger("server.x").warning("late by %d ms", 80), log_format="json"))
    assert line.pop("at").endswith("+00:00")
    assert line == {
        "level": "warning", "logger": "server.x", "message": "late by 80 ms", "run": "run-1", "tick": 7
    }  # fmt: skip


def test_a_line_of_the_mission_knows_better_which_tick_it_is_of(written):
    marks = {"tick": 3, "who": "ana", "command": "hold", "accepted": False}

    def refuse() -> None:
        logging.getLogger("server.mission.live_mission").warning("refused", extra=marks)

    line = json.loads(written(refuse, log_format="json"))
    assert {name: line[name] for name in marks} == marks
    assert line["run"] == "run-1"


def test_an_exception_stays_on_its_line(written):
    def fail() -> None:
        try:
            raise ValueError("no such thing")
        except ValueError:
            logging.getLogger("sim.y").exception("it failed")

    text = written(fail, log_format="json")
    assert text.count("\n") == 1
    assert "ValueError: no such thing" in json.loads(text)["exception"]


def test_level_and_format(written):
    def both() -> None:
        logging.getLogger("server.x").info("a detail")
        logging.getLogger("httpx").info("a request")

    assert written(both) == ""
    text = written(both, log_level="info")
    assert "INFO server.x [run-1 7] a detail" in text
    assert "a request" not in text


def test_nothing_that_is_logged_breaks_its_line_or_is_obeyed(written, monkeypatch):
    name = "x\r\n2026-01-01 ERROR forged\x1b[2J\u2028\ud800"

    def warn() -> None:
        logging.getLogger("server.x").warning("refused: %s", name)
        logging.getLogger("server.x").warning("refused: %s", "y" * 900_000)

    with monkeypatch.context() as without_capture:
        # What pytest captures it sends to its other process, which no lone surrogate survives.
        without_capture.setattr(logging.getLogger(), "handlers", [])
        plain, as_json = written(warn), written(warn, log_format="json")
    first, second = plain.splitlines()
    assert r"x\r\n2026-01-01 ERROR forged\x1b[2J\u2028\ud800" in first
    assert len(second) < 5000
    lines = [json.loads(line) for line in as_json.splitlines()]
    assert [len(line["message"]) < 5000 for line in lines] == [True, True]


def test_lines_of_an_exception_are_marked_as_such(written):
    def fail() -> None:
        try:
            raise ValueError("no\n2026-01-01 INFO forged")
        except ValueError:
            logging.getLogger("sim.y").exception("it failed")

    first, *others = written(fail).splitlines()
    assert "it failed" in first
    assert "ValueError: no" in "".join(others)
    assert [line for line in others if not line.startswith("  | ")] == []
