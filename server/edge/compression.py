"""Which answers are sent compressed, and how."""

from __future__ import annotations

from fastapi import FastAPI
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware

WORTH_COMPRESSING = 1000
"""Bytes of the smallest answer that is sent compressed: one packet carries it as it is. No answer that small holds a
secret beside what somebody sent, so that its length reveals nothing."""
COMPRESSION_LEVEL = 5
"""Of gzip: three quarters of the time of the highest is saved, and 3 % of the size lost."""
COMPRESSED_HERE = 16_384
"""Bytes of a piece that is compressed at once; a larger one in a thread."""
COMPRESSED_ALREADY = (
    *DEFAULT_EXCLUDED_CONTENT_TYPES,
    "application/octet-stream",
    "application/vnd.apache.parquet",
    "application/x-mcap",
    "font/*",
)
"""Media types that are sent as they are."""


def compress(app: FastAPI) -> None:
    """Send compressed what is worth it; `ConsoleFiles` does so by itself, once for each file."""
    app.add_middleware(
        GZipMiddleware,
        minimum_size=WORTH_COMPRESSING,
        compresslevel=COMPRESSION_LEVEL,
        thread_minimum_size=COMPRESSED_HERE,
        exclude_content_types=COMPRESSED_ALREADY,
    )
