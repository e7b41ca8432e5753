"""The results of a study while they come: one SQLite file, from which a study that was cut off goes on.

A cell that was kept survives the end of the process, however it ends. The file belongs to one study, flown by
one version of the code: rows of two versions never meet in one table.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from sim.errors import CaptureError
from sim.study.design import Study
from sim.study.run import Row, columns

_SQL_TYPES = {float: "REAL", int: "INTEGER", bool: "INTEGER", str: "TEXT"}
_NUMERIC_PACKAGES = ("numba", "numpy", "pymunk", "scipy")
_SIM = Path(__file__).parents[1]


class TableUnusable(CaptureError):
    """The file that keeps a study's results cannot be used: another study's, in use, or not writable."""


class StudyTable:
    """The rows of one study, kept as they come; as a context manager it is closed at the end."""

    def __init__(self, path: Path, study: Study) -> None:
        """Open the table, or begin it.

        Raises:
            TableUnusable: another process has it open, it holds something else, or it cannot be written.

        """
        self.path = path
        self.study = study
        self.columns = columns(study)
        with self._told():
            self._rows = sqlite3.connect(path, timeout=0.5, isolation_level=None)
        try:
            with self._told():
                self._begin()
        except BaseException:
            self._rows.close()
            raise
        self._cells = set(self._kept_cells())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self._cells)

    def close(self) -> None:
        """Give the file free; one without a row is removed."""
        self._rows.close()
        if not self._cells:
            self.path.unlink(missing_ok=True)

    def missing(self) -> Iterator[int]:
        """The places of the cells that have no row yet, in order."""
        return (index for index in range(self.study.count) if index not in self._cells)

    def add(self, row: Row) -> None:
        """Keep the row of a cell; a second one of the same cell changes nothing.

        Raises:
            TableUnusable: the file cannot be written, for instance because the disk is full.

        """
        marks = ",".join("?" * len(self.columns))
        with self._told():
            self._rows.execute(
                f"INSERT OR IGNORE INTO cells VALUES ({marks})", [row[column.name] for column in self.columns]
            )
        self._cells.add(row["cell"])

    def rows(self) -> Iterator[dict[str, Any]]:
        """All rows, ordered by cell."""
        flags = [column.name for column in self.columns if column.kind is bool]
        names = [column.name for column in self.columns]
        with closing(self._rows.execute("SELECT * FROM cells ORDER BY cell")) as cursor:
            for values in cursor:
                row = dict(zip(names, values, strict=True))
                for flag in flags:
                    row[flag] = None if row[flag] is None else bool(row[flag])
                yield row

    def _begin(self) -> None:
        # Exclusive: two processes on one file would fly every cell twice.
        for setting in ("locking_mode = EXCLUSIVE", "journal_mode = WAL", "synchronous = NORMAL"):
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
        fields = [f'"{column.name}" {_SQL_TYPES[column.kind]}' for column in self.columns]
        self._rows.execute(f"CREATE TABLE cells ({', '.join(fields)}, PRIMARY KEY (cell))")

    def _another_study(self) -> TableUnusable:
        return TableUnusable(
            f"{self.path} holds the results of an unfinished study that is not this one: its definition, its "
            "configuration or the version of Becalm differs",
            tip="finish that study with its own command, give another --out, or remove the file",
        )

    def _kept_cells(self) -> list[int]:
        return [cell for (cell,) in self._rows.execute("SELECT cell FROM cells")]

    @contextmanager
    def _told(self) -> Iterator[None]:
        """What SQLite refuses, as an error that names the file."""
        try:
            yield
        except sqlite3.Error as error:
            in_use = "locked" in str(error)
            problem = "another process is flying this study" if in_use else f"it cannot be written ({error})"
            tip = "let that one end" if in_use else "make room or give another --out; the rows kept so far stay"
            raise TableUnusable(f"{self.path}: {problem}", tip=tip) from None


def fingerprint(study: Study) -> str:
    """What a study's rows depend on, as one digest: its cells, its configuration and the code that flies them."""
    definition = study.definition()
    del definition["name"], definition["description"]
    parts = [definition, study.base.model_dump(mode="json"), _code(), platform.machine()]
    return hashlib.sha256(json.dumps(parts, sort_keys=False).encode()).hexdigest()


def _code() -> list[str]:
    """The digest of the package `sim`, and the versions of the packages that can change a number."""
    digest = hashlib.sha256()
    for path in sorted(_SIM.rglob("*.py")):
        digest.update(path.relative_to(_SIM).as_posix().encode() + b"\0" + path.read_bytes())
    return [digest.hexdigest(), *(f"{package} {version(package)}" for package in _NUMERIC_PACKAGES)]
