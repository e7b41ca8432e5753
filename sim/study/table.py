"""The results of a study as they come: one SQLite file, from which an interrupted study is resumed.

A row that was kept survives the end of the process, however it ends. The file belongs to one study, flown by
one version of the code: rows of two versions never share a table.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NamedTuple, Self

from sim.errors import CaptureError
from sim.file_lock import ProcessLock
from sim.schema_history import MEASURE_CHANGES, PARAMETER_CHANGES, change_of, former_names
from sim.study.design import Study
from sim.study.run import Column, Row, columns

_SQL_TYPES = {float: "REAL", int: "INTEGER", bool: "INTEGER", str: "TEXT"}
_KINDS: dict[str, Any] = {"REAL": float, "INTEGER": int, "TEXT": str}
_NUMERIC_PACKAGES = ("numba", "numpy", "pymunk", "scipy")
_SIM = Path(__file__).parents[1]

PATIENCE = 5.0
"""How long one connection waits for another that writes [s]."""


class TableUnusable(CaptureError):
    """The file that keeps a study's results cannot be used: another study's, in use, or not writable."""


class KeptRow(NamedTuple):
    """A row, and its place in the order in which rows were kept."""

    sequence: int
    row: dict[str, Any]


class _Stored(NamedTuple):
    """A column as it is read, and the one of the table that it is in."""

    column: Column
    name: str | None
    """None if the table, of an earlier version, has none for it: its values are absent."""


class StudyRows:
    """The rows that a table holds so far; reads them while another thread or process writes, too.

    A table of an earlier version is read by the columns that it has: those renamed since under their current
    names, those that it lacks as absent (None), and after them those that the current version does not know.
    """

    def __init__(self, path: Path, study: Study) -> None:
        self.path = path
        self.study = study

    @property
    def columns(self) -> tuple[Column, ...]:
        """Those of the current version, and those that only this table has.

        Raises:
            TableUnusable: the file is not a table.

        """
        with self._opened() as connection:
            return tuple(stored.column for stored in self._stored(connection))

    def __len__(self) -> int:
        with self._opened() as connection:
            return int(connection.execute("SELECT COUNT(*) FROM cells").fetchone()[0]) if _begun(connection) else 0

    def rows(self, *names: str) -> Iterator[dict[str, Any]]:
        """All rows, ordered by cell, with these columns; with every column if none is named."""
        for kept in self._select(names, order="cell"):
            yield kept.row

    def rows_after(self, sequence: int, limit: int) -> list[KeptRow]:
        """At most `limit` rows that were kept after the row `sequence`, in the order in which they were."""
        return list(self._select((), order="sequence", after=sequence, limit=limit))

    def _select(
        self, names: Sequence[str], order: Literal["sequence", "cell"], after: int = 0, limit: int = -1
    ) -> Iterator[KeptRow]:
        """The rows with these columns, or with all; nothing if the table has not been begun."""
        with self._opened() as connection:
            if not _begun(connection):
                return
            chosen = [each for each in self._stored(connection) if not names or each.column.name in names]
            # With its table before it a name is never taken for a text, as SQLite does with one that is no column.
            wanted = ", ".join("NULL" if each.name is None else f"cells.{_quoted(each.name)}" for each in chosen)
            query = f"SELECT sequence, {wanted} FROM cells WHERE sequence > ? ORDER BY {order} LIMIT ?"
            columns = [each.column for each in chosen]
            for place, *values in connection.execute(query, (after, limit)):
                yield KeptRow(place, _as_row(columns, values))

    @contextmanager
    def _opened(self) -> Iterator[sqlite3.Connection]:
        """The file, to be read only; an empty database if there is none."""
        path: Path | str = self.path if self.path.exists() else ":memory:"
        with _sqlite_errors(self.path), closing(sqlite3.connect(path, timeout=PATIENCE)) as connection:
            connection.execute("PRAGMA query_only = ON")
            yield connection

    def _stored(self, connection: sqlite3.Connection) -> list[_Stored]:
        """The current columns, each with its place in the table, and those that only the table has."""
        todays = columns(self.study)
        if not _begun(connection):
            return [_Stored(column, column.name) for column in todays]
        present = {name: sql_type for _, name, sql_type, *_ in connection.execute("PRAGMA table_info(cells)")}
        del present["sequence"]
        found = [_as_stored(column, present) for column in todays]
        known = {each.name for each in found}
        return found + [_Stored(_foreign(name, present[name]), name) for name in present if name not in known]


def _begun(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'cells'").fetchone() is not None


def _as_stored(column: Column, present: Mapping[str, str]) -> _Stored:
    """A current column in a table with these columns and SQL types; it keeps the type that the table has."""
    names = (column.name, *former_names(column.name, (*MEASURE_CHANGES, *PARAMETER_CHANGES)))
    name = next((each for each in names if each in present), None)
    if name is None or present[name] == _SQL_TYPES[column.kind]:
        return _Stored(column, name)
    return _Stored(column._replace(kind=_KINDS[present[name]]), name)


def _foreign(name: str, sql_type: str) -> Column:
    """A column that the current version does not know."""
    change = change_of(name, MEASURE_CHANGES)
    return Column(name, _KINDS[sql_type], "1", change.why if change else "Of another version of Becalm")


def _quoted(name: str) -> str:
    """A name as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'


