"""`/imports`: logs from elsewhere become runs of the library."""

from __future__ import annotations

import asyncio
import tempfile
from pathlib import Path as FilePath
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from server.api.services import ServicesDep
from server.edge.problem_json import responses
from server.imports.library import Imported, imported
from server.library.runs import RunStore
from sim.errors import ConfigError

router = APIRouter(prefix="/imports", tags=["runs"], responses=responses(422))

LARGEST = 512 * 2**20
"""Bytes of a log."""

FileName = Annotated[
    str,
    Query(
        pattern=r"^[^/\\\x00-\x1f]{1,200}\.([cC][sS][vV]|[mM][cC][aA][pP])$",
        description="Of the file; its suffix says what it is",
        examples=["monday.csv"],
    ),
]
MapText = Annotated[
    str, Query(alias="map", min_length=1, max_length=20_000, description="TOML: which column or topic is what")
]

_BODY = {"required": True, "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}}


@router.post("", status_code=201, responses=responses(413, 415, 503, 507), openapi_extra={"requestBody": _BODY})
async def import_log(
    services: ServicesDep, request: Request, name: FileName, map_text: MapText, response: Response
) -> Imported:
    """Import a log, CSV or MCAP, sent as the body: it becomes a run, with what was found wrong in its note.

    What cannot be right is refused, with what to say in the map; nothing is left of it then.
    """
    services.disk.require_room()
    with tempfile.NamedTemporaryFile(suffix=FilePath(name).suffix, dir=services.settings.data_dir) as file:
        size = 0
        async for piece in request.stream():
            size += len(piece)
            if size > LARGEST:
                raise ConfigError(f"{name}: a log has at most {LARGEST} bytes", tip="becalm import reads larger ones")
            await asyncio.to_thread(file.write, piece)
        await asyncio.to_thread(file.flush)
        done = await services.aside.answer(_imported, services.store.root, FilePath(file.name), map_text, name)
    response.headers["Location"] = f"/api/v1/runs/{done.run}"
    return done


def _imported(root: FilePath, path: FilePath, map_text: str, name: str) -> Imported:
    return imported(RunStore(root), path, map_text, name)
