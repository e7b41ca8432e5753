"""The audit log: who asked for what, from where, and the answer; one JSON document a line.

Nobody can wash it out. Who holds a token is logged in one file, who holds none in another, which has a bound of its
own; texts are cut; and of whoever asks too often, what comes more often is counted, not repeated.
"""

from __future__ import annotations

import io
import json
import logging
import logging.handlers
import os
import queue
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from datetime import UTC, datetime
from io import TextIOWrapper
from pathlib import Path
from typing import NamedTuple

from server.access.roles import Role
from server.access.tokens import Holder
from server.texts import shortened

LARGEST_FILE = 10_000_000
"""Bytes of a file before the next one is begun."""

OLD_FILES = 9
OLD_FILES_OF_STRANGERS = 2

WAITING_LINES = 10_000

LONGEST_PATH = 200
LONGEST_WORD = 60
"""Characters of a method or an address."""

OFTEN = 30
"""Lines within the window that one asker gets; what comes beyond is counted."""

WINDOW = 60.0
"""How long it is counted before the count is written [s]."""

ASKERS = 1024
"""Askers that are counted at once; all others are counted together."""

OTHERS = "others"

log = logging.getLogger(__name__)


class _Counted(NamedTuple):
    """What one asker wrote of in this window."""

    began: float
    lines: int
    beyond: dict[str, int]
    """How many came beyond those lines, by method and status."""
    known: bool


class AuditLog:
    """Lines are written by threads of their own: a slow disk holds nobody up."""

    def __init__(self, path: Path, clock: Callable[[], float] = time.monotonic) -> None:
        self._known = _Lines(path, OLD_FILES)
        self._strangers = _Lines(path.with_name("strangers.log"), OLD_FILES_OF_STRANGERS)
        self._clock = clock
        self._askers: OrderedDict[str, _Counted] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def waiting(self) -> int:
        """Lines that wait for the disk."""
        return self._known.waiting + self._strangers.waiting

    def start(self) -> None:
        """Open the files, which only their owner may read."""
        self._known.start()
        self._strangers.start()

    def shutdown(self) -> None:
        """Write what waits and what was counted, and close."""
        self.settle(all_of_them=True)
        self._known.shutdown()
        self._strangers.shutdown()

    def write(
        self, holder: Holder | None, *, who: str | None, role: str | None, address: str, method: str, path: str,
        status: int,
    ) -> None:  # fmt: skip
        """Add a line to the file of those who hold a token, or of strangers; lost if ten thousand wait already.

        Whoever may only watch, or is refused, gets `OFTEN` lines a minute. What operators do has a line each.
        """
        self.settle()
        address = shortened(address, LONGEST_WORD)
        method = shortened(method, LONGEST_WORD)
        trusted = holder is not None and holder.role.covers(Role.OPERATOR) and status < 400
        if trusted or self._has_a_line(holder, who or address, f"{method} {status}"):
            path = shortened(path, LONGEST_PATH)
            self._put(holder is not None, who=who, role=role, address=address, method=method, path=path, status=status)

    def note(self, who: str, *, method: str, path: str, status: int, why: str) -> None:
        """Add a line on what the service did by itself."""
        self._put(True, who=who, method=method, path=path, status=status, why=why)

    def settle(self, *, all_of_them: bool = False) -> None:
        """Write the counts of windows that are over."""
        over = []
        with self._lock:
            now = self._clock()
            while self._askers:
                asker, counted = next(iter(self._askers.items()))
                if now - counted.began < WINDOW and not all_of_them:
                    break
                over.append((asker, self._askers.pop(asker)))
        for asker, counted in over:
            if counted.beyond:
                self._put(counted.known, asker=asker, more=counted.beyond, within=round(now - counted.began, 1))

    def _has_a_line(self, holder: Holder | None, asker: str, what: str) -> bool:
        with self._lock:
            if asker not in self._askers and len(self._askers) >= ASKERS:
                asker = OTHERS
            counted = self._askers.get(asker) or _Counted(self._clock(), 0, {}, holder is not None)
            if counted.lines >= OFTEN:
                what = what if what in counted.beyond or len(counted.beyond) < OFTEN else OTHERS
                counted.beyond[what] = counted.beyond.get(what, 0) + 1
            else:
                counted = counted._replace(lines=counted.lines + 1)
            self._askers[asker] = counted
            return not counted.beyond

    def _put(self, known: bool, **entry: object) -> None:
        line = json.dumps({"at": datetime.now(UTC).isoformat(timespec="milliseconds"), **entry})
        (self._known if known else self._strangers).put(line)


class _Lines:
    """One file and its older ones, written by a thread."""

    def __init__(self, path: Path, old_files: int) -> None:
        self._path = path
        self._old_files = old_files
        self._lines: queue.Queue[logging.LogRecord] = queue.Queue(WAITING_LINES)
        self._writer: logging.handlers.QueueListener | None = None
        self._lost = 0

    @property
    def waiting(self) -> int:
        return self._lines.qsize()

    def start(self) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        file = _OwnersFile(self._path, maxBytes=LARGEST_FILE, backupCount=self._old_files)
        self._writer = logging.handlers.QueueListener(self._lines, file)
        self._writer.start()

    def shutdown(self) -> None:
        if self._writer is None:
            return
        self._writer.stop()
        for handler in self._writer.handlers:
            handler.close()
        self._writer = None

    def put(self, line: str) -> None:
        try:
            self._lines.put_nowait(logging.makeLogRecord({"msg": line}))
        except queue.Full:
            if self._lost % WAITING_LINES == 0:
                log.error("%s is behind: %d lines are lost", self._path.name, self._lost + 1)
            self._lost += 1


class _OwnersFile(logging.handlers.RotatingFileHandler):
    """Only its owner may read it, nor what it is called later."""

    def _open(self) -> TextIOWrapper:
        descriptor = os.open(self.baseFilename, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW, 0o600)
        os.fchmod(descriptor, 0o600)
        return TextIOWrapper(io.FileIO(descriptor, "a"), encoding="utf-8", write_through=True)
