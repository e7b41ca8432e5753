"""The audit log: who asked for what, from where, and the answer; one JSON document a line."""

from __future__ import annotations

import json
import logging
import logging.handlers
import queue
from datetime import UTC, datetime
from pathlib import Path

LARGEST_FILE = 10_000_000
"""Bytes of a file before the next one is begun."""

OLD_FILES = 9

WAITING_LINES = 10_000


class AuditLog:
    """Lines are written by a thread of their own: a slow disk holds nobody up."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lines: queue.Queue[logging.LogRecord] = queue.Queue(WAITING_LINES)
        self._writer: logging.handlers.QueueListener | None = None

    @property
    def waiting(self) -> int:
        """Lines that wait for the disk."""
        return self._lines.qsize()

    def start(self) -> None:
        """Open the file, which only its owner may read."""
        self._path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._path.touch(mode=0o600)
        file = logging.handlers.RotatingFileHandler(self._path, maxBytes=LARGEST_FILE, backupCount=OLD_FILES)
        self._writer = logging.handlers.QueueListener(self._lines, file)
        self._writer.start()

    def shutdown(self) -> None:
        """Write what waits, and close."""
        if self._writer is None:
            return
        self._writer.stop()
        for handler in self._writer.handlers:
            handler.close()
        self._writer = None

    def write(self, **entry: str | int | None) -> None:
        """Add a line; lost if ten thousand wait already."""
        line = json.dumps({"at": datetime.now(UTC).isoformat(timespec="milliseconds"), **entry})
        try:
            self._lines.put_nowait(logging.makeLogRecord({"msg": line}))
        except queue.Full:
            logging.getLogger(__name__).error("the audit log is behind; lost: %s", line)
