"""`ETag` and `If-None-Match`: an answer that the client has already is not sent again."""

from __future__ import annotations

import hashlib
from typing import Annotated, TypeVar

from fastapi import Header, HTTPException, Response
from pydantic import BaseModel

IfNoneMatch = Annotated[str | None, Header(alias="If-None-Match", description="The ETag that is known already")]

Tagged = TypeVar("Tagged", bound=BaseModel)


def etag(body: BaseModel) -> str:
    """The name of this very answer."""
    return _etag_of(body.model_dump_json().encode())


def known_or_new(content: bytes, known: str | None) -> Response:
    """That JSON with its ETag; 304 if it is known."""
    headers = {"ETag": _etag_of(content)}
    if _is_known(headers["ETag"], known):
        return Response(status_code=304, headers=headers)
    return Response(content, headers=headers, media_type="application/json")


def tagged(body: Tagged, response: Response, known: str | None) -> Tagged:
    """The answer with its ETag; 304 if that is known."""
    response.headers["ETag"] = etag(body)
    if _is_known(response.headers["ETag"], known):
        raise HTTPException(304, headers={"ETag": response.headers["ETag"]})
    return body


def _is_known(tag: str, known: str | None) -> bool:
    """Whether `If-None-Match` names it, among others or weakly, or names any."""
    return known is not None and (tag in known or known.strip() == "*")


def _etag_of(content: bytes) -> str:
    return f'"{hashlib.sha256(content).hexdigest()[:32]}"'
