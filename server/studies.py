"""The studies of the service: a folder each, newest first.

study.json    `StudyRecord`: definition, status, versions; replaced whole, never half-written
rows.sqlite   the table of the cells, a row as each ends (`sim.study.table`)
"""

from __future__ import annotations

import logging
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, JsonValue, ValidationError

from server.files import replace_file
from server.problems import StudyNotFound
from server.run_folder import wall_clock
from server.runs import new_run_id
from server.versions import versions
from sim.capture.snapshot import Published
from sim.study.design import Study, study_of
from sim.study.table import StudyRows

StudyStatus = Literal["queued", "running", "finished", "failed", "cancelled"]

RECORD_NAME = "study.json"
TABLE_NAME = "rows.sqlite"

_ID = re.compile(r"\d{8}T\d{9}-[0-9a-f]{6}")

log = logging.getLogger(__name__)


class StudyRecord(Published):
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

    @property
    def study(self) -> Study:
        """The study itself.

        Raises:
            ConfigError: this version of Becalm has no such study.

        """
        return study_of(self.definition)

    @property
    def ended_already(self) -> bool:
        """Whether nothing flies or waits."""
        return self.status not in ("queued", "running")


class StudyStore:
    """The studies under one folder. Safe from any thread."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def create(self, study: Study) -> StudyRecord:
        """A new study that waits to be flown."""
        record = StudyRecord(
            id=new_run_id(),
            name=study.name,
            status="queued",
            definition=study.definition(),
            cells=study.count,
            created=wall_clock(),
        )
        (self.root / record.id).mkdir(parents=True)
        self._write(record)
        return record

    def record(self, study_id: str) -> StudyRecord:
        """The record of this study.

        Raises:
            StudyNotFound: there is none with that identifier.

        """
        try:
            return StudyRecord.model_validate_json((self._folder(study_id) / RECORD_NAME).read_bytes())
        except FileNotFoundError:
            raise _not_found(study_id) from None

    def revise(self, study_id: str, **changes: Any) -> StudyRecord:
        """Change the record, on disk as well."""
        record = self.record(study_id).model_copy(update=changes)
        self._write(record)
        return record

    def newest(self, *, before: str | None = None) -> Iterator[StudyRecord]:
        """The studies, newest first, of those older than the study `before`."""
        names = (path.name for path in self.root.glob("*") if _ID.fullmatch(path.name)) if self.root.exists() else ()
        for name in sorted(names, reverse=True):
            if before is None or name < before:
                try:
                    yield self.record(name)
                except StudyNotFound:
                    continue  # deleted since
                except ValidationError:
                    log.warning("study %s is of another version of Becalm and is left out", name)

    def table_path(self, study_id: str) -> Path:
        """The file of its rows."""
        return self._folder(study_id) / TABLE_NAME

    def rows(self, record: StudyRecord) -> StudyRows:
        """What is there of its table."""
        return StudyRows(self.table_path(record.id), record.study)

    def delete(self, study_id: str) -> None:
        """Remove a study with all its rows."""
        folder = self._folder(study_id)
        (folder / RECORD_NAME).unlink(missing_ok=True)  # first, so that what is half removed is no study any more
        shutil.rmtree(folder, ignore_errors=True)

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
