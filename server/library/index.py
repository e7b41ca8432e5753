"""The index of the library: what runs are found and ordered by, in one SQLite file beside their folders.

The folders are the truth. The index is brought up to date before every search, by the times at which records and
remarks were last written; one of another schema, or a damaged one, is rebuilt from them. Nothing is lost with it.
"""

from __future__ import annotations

import json
import logging
import os
import sqlite3
import threading
import time
import zlib
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

from server.errors import StoredUnreadable
from server.instants import instant
from server.library.changes import EDITED, changes_of
from server.library.folder import RECORD_NAME, REMARKS_NAME
from server.library.record import Remarks, RunKind, RunRecord, RunStatus
from server.library.runs import RUN_ID, RunStore
from server.texts import one_line
from sim.errors import ConfigError, RunNotFound
from sim.schema_history import PARAMETER_CHANGES, RECORD_CHANGES
from sim.snapshot import OutcomeClass

FILE_NAME = "index.sqlite"
PATIENCE = 0.25
"""How long a search waits for another process that has the index [s]."""

REST = 30.0
"""How long the file is left alone when it could not be had [s]."""

SETTLING = 60.0
"""Age from which on a folder without a record is reported [s]."""

log = logging.getLogger(__name__)

SortKey = Literal[
    "started",
    "name",
    "kind",
    "status",
    "configuration",
    "changes",
    "seed",
    "initial_spin",
    "duration",
    "outcome",
    "at_first_closure",
    "peak_tip_force",
    "cage_margin",
    "final_target_spin",
    "size",
]
_WORDS = ("name", "kind", "status", "configuration", "changes", "outcome", "at_first_closure")
"""Sort keys that are texts."""

_TABLE = """
CREATE TABLE runs (
    id TEXT PRIMARY KEY, stamp TEXT NOT NULL, unreadable TEXT, settled INTEGER NOT NULL,
    kind TEXT, status TEXT, outcome TEXT, at_first_closure TEXT, configuration TEXT, changes TEXT, parent TEXT,
    starred INTEGER, name TEXT, tags TEXT, started TEXT, words TEXT, seed REAL, initial_spin REAL,
    duration REAL, peak_tip_force REAL, cage_margin REAL, final_target_spin REAL, size INTEGER
) STRICT
"""
_COLUMNS = (
    "id", "stamp", "unreadable", "settled", "kind", "status", "outcome", "at_first_closure", "configuration", "changes",
    "parent", "starred", "name", "tags", "started", "words", "seed", "initial_spin", "duration", "peak_tip_force",
    "cage_margin", "final_target_spin", "size",
)  # fmt: skip


@cache
def index_version() -> int:
    """A digest of what the index follows from: its table, what a record holds, and how earlier ones are read.

    An index of another version is made from the folders again: what could not be read then may be readable now.
    """
    parts = [_TABLE, RunRecord.model_json_schema(), PARAMETER_CHANGES, RECORD_CHANGES]
    return zlib.crc32(json.dumps(parts).encode()) & 0x7FFF_FFFF  # SQLite keeps 32 bits with a sign


@dataclass(frozen=True)
class RunQuery:
    """Which runs, and in which order; None asks for nothing."""

    kind: RunKind | None = None
    status: RunStatus | None = None
    outcome: OutcomeClass | None = None
    at_first_closure: OutcomeClass | None = None
    tag: str | None = None
    configuration: str | None = None
    parent: str | None = None
    starred: bool | None = None
    text: str | None = None
    """Words, in any case, each of which has to be found: in identifier, name, tags, notes, configuration or changes."""
    started_from: datetime | None = None
    """Without a time zone: UTC."""
    started_to: datetime | None = None
    sort: SortKey = "started"
    ascending: bool = False


class Found(NamedTuple):
    """A page of a search."""

    ids: list[str]
    following: str | None
    """The last of them, if there are more."""
    total: int
    """How many fit, on all pages."""


