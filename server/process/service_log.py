"""The service's own log: lines on standard error, of text or of JSON, each with the run and the tick of its moment."""

from __future__ import annotations

import copy
import json
import logging
import logging.handlers
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from queue import Queue
from typing import Any, Literal, NamedTuple, TextIO

from server.texts import one_line, shortened

OUR_LOGGERS = ("becalm", "server", "sim")
"""Whose lines the setting `log_level` chooses; of all others there are warnings and errors only."""

WAITING_LINES = 10_000

LONGEST_MESSAGE = 4_000
LONGEST_TRACEBACK = 20_000
"""Characters of a line; of an exception the last ones."""

TEXT = "%(asctime)s %(levelname)s %(name)s [%(run)s %(tick)s] %(message)s"

MISSION_FIELDS = ("kind", "who", "command", "accepted")
"""What a line about the mission has besides."""


class Moment(NamedTuple):
    """The run and the tick that is flown."""

    run: str | None
    tick: int | None


class ServiceLog:
    """Lines are formatted where they come about and written by a thread of their own: nobody waits for a terminal."""

    def __init__(
        self, level: str, layout: Literal["text", "json"], moment: Callable[[], Moment], stream: TextIO | None = None
    ) -> None:
        """A log that takes nothing yet.

        Args:
            level: least level of Becalm's own lines that is written, such as "info".
            layout: of a line.
            moment: gives where the mission is.
            stream: what is written to; standard error if none.

        """
        formatter = JsonLine() if layout == "json" else TextLine(TEXT)
        self._handler = _Queued(Queue(WAITING_LINES), moment, formatter)
        self._writer = logging.handlers.QueueListener(self._handler.queue, logging.StreamHandler(stream or sys.stderr))
        self._level = logging.getLevelNamesMapping()[level.upper()]

    def start(self) -> None:
        """Take every line of this process from now on."""
        logging.getLogger().addHandler(self._handler)
        for name in OUR_LOGGERS:
            logging.getLogger(name).setLevel(self._level)
        self._writer.start()

    def shutdown(self) -> None:
        """Write what waits, and take no more."""
        logging.getLogger().removeHandler(self._handler)
        for name in OUR_LOGGERS:
            logging.getLogger(name).setLevel(logging.NOTSET)
        self._writer.stop()


class _Queued(logging.handlers.QueueHandler):
    """Puts each line's moment into it, and queues it as it will be written."""

    queue: Queue[logging.LogRecord]

    def __init__(
        self, lines: Queue[logging.LogRecord], moment: Callable[[], Moment], formatter: logging.Formatter
    ) -> None:
        super().__init__(lines)
        self._moment = moment
        self.setFormatter(formatter)

    def prepare(self, record: logging.LogRecord) -> logging.LogRecord:
        now = self._moment()
        for name in Moment._fields:
            setattr(record, name, getattr(record, name, getattr(now, name)))
        return logging.makeLogRecord({"msg": self.format(record)})

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - logging's name
        """A line that finds no room is lost: whoever reads the log does not keep up, and must hold nobody up."""


class TextLine(logging.Formatter):
    """One line of text; what comes with an exception stands below it, each line marked as no line of its own."""

    def format(self, record: logging.LogRecord) -> str:
        """The lines; what another handler made of the exception is not taken over."""
        record = copy.copy(record)
        record.exc_text = None
        return super().format(record)

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - logging's name
        """The line: nothing in a message breaks it, or is obeyed by a terminal."""
        record.message = shortened(record.message, LONGEST_MESSAGE)
        return super().formatMessage(record)

    def formatException(self, ei: Any) -> str:  # noqa: N802 - logging's name
        """The traceback, marked."""
        lines = super().formatException(ei)[-LONGEST_TRACEBACK:].splitlines()
        return "\n".join(f"  | {one_line(line)}" for line in lines)


class JsonLine(logging.Formatter):
    """One JSON document a line."""

    def format(self, record: logging.LogRecord) -> str:
        """The line: `at`, `level`, `logger`, `message`, `run`, `tick`; of the mission's also who asked for what."""
        at = datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
        line = {"at": at, "level": record.levelname.lower(), "logger": record.name, "message": _cut(record)}
        line |= {name: getattr(record, name) for name in (*Moment._fields, *MISSION_FIELDS) if hasattr(record, name)}
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)[-LONGEST_TRACEBACK:]
        return json.dumps(line, default=str)


def _cut(record: logging.LogRecord) -> str:
    message = record.getMessage()
    return message if len(message) <= LONGEST_MESSAGE else shortened(message, LONGEST_MESSAGE)
