"""Small files of the data folder: replaced as a whole, and read so that no damage costs more than the file itself."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from server.problems import StoredUnreadable
from sim.files import replacing

M = TypeVar("M", bound=BaseModel)

LARGEST_DOCUMENT = 16_000_000
"""Bytes of a document that is read whole; the largest that make sense have some ten thousand."""

LONGEST_NAME = 80
"""Characters of a name in a file that a message repeats."""


def replace_file(path: Path, content: bytes, *, mode: int = 0o644) -> None:
    """Put this content in place of the file's, if there is one, and have the disk know."""
    with (
        replacing(path) as draft,
        open(draft, "xb", opener=lambda name, flags: os.open(name, flags, mode)) as file,
    ):
        file.write(content)


def read_document(path: Path, model: type[M]) -> M:
    """What a JSON file holds.

    Raises:
        FileNotFoundError: there is none.
        StoredUnreadable: it cannot be read; the message says why in words, with the file's name.

    """
    try:
        return model.model_validate_json(_content(path))
    except ValidationError as error:
        raise StoredUnreadable(f"{path.name} is damaged or of another version: {_finding(error)}") from None
    except RecursionError:
        raise StoredUnreadable(f"{path.name} is damaged: it is nested too deeply") from None
    except FileNotFoundError:
        if path.is_symlink():
            raise StoredUnreadable(f"{path.name} is a link that leads nowhere") from None
        raise
    except OSError as error:
        raise StoredUnreadable(f"{path.name} cannot be read: {error.strerror}") from error


def _content(path: Path) -> bytes:
    """The bytes of a regular file of bounded size; a pipe or a device in its place is not waited for."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(descriptor, "rb") as file:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode):
            raise OSError(errno.EINVAL, "it is no regular file", str(path))
        if found.st_size > LARGEST_DOCUMENT:
            raise OSError(errno.EFBIG, f"it has {found.st_size} bytes, more than {LARGEST_DOCUMENT}", str(path))
        return file.read(LARGEST_DOCUMENT + 1)


def _finding(error: ValidationError) -> str:
    """The first thing wrong; names come from the file, so that they are cut and escaped."""
    first = error.errors(include_url=False, include_context=False)[0]
    where, message = shown(".".join(map(str, first["loc"]))), first["msg"].removeprefix("Value error, ")
    return f"{where}: {message}" if where else message


def shown(name: str) -> str:
    """A name out of a file as a message or a log line may hold it: of bounded length, on one line."""
    cut = name if len(name) <= LONGEST_NAME else name[:LONGEST_NAME] + "..."
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in cut)