class RunIndex:
    """Finds runs. Safe from any thread; several processes may share it."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._path = store.root / FILE_NAME
        self._lock = threading.Lock()
        self._memory: sqlite3.Connection | None = None
        self._file_from = 0.0

    def find(self, query: RunQuery, limit: int, after: str | None = None, skipped: int = 0) -> Found:
        """The runs that fit, at most `limit` of those that come after the run `after`, so many skipped.

        Raises:
            ConfigError: `after` is no longer there, so that its place in this order is not known.

        """
        with self._fresh() as rows:
            conditions, values = _conditions(query)
            total = rows.execute(f"SELECT COUNT(*) FROM runs WHERE {' AND '.join(conditions)}", values).fetchone()[0]
            key = _sort_expression(query)
            if after is not None:
                comparison = ">" if query.ascending else "<"
                conditions.append(f"({key}, id) {comparison} (?, ?)")
                values += [self._key_of(rows, query, key, after), after]
            direction = "ASC" if query.ascending else "DESC"
            where = " AND ".join(conditions)
            found = rows.execute(
                f"SELECT id FROM runs WHERE {where} ORDER BY {key} {direction}, id {direction} LIMIT ? OFFSET ?",
                [*values, limit + 1, skipped],
            )
            ids = [name for (name,) in found]
        return Found(ids[:limit], ids[limit - 1] if len(ids) > limit else None, total)

    def tally(self) -> dict[tuple[RunKind, RunStatus, OutcomeClass | None], int]:
        """How many readable runs there are of each kind, status and outcome."""
        with self._fresh() as rows:
            found = rows.execute(
                "SELECT kind, status, outcome, COUNT(*) FROM runs WHERE kind IS NOT NULL GROUP BY 1, 2, 3"
            )
            return {(kind, status, outcome): count for kind, status, outcome, count in found}

    def unreadable(self) -> dict[str, str]:
        """What cannot be read, and why, by the folder's name: runs, and the stars and notes of runs that can."""
        with self._fresh() as rows:
            found = rows.execute("SELECT id, unreadable FROM runs WHERE unreadable IS NOT NULL ORDER BY id")
            return dict(found.fetchall())

    def _key_of(self, rows: sqlite3.Connection, query: RunQuery, key: str, run_id: str) -> Any:
        if query.sort == "started":
            return run_id
        found = rows.execute(f"SELECT {key} FROM runs WHERE id = ?", [run_id]).fetchone()
        if found is None:
            raise ConfigError(f"cursor = {run_id!r}: that run is gone", tip="begin with the first page again")
        return found[0]

    @contextmanager
    def _fresh(self) -> Iterator[sqlite3.Connection]:
        """The index, up to date, for one search at a time."""
        with self._lock:
            rows = self._in_file() if time.monotonic() >= self._file_from else None
            if rows is None:
                yield self._in_memory()
                return
            with closing(rows):
                yield rows
                with suppress(
                    sqlite3.OperationalError
                ):  # somebody else reads it: it is brought up to date another time
                    rows.execute("COMMIT")

    def _in_file(self) -> sqlite3.Connection | None:
        """The index that is kept, within a transaction; None for a while if it cannot be had now."""
        try:
            return self._opened()
        except sqlite3.OperationalError as error:
            why: object = error
        except sqlite3.DatabaseError:  # damaged
            try:
                self._path.unlink(missing_ok=True)
                return self._opened()
            except (OSError, sqlite3.Error) as error:
                why = error
        log.warning("%s cannot be used (%s): runs are found without it for %.0f s", self._path, why, REST)
        self._file_from = time.monotonic() + REST
        return None

    def _opened(self) -> sqlite3.Connection:
        rows = sqlite3.connect(self._path, timeout=PATIENCE, isolation_level=None, check_same_thread=False)
        try:
            rows.execute("BEGIN IMMEDIATE")
            self._refresh(rows)
        except BaseException:
            rows.close()
            raise
        return rows

    def _in_memory(self) -> sqlite3.Connection:
        """An index of this process's own, which nobody else can hold up."""
        if self._memory is None:
            self._memory = sqlite3.connect(":memory:", isolation_level=None, check_same_thread=False)
        self._refresh(self._memory)
        return self._memory

    def _refresh(self, rows: sqlite3.Connection) -> None:
        if rows.execute("PRAGMA user_version").fetchone()[0] != index_version():
            rows.execute("DROP TABLE IF EXISTS runs")
            rows.execute(_TABLE)
            rows.execute(f"PRAGMA user_version = {index_version()}")
        known = {name: (stamp, settled) for name, stamp, settled in rows.execute("SELECT id, stamp, settled FROM runs")}
        present = {one_line(name): (name, stamp) for name, stamp in self._present()}
        for name in known.keys() - present.keys():
            rows.execute("DELETE FROM runs WHERE id = ?", [name])
        marks = ", ".join("?" * len(_COLUMNS))
        for shown, (name, stamp) in present.items():
            if known.get(shown) == (stamp, 1):
                continue
            entry = self._entry(name, stamp)
            if entry is not None:
                rows.execute(
                    f"INSERT OR REPLACE INTO runs VALUES ({marks})", [entry.get(column) for column in _COLUMNS]
                )

    def _present(self) -> Iterator[tuple[str, str]]:
        """(name, stamp) of everything in the library that is, or should be, the folder of a run."""
        with os.scandir(self._store.root) as entries:
            found = [entry for entry in entries if entry.name[0] != "."]
            names = [
                entry.name for entry in found if RUN_ID.fullmatch(entry.name) or entry.is_dir(follow_symlinks=False)
            ]
        for name in names:
            folder = self._store.root / name
            record = _stamp(folder / RECORD_NAME)
            if record is not None or not _is_new(folder):
                yield name, f"{record} {_stamp(folder / REMARKS_NAME)}"

    def _entry(self, name: str, stamp: str) -> dict[str, Any] | None:
        """The row of a run; None if it has just gone. What has not ended is looked at again every time."""
        row = {"id": one_line(name), "stamp": stamp}  # a name may be bytes that are no text
        try:
            reader = self._store.read(name)
            facts = _facts(reader.record, reader.remarks)
            return {**row, **facts, "unreadable": reader.remarks_damage, "size": reader.size}
        except RunNotFound:
            why = _why_no_run(self._store.root / name)
            return None if why is None else {**row, "unreadable": why, "settled": 0}
        except StoredUnreadable as error:
            # What the system refuses may be allowed later, and no stamp would show it.
            return {**row, "unreadable": str(error), "settled": int(not isinstance(error.__cause__, OSError))}
        except Exception as error:  # one folder, whatever is in it, must not take the others along
            log.exception("run %s cannot be read", name)
            return {**row, "unreadable": f"{type(error).__name__}: {error}", "settled": 0}


