"""Every error as a problem document (RFC 9457) with a tip."""

from __future__ import annotations

import errno
import logging
import math
import re
import reprlib
import uuid
from collections.abc import Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from pydantic import BaseModel, Field, ValidationError
from starlette.exceptions import HTTPException

from server.edge.methods import allowed_methods
from server.errors import (
    ConfigOutdated,
    ConfirmationNeeded,
    DataFolderLost,
    DiskFull,
    JobNotFound,
    JobRefused,
    LoopSilent,
    PresetNotFound,
    ServiceBusy,
    StoredUnreadable,
    StudyNotFound,
    StudyRefused,
)
from server.texts import shortened
from sim.configurations import MOST_FINDINGS, OF_LENGTH, bracketed_unit, independent_findings, owning_parameter
from sim.errors import CaptureError, ConfigError, LinkLost, MissionRefused, RunNotFound
from sim.study.executors import WorkersUnavailable
from sim.study.table import TableUnusable

MEDIA_TYPE = "application/problem+json"

STATUSES: dict[type[CaptureError], int] = {
    ConfigError: 422,
    MissionRefused: 409,
    ConfigOutdated: 409,
    RunNotFound: 404,
    PresetNotFound: 404,
    StudyNotFound: 404,
    StudyRefused: 409,
    JobNotFound: 404,
    JobRefused: 409,
    StoredUnreadable: 409,
    ConfirmationNeeded: 409,
    TableUnusable: 409,
    WorkersUnavailable: 503,
    ServiceBusy: 503,
    DataFolderLost: 503,
    LoopSilent: 504,
    LinkLost: 504,
    DiskFull: 507,
}

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What the system says when nothing more can be written."""

_TITLES = {
    400: "Not JSON",
    401: "Not signed in",
    403: "Not allowed",
    404: "Not found",
    405: "Method not allowed",
    409: "Refused",
    412: "Changed meanwhile",
    413: "Too large",
    415: "Not JSON",
    422: "Invalid value",
    429: "Too many attempts",
    503: "Not now",
    504: "No answer",
    507: "No room",
}

_TIPS = {
    401: "`becalm token create` makes one, `becalm token list` lists them",
    404: "/docs lists every address",
    405: "/docs lists every address with its methods",
    422: "/docs shows what is expected",
}

_UNION_TAGS = ("one", "many")
"""Names that pydantic gives to the kinds of a body; no field has them."""

_NAMED_VALUE = re.compile(r"([\w.]+) = ('[^']*'|[^\s:,]+)")

LONGEST_DETAIL = 1000
LONGEST_VALUE = 200
LONGEST_INTEGER = 1024
"""Bits of a number that is shown."""

log = logging.getLogger(__name__)


class Finding(BaseModel):
    """One invalid value."""

    field: str = Field(examples=["target.mass"])
    value: Any = Field(None, examples=[-1.0])
    message: str = Field(examples=["Input should be greater than 0 [kg]"])


class ProblemDocument(BaseModel):
    """RFC 9457."""

    type: str = "about:blank"
    title: str = Field(examples=["Refused"])
    status: int = Field(examples=[409])
    instance: str | None = Field(None, description="Of 500: the name under which the service's log says more")
    detail: str = Field(examples=["release is refused in phase idle: nothing is under way yet"])
    tip: str = Field("", description="What a person can do about it")
    errors: list[Finding] | None = Field(None, description="Of 422: each invalid value")
    cells: int | None = Field(None, description="Of a study to be confirmed: how many cells it has")
    estimated_time: float | None = Field(None, description="Of a study to be confirmed: wall time it takes [s]")


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The OpenAPI entries of these errors."""
    return {status: {"model": ProblemDocument, "description": _TITLES[status]} for status in statuses}


EVERYWHERE = (401, 403, 429)
"""Errors that any request may be answered with."""

WITH_A_BODY = (400, 413, 415)
"""And any that brings something."""


def complete(document: dict[str, Any]) -> None:
    """Add the errors of every request to an OpenAPI document, under the media type that they are really sent with."""
    schema = {"$ref": f"#/components/schemas/{ProblemDocument.__name__}"}
    for operation in (each for path in document["paths"].values() for each in path.values()):
        for status in (*EVERYWHERE, *(WITH_A_BODY if "requestBody" in operation else ())):
            entry = {"description": _TITLES[status], "content": {MEDIA_TYPE: {"schema": schema}}}
            operation["responses"].setdefault(str(status), entry)
        for status, response in operation["responses"].items():
            if status >= "400" and "application/json" in response.get("content", {}):
                response["content"] = {MEDIA_TYPE: response["content"]["application/json"]}


def install(app: FastAPI) -> None:
    """Answer every error of this application with a problem document."""
    app.add_exception_handler(CaptureError, _refused)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(OSError, _disk_failed)
    app.add_exception_handler(Exception, _unexpected)


def problem_answer(document: ProblemDocument, headers: dict[str, str] | None = None) -> JSONResponse:
    """The document as an answer."""
    content = _bounded(document).model_dump(mode="json", exclude_none=True)
    return JSONResponse(content, document.status, headers=headers, media_type=MEDIA_TYPE)


def _bounded(document: ProblemDocument) -> ProblemDocument:
    """Nothing that somebody sent comes back at any length."""
    errors = document.errors
    if errors is not None and len(errors) > MOST_FINDINGS:
        more = f"and {len(errors) - MOST_FINDINGS} more"
        errors = [*errors[:MOST_FINDINGS], Finding(field="", message=more)]
    detail, tip = shortened(document.detail, LONGEST_DETAIL), shortened(document.tip, LONGEST_DETAIL)
    return document.model_copy(update={"detail": detail, "tip": tip, "errors": errors and list(map(_cut, errors))})