class StudyTable(StudyRows):
    """The rows of one study, kept as they come; as a context manager it is closed at the end."""

    def __init__(self, path: Path, study: Study, *, replace: bool = False) -> None:
        """Open the table, or begin it; `replace` drops the rows that it holds.

        Raises:
            TableUnusable: another process has it open, it holds something else, or it cannot be written.

        """
        super().__init__(path, study)
        self._lock = self._locked()
        with ExitStack() as undo:
            undo.callback(self._lock.release, remove=True)
            if replace:
                for suffix in ("", "-wal", "-shm"):
                    path.with_name(path.name + suffix).unlink(missing_ok=True)
            with _sqlite_errors(path):
                self._rows = sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)
                undo.callback(self._rows.close)
                self._begin()
                self._cells = set(self._kept_cells())
            undo.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self._cells)

    def close(self) -> None:
        """Release the file; one without a row is removed."""
        self._rows.close()
        if not self._cells:
            self.path.unlink(missing_ok=True)
        self._lock.release(remove=True)

    def missing(self) -> Iterator[int]:
        """The places of the cells that have no row yet, in order."""
        return (index for index in range(self.study.count) if index not in self._cells)

    def add(self, row: Row) -> None:
        """Keep the row of a cell; a second one of the same cell changes nothing.

        Raises:
            TableUnusable: the file cannot be written, for instance because the disk is full.

        """
        names = [column.name for column in columns(self.study)]
        fields, marks = ", ".join(map(_quoted, names)), ", ".join("?" * len(names))
        with _sqlite_errors(self.path):
            self._rows.execute(
                f"INSERT OR IGNORE INTO cells ({fields}) VALUES ({marks})", [row[name] for name in names]
            )
        self._cells.add(row["cell"])

    def _locked(self) -> ProcessLock:
        """The lock on the file: two processes on one file would fly every cell twice."""
        try:
            return ProcessLock(self.path.with_name(self.path.name + ".lock"))
        except BlockingIOError:
            problem = f"{self.path}: another process is flying this study"
            raise TableUnusable(problem, tip="let that one end") from None
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def _begin(self) -> None:
        for setting in ("journal_mode = WAL", "synchronous = NORMAL"):
            self._rows.execute(f"PRAGMA {setting}")
        self._rows.execute("BEGIN EXCLUSIVE")
        self._rows.execute("CREATE TABLE IF NOT EXISTS study (fingerprint TEXT, definition TEXT)")
        present = self._rows.execute("SELECT fingerprint FROM study").fetchone()
        if present is not None and present[0] != fingerprint(self.study):
            if self._kept_cells():
                raise self._another_study()
            self._rows.execute("DROP TABLE cells")
            self._rows.execute("DELETE FROM study")
            present = None
        if present is None:
            self._create_cells()
        self._rows.execute("COMMIT")

    def _create_cells(self) -> None:
        definition = json.dumps(self.study.definition())
        self._rows.execute("INSERT INTO study VALUES (?, ?)", (fingerprint(self.study), definition))
        fields = [f"{_quoted(column.name)} {_SQL_TYPES[column.kind]}" for column in columns(self.study)]
        self._rows.execute(f"CREATE TABLE cells (sequence INTEGER PRIMARY KEY, {', '.join(fields)}, UNIQUE (cell))")

    def _another_study(self) -> TableUnusable:
        return TableUnusable(
            f"{self.path} holds the results of an unfinished study that is not this one: its definition, its "
            "configuration or the version of Becalm differs",
            tip="finish that study with its own command, give another --out, or remove the file",
        )

    def _kept_cells(self) -> list[int]:
        return [cell for (cell,) in self._rows.execute("SELECT cell FROM cells")]


def _as_row(chosen: Sequence[Column], values: Sequence[Any]) -> dict[str, Any]:
    """What SQLite keeps as whole numbers is true or false again."""
    pairs = zip(chosen, values, strict=True)
    return {column.name: bool(value) if column.kind is bool and value is not None else value for column, value in pairs}


@contextmanager
def _sqlite_errors(path: Path) -> Iterator[None]:
    """Turns SQLite's errors into one that names the file."""
    try:
        yield
    except sqlite3.Error as error:
        raise _unwritable(path, error) from None


def _unwritable(path: Path, error: Exception) -> TableUnusable:
    tip = "make room or give another --out; the rows kept so far stay"
    return TableUnusable(f"{path}: it cannot be used ({error})", tip=tip)


def fingerprint(study: Study) -> str:
    """What a study's rows depend on, as one digest: its cells, its configuration and the code that flies them."""
    definition = study.definition()
    del definition["name"], definition["description"]
    parts = [definition, study.base.model_dump(mode="json"), code_fingerprint(), platform.machine()]
    return hashlib.sha256(json.dumps(parts, sort_keys=False).encode()).hexdigest()


@cache
def code_fingerprint() -> tuple[str, ...]:
    """The digest of the package `sim`, and the versions of the packages that can change a number."""
    digest = hashlib.sha256()
    for path in sorted(_SIM.rglob("*.py")):
        digest.update(path.relative_to(_SIM).as_posix().encode() + b"\0" + path.read_bytes())
    return (digest.hexdigest(), *(f"{package} {version(package)}" for package in _NUMERIC_PACKAGES))