def _stamp(path: Path) -> str | None:
    """When a file was last changed, or why that cannot be said; None if it is not there."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return "link" if path.is_symlink() else None
    except OSError as error:
        return str(error.strerror)
    return f"{found.st_mtime_ns}-{found.st_ctime_ns}"


def _is_new(folder: Path) -> bool:
    """Whether a folder may just be coming or going: its record is written last and removed first."""
    try:
        return folder.is_dir() and time.time() - folder.stat().st_mtime < SETTLING
    except OSError:
        return False


def _why_no_run(path: Path) -> str | None:
    """Why something that stands in the library is no run; None if it is gone, or is one by now."""
    if not RUN_ID.fullmatch(path.name):
        return "its name is no identifier of a run: rename it back, or keep it somewhere else"
    if path.is_symlink() and not path.exists():
        return "it is a link that leads nowhere"
    if path.exists() and not path.is_dir():
        return "it is no folder"
    return f"it holds no {RECORD_NAME}" if path.is_dir() and not (path / RECORD_NAME).exists() else None


def _facts(record: RunRecord, remarks: Remarks) -> dict[str, Any]:
    outcome, changes = record.outcome, changes_of(record)
    changed = [f"{each.path} {each.title} {each.value}" for each in changes]
    noted = [note.text for note in remarks.notes]
    words = [record.id, record.configuration, remarks.name, *remarks.tags, record.note or "", *noted, *changed]
    return {
        "settled": int(record.ended and record.integrity is not None),
        "kind": record.kind,
        "status": record.status,
        "outcome": outcome.outcome.value if outcome else None,
        "at_first_closure": outcome.at_first_closure.value if outcome else None,
        "configuration": record.configuration,
        "changes": " ".join(f"{each.path} {each.value}" for each in changes) or None,
        "parent": record.parent,
        "starred": int(remarks.starred),
        "name": remarks.name.lower() or None,
        "tags": "".join(f"\n{tag.lower()}\n" for tag in remarks.tags),
        "seed": float(record.config.simulation.seed),
        "initial_spin": record.config.target.initial_spin,
        "started": _comparable(instant(record.started)),
        "words": "\n".join(words).lower(),
        "duration": record.duration,
        "peak_tip_force": outcome.peak_tip_force if outcome else None,
        "cage_margin": outcome.cage_margin if outcome else None,
        "final_target_spin": outcome.final_target_spin if outcome else None,
    }


def _conditions(query: RunQuery) -> tuple[list[str], list[Any]]:
    """What SQL asks of a row, and the values in it."""
    wishes = (
        ("kind = ?", query.kind),
        ("status = ?", query.status),
        ("outcome = ?", query.outcome.value if query.outcome else None),
        ("at_first_closure = ?", query.at_first_closure.value if query.at_first_closure else None),
        ("instr(tags, ?) > 0", None if query.tag is None else f"\n{query.tag.strip().lower()}\n"),
        (f"configuration IN (?1, ?1 || '{EDITED}')", query.configuration),
        ("parent = ?", query.parent),
        ("starred = ?", None if query.starred is None else int(query.starred)),
        *(("instr(words, ?) > 0", word) for word in (query.text or "").lower().split()),
        ("started >= ?", _comparable(query.started_from)),
        ("started <= ?", _comparable(query.started_to)),
    )
    asked = [(condition, value) for condition, value in wishes if value is not None]
    conditions, values = ["kind IS NOT NULL"], []
    for condition, value in asked:
        conditions.append(condition.replace("?1", "?"))
        values += [value] * condition.count("?")
    return conditions, values


def _comparable(moment: datetime | None) -> str | None:
    """A moment as a text that sorts by time."""
    if moment is None:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).astimezone(UTC).isoformat(timespec="microseconds")


def _sort_expression(query: RunQuery) -> str:
    """What rows are ordered by; runs without it come last, whichever way."""
    if query.sort == "started":
        return "id"
    if query.sort in _WORDS:
        return f"COALESCE({query.sort}, '{'~' if query.ascending else ''}')"
    return f"COALESCE({query.sort}, {'9e999' if query.ascending else '-9e999'})"
