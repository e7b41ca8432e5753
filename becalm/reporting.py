"""`becalm report`: a recorded run, or a study of the service, as one page."""

from __future__ import annotations

from pathlib import Path

from server.errors import StudyNotFound
from server.library.runs import RunStore
from server.reports.blocks import Document
from server.reports.formats import MEDIA_TYPES, ReportFormat, written
from server.reports.run_report import run_document
from server.reports.study_report import study_document
from server.studies.store import StudyStore
from sim.errors import ConfigError, RunNotFound


def format_of(out: Path) -> ReportFormat:
    """By the suffix of the file.

    Raises:
        ConfigError: it names no format of a report.

    """
    for known in MEDIA_TYPES:
        if out.suffix == f".{known}":
            return known
    raise ConfigError(f"--out {out}: write a .html or .pdf")


def report(data: Path, identifier: str, report_format: ReportFormat) -> bytes:
    """The report of the run or study of that data folder.

    Raises:
        RunNotFound: there is neither.
        MissionRefused: the run has recorded nothing yet.

    """
    return written(_document(data, identifier), report_format)


def _document(data: Path, identifier: str) -> Document:
    runs, studies = RunStore(data / "runs"), StudyStore(data / "studies")
    try:
        reader = runs.latest() if identifier == "latest" else runs.read(identifier)
    except RunNotFound:
        if identifier == "latest":
            raise
        try:
            record = studies.record(identifier)
        except StudyNotFound:
            what = f"there is no run or study {identifier!r}"
            raise RunNotFound(what, tip="becalm run flies a run; GET /api/v1/runs and /studies list them") from None
        return study_document(record, studies.rows(record))
    return run_document(reader)
