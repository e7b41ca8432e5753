"""The index of the library: what runs are found and ordered by, in one SQLite file beside their folders.

The folders are the truth. The index is brought up to date before every search, by the times at which records and
remarks were last written; one of another schema, or a damaged one, is made anew from them. Nothing is lost with it.
"""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from pydantic import ValidationError

from server.run_changes import changes_of
from server.run_folder import RECORD_NAME, REMARKS_NAME, RunKind, RunRecord, RunStatus, read_remarks
from server.runs import RUN_ID, RunStore
from sim.capture.snapshot import OutcomeClass
from sim.errors import ConfigError, RunNotFound

SCHEMA = 2
"""Raised with every change of the table; an index of another one is made anew."""

FILE_NAME = "index.sqlite"
PATIENCE = 5.0
"""How long one connection waits for another that writes [s]."""

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
    started_from: str | None = None
    started_to: str | None = None
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

    def find(self, query: RunQuery, limit: int, after: str | None = None) -> Found:
        """The runs that fit, at most `limit` of those that come after the run `after`.

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
                f"SELECT id FROM runs WHERE {where} ORDER BY {key} {direction}, id {direction} LIMIT ?",
                [*values, limit + 1],
            )
            ids = [name for (name,) in found]
        return Found(ids[:limit], ids[limit - 1] if len(ids) > limit else None, total)

    def tally(self) -> dict[tuple[RunKind, RunStatus, OutcomeClass | None], int]:
        """How many readable runs there are of each kind, status and outcome."""
        with self._fresh() as rows:
            found = rows.execute(
                "SELECT kind, status, outcome, COUNT(*) FROM runs WHERE unreadable IS NULL GROUP BY 1, 2, 3"
            )
            return {(kind, status, outcome): count for kind, status, outcome, count in found}

    def unreadable(self) -> dict[str, str]:
        """Why a folder holds a run of another version, or a damaged record, by its identifier."""
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

    def _fresh(self) -> closing[sqlite3.Connection]:
        """A connection to the index, up to date."""
        with self._lock:
            self._store.root.mkdir(parents=True, exist_ok=True)
            try:
                rows = self._opened(str(self._path))
            except sqlite3.OperationalError:  # the disk is full or read-only: for this once, in memory
                rows = self._opened(":memory:")
            except sqlite3.DatabaseError:  # damaged
                self._path.unlink(missing_ok=True)
                rows = self._opened(str(self._path))
        return closing(rows)

    def _opened(self, path: str) -> sqlite3.Connection:
        rows = sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)
        try:
            rows.execute("BEGIN IMMEDIATE")
            if rows.execute("PRAGMA user_version").fetchone()[0] != SCHEMA:
                rows.execute("DROP TABLE IF EXISTS runs")
                rows.execute(_TABLE)
                rows.execute(f"PRAGMA user_version = {SCHEMA}")
            self._refresh(rows)
            rows.execute("COMMIT")
        except BaseException:
            rows.close()
            raise
        return rows

    def _refresh(self, rows: sqlite3.Connection) -> None:
        known = {name: (stamp, settled) for name, stamp, settled in rows.execute("SELECT id, stamp, settled FROM runs")}
        present = dict(self._present())
        for name in known.keys() - present.keys():
            rows.execute("DELETE FROM runs WHERE id = ?", [name])
        marks = ", ".join("?" * len(_COLUMNS))
        for name, stamp in present.items():
            if known.get(name) == (stamp, 1):
                continue
            entry = self._entry(name, stamp)
            if entry is not None:
                rows.execute(
                    f"INSERT OR REPLACE INTO runs VALUES ({marks})", [entry.get(column) for column in _COLUMNS]
                )

    def _present(self) -> Iterator[tuple[str, str]]:
        """(identifier, stamp) of every folder of a run."""
        with os.scandir(self._store.root) as folders:
            names = [folder.name for folder in folders if RUN_ID.fullmatch(folder.name)]
        for name in names:
            folder = self._store.root / name
            if (written := _written(folder / RECORD_NAME)) is not None:
                yield name, f"{written} {_written(folder / REMARKS_NAME)}"

    def _entry(self, name: str, stamp: str) -> dict[str, Any] | None:
        """The row of a run; None if it has just gone. What has not ended is looked at again every time."""
        try:
            reader = self._store.read(name)
        except RunNotFound:
            return None
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(map(str, first["loc"])) or RECORD_NAME
            why = f"its record is damaged or of another version: {where}: {first['msg']}"
            return {"id": name, "stamp": stamp, "unreadable": why, "settled": 1}
        return {"id": name, "stamp": stamp, **_facts(reader.record, self._store.root / name), "size": reader.size}


def _written(path: Path) -> int | None:
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:
        return None


def _facts(record: RunRecord, folder: Path) -> dict[str, Any]:
    remarks = read_remarks(folder)
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
        "started": record.started,
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
        ("configuration IN (?1, ?1 || ' (edited)')", query.configuration),
        ("parent = ?", query.parent),
        ("starred = ?", None if query.starred is None else int(query.starred)),
        *(("instr(words, ?) > 0", word) for word in (query.text or "").lower().split()),
        ("started >= ?", query.started_from),
        ("started <= ?", query.started_to),
    )
    asked = [(condition, value) for condition, value in wishes if value is not None]
    conditions, values = ["unreadable IS NULL"], []
    for condition, value in asked:
        conditions.append(condition.replace("?1", "?"))
        values += [value] * condition.count("?")
    return conditions, values


def _sort_expression(query: RunQuery) -> str:
    """What rows are ordered by; runs without it come last, whichever way."""
    if query.sort == "started":
        return "id"
    if query.sort in _WORDS:
        return f"COALESCE({query.sort}, '{'~' if query.ascending else ''}')"
    return f"COALESCE({query.sort}, {'9e999' if query.ascending else '-9e999'})"
