"""In which formats a report leaves. Nothing here loads what draws, which takes a second."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from server.reports.blocks import Document

ReportFormat = Literal["html", "pdf"]
MEDIA_TYPES: dict[ReportFormat, str] = {"html": "text/html; charset=utf-8", "pdf": "application/pdf"}


def written(document: Document, report_format: ReportFormat) -> bytes:
    """The report in that format."""
    from server.reports.page import html  # noqa: PLC0415 - see above
    from server.reports.printed import pdf  # noqa: PLC0415

    return html(document) if report_format == "html" else pdf(document)