def _cut(finding: Finding) -> Finding:
    value = shortened(finding.value, LONGEST_VALUE) if isinstance(finding.value, str) else finding.value
    field, message = shortened(finding.field, LONGEST_VALUE), shortened(finding.message, LONGEST_DETAIL)
    return Finding(field=field, value=value, message=message)


def document_of(error: CaptureError) -> ProblemDocument:
    """The document that describes a refusal."""
    status = next((code for kind, code in STATUSES.items() if isinstance(error, kind)), 500)
    return ProblemDocument(
        title=_TITLES.get(status, "Failed"),
        status=status,
        detail=str(error),
        tip=error.tip,
        errors=_config_findings(error) if isinstance(error, ConfigError) else None,
        cells=error.cells if isinstance(error, ConfirmationNeeded) else None,
        estimated_time=error.estimated_time if isinstance(error, ConfirmationNeeded) else None,
    )


async def _refused(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, CaptureError)
    document = document_of(error)
    return problem_answer(document, {"Retry-After": "1"} if document.status == 503 else None)


def _config_findings(error: ConfigError) -> list[Finding]:
    """Field, value and message of each value that a configuration was refused for."""
    cause = error.__cause__ or error.__context__
    if isinstance(cause, ValidationError):
        return [_finding(each) for each in independent_findings(cause)[:MOST_FINDINGS]]
    return [_named_finding(str(error))]


def _finding(error: Any) -> Finding:
    field = ".".join(map(str, error["loc"]))
    message = error["msg"].removeprefix("Value error, ")
    if not field:
        return _named_finding(message)
    owner = None if error["type"] in OF_LENGTH else owning_parameter(field)
    unit = "" if owner is None else bracketed_unit(owner)
    return Finding(field=field, value=_jsonable(error["input"]), message=message + unit)


def _named_finding(message: str) -> Finding:
    """A check across fields names the first of them, and its value, in its words: `field = value`."""
    named = _NAMED_VALUE.match(message)
    return Finding(field=named[1] if named else "", value=named[2] if named else None, message=message)


def _in_words(finding: Finding) -> str:
    if finding.message.startswith(f"{finding.field} = ") or not finding.field:
        return finding.message
    return f"{finding.field} = {finding.value!r}: {finding.message}"


async def _invalid(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    findings = [_request_finding(each) for each in error.errors()]
    detail = "; ".join(map(_in_words, findings))
    document = ProblemDocument(title=_TITLES[422], status=422, detail=detail, tip=_TIPS[422], errors=findings)
    return problem_answer(document)


def _request_finding(error: Any) -> Finding:
    location: Sequence[Any] = error["loc"]
    field = ".".join(str(part) for part in location[1:] if part not in _UNION_TAGS)
    message = error["msg"].removeprefix("Value error, ")
    return (
        _named_finding(message)
        if not field
        else Finding(field=field, value=_jsonable(error.get("input")), message=message)
    )


def _jsonable(value: Any) -> Any:
    """The value itself if JSON can say it, else in words: NaN, for one."""
    if isinstance(value, bool | str | None):
        return value
    if isinstance(value, int):
        return value if value.bit_length() <= LONGEST_INTEGER else f"an integer of {value.bit_length()} bits"
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return shortened(reprlib.repr(value), LONGEST_VALUE)


async def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = error.status_code
    if status == 304:
        return Response(status_code=304, headers=error.headers)
    if status == 405:
        return _other_method(request)
    title = _TITLES.get(status, HTTPStatus(status).phrase)
    document = ProblemDocument(title=title, status=status, detail=str(error.detail), tip=_TIPS.get(status, ""))
    return problem_answer(document, dict(error.headers or {}))


async def _disk_failed(request: Request, error: Exception) -> JSONResponse:
    """What the data folder's disk refuses; other errors of the system are unexpected ones."""
    assert isinstance(error, OSError)
    if error.filename is None or error.strerror is None:
        return await _unexpected(request, error)
    log.error("%s: %s", error.filename, error.strerror)
    status = 507 if error.errno in NO_ROOM else 503
    document = ProblemDocument(
        title="No room" if status == 507 else "The disk fails",
        status=status,
        detail=f"{error.filename}: {error.strerror}",
        tip="make room on the disk"
        if status == 507
        else "see that the data folder is there, and that it may be written; what was there is there again when it is",
    )
    return problem_answer(document, {"Retry-After": "5"} if status == 503 else None)


def _other_method(request: Request) -> Response:
    """What an address does take, where another method was asked for; to OPTIONS that is the answer."""
    allowed = allowed_methods(request.app.router.routes, request.scope) or ("GET", "HEAD", "OPTIONS")
    headers = {"Allow": ", ".join(allowed)}
    if request.method == "OPTIONS":
        return Response(status_code=204, headers=headers)
    detail = f"{shortened(request.method, 20)} is not what {shortened(request.url.path)} takes"
    tip = f"it takes {', '.join(allowed)}; {_TIPS[405]}"
    return problem_answer(ProblemDocument(title=_TITLES[405], status=405, detail=detail, tip=tip), headers)


async def _unexpected(_: Request, error: Exception) -> JSONResponse:
    name = uuid.uuid4().hex[:12]
    log.error("an unexpected error, %s", name, exc_info=error)
    return problem_answer(
        ProblemDocument(
            title="Failed",
            status=500,
            detail=f"{type(error).__name__}: an error that Becalm did not expect",
            tip=f"the service's log says more under {name}; please report it",
            instance=f"urn:becalm:error:{name}",
        )
    )
