"""The studies of the service: a folder each, newest first.

study.json    `StudyRecord`: definition, status, versions; replaced whole, never half-written
rows.sqlite   the table of the cells, a row as each ends (`sim.study.table`)
"""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, JsonValue, field_validator

from server.errors import StoredUnreadable, StudyNotFound
from server.files import read_document, remove_folder, replace_file
from server.instants import instant, wall_clock
from server.library.runs import new_run_id
from server.texts import shortened
from server.versions import versions
from sim.snapshot import FrozenMessage
from sim.study.design import Study, definition_of_today, study_of
from sim.study.table import StudyRows

StudyStatus = Literal["queued", "running", "finished", "failed", "cancelled"]

RECORD_NAME = "study.json"
TABLE_NAME = "rows.sqlite"

_ID = re.compile(r"\d{8}T\d{9}-[0-9a-f]{6}")


class StudyRecord(FrozenMessage):
    """What study.json holds."""

    id: str
    name: str
    status: StudyStatus
    definition: dict[str, JsonValue] = Field(description="As a study file holds it")
    cells: int = Field(description="How many it has")
    created: str = Field(description="ISO 8601, UTC")
    ended: str | None = Field(None, description="ISO 8601, UTC; of the last end, if it was begun again")
    done: int = Field(0, description="Cells with a row, when the record was last written")
    wall_time: float = Field(0.0, description="Flown until then, over all beginnings [s]")
    note: str | None = Field(None, description="Why it failed")
    versions: dict[str, str] = Field(default_factory=versions)
    notices: tuple[str, ...] = Field(
        (), exclude=True, description="What this version ignores of what an earlier one stored, and why"
    )

    @field_validator("created")
    @classmethod
    def _an_instant(cls, value: str) -> str:
        instant(value)
        return value

    @property
    def study(self) -> Study:
        """The study itself.

        Raises:
            ConfigError: this version of Becalm has no such study.

        """
        return study_of(self.definition, stored=True)

    @property
    def ended_already(self) -> bool:
        """Whether nothing flies or waits."""
        return self.status not in ("queued", "running")


def _of_today(stored: Any) -> Any:
    """A study's record of any version, with its definition under the names of today.

    Raises:
        ConfigError: it is of a later version.

    """
    if not isinstance(stored, dict) or not isinstance(stored.get("definition"), dict):
        return stored
    definition = definition_of_today(stored["definition"])
    return {**stored, "definition": definition.values, "notices": definition.notices}


class StudyStore:
    """The studies under one folder. Safe from any thread."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._lock = threading.Lock()
        """Held while a record is changed, from reading to writing it."""

    def make_root(self) -> Self:
        """Make the folder of all studies, if it is not there; at a start only: one that goes later has been lost."""
        self.root.mkdir(parents=True, exist_ok=True)
        return self

    def create(self, study: Study) -> StudyRecord:
        """A new study that waits to be flown.

        Raises:
            FileNotFoundError: the folder of all studies is gone.

        """
        record = StudyRecord(
            id=new_run_id(),
            name=study.name,
            status="queued",
            definition=study.definition(),
            cells=study.count,
            created=wall_clock(),
        )
        folder = self.root / record.id
        folder.mkdir()
        try:
            self._write(record)
        except BaseException:
            remove_folder(folder, RECORD_NAME)
            raise
        return record

    def record(self, study_id: str) -> StudyRecord:
        """The record of this study.

        Raises:
            StudyNotFound: there is none with that identifier.
            StoredUnreadable: it is damaged, of another version or another study, or not permitted.

        """
        try:
            record = read_document(self._folder(study_id) / RECORD_NAME, StudyRecord, upgrade=_of_today)
        except FileNotFoundError:
            raise _not_found(study_id) from None
        if record.id != study_id:
            what = f"{RECORD_NAME} is that of study {shortened(record.id)}, of which this folder seems to be a copy"
            raise StoredUnreadable(what, tip="rename the folder to that identifier if it is the only one, or remove it")
        return record

    def revise(self, study_id: str, **changes: Any) -> StudyRecord:
        """Change the record, on disk as well."""
        with self._lock:
            record = self.record(study_id).model_copy(update=changes)
            self._write(record)
        return record

    def newest(self, *, before: str | None = None) -> Iterator[StudyRecord]:
        """The studies, newest first, of those older than the study `before`."""
        for name in self._names():
            if before is None or name < before:
                try:
                    yield self.record(name)
                except (StudyNotFound, StoredUnreadable):
                    continue  # deleted since, or listed by `unreadable`

    def unreadable(self) -> dict[str, str]:
        """Why a folder holds no study that this version can read, by its name."""
        found = {}
        for name in self._names():
            try:
                self.record(name)
            except StudyNotFound:
                if not (self.root / name).is_dir():
                    found[name] = "it is no folder"
            except StoredUnreadable as error:
                found[name] = str(error)
        return found

    def _names(self) -> list[str]:
        """Of the folders, newest first."""
        names = [path.name for path in self.root.glob("*")] if self.root.exists() else []
        return sorted(filter(_ID.fullmatch, names), reverse=True)

    def table_path(self, study_id: str) -> Path:
        """The file of its rows."""
        return self._folder(study_id) / TABLE_NAME

    def rows(self, record: StudyRecord) -> StudyRows:
        """What is there of its table."""
        return StudyRows(self.table_path(record.id), record.study)

    def delete(self, study_id: str) -> None:
        """Remove a study with all its rows."""
        remove_folder(self._folder(study_id), RECORD_NAME)

    def _write(self, record: StudyRecord) -> None:
        """After a crash there is the old record or the new one."""
        replace_file(self.root / record.id / RECORD_NAME, record.model_dump_json(indent=2).encode())

    def _folder(self, study_id: str) -> Path:
        folder = self.root / study_id
        if not _ID.fullmatch(study_id) or not folder.is_dir():
            raise _not_found(study_id)
        return folder


def _not_found(study_id: str) -> StudyNotFound:
    return StudyNotFound(f"study {study_id!r} does not exist", tip="GET /api/v1/studies lists the studies")
