"""What the reports of runs, studies and fits have in common over REST."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Query, Response

from server.reports.formats import MEDIA_TYPES, ReportFormat

FormatOfReport = Annotated[ReportFormat, Query(alias="format", description="html: one page with all in it; or pdf")]

REPORT: dict[int | str, dict[str, Any]] = {
    200: {"content": {kind.split(";")[0]: {} for kind in MEDIA_TYPES.values()}},
}
"""The answer, as the API document says it."""


def report_response(content: bytes, report_format: ReportFormat, name: str) -> Response:
    """A report as a file of that name."""
    disposition = f'attachment; filename="becalm-{name}.{report_format}"'
    return Response(content, media_type=MEDIA_TYPES[report_format], headers={"Content-Disposition": disposition})
