"""Small files of the data folder: replaced as a whole, and read so that no damage costs more than the file itself."""

from __future__ import annotations

import errno
import logging
import math
import os
import shutil
import stat
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import from_json, to_json

from server.errors import StoredUnreadable
from server.texts import shortened
from sim.errors import ConfigError
from sim.files import replacing

M = TypeVar("M", bound=BaseModel)

LARGEST_DOCUMENT = 16_000_000
"""Bytes of a document that is read whole; the largest that make sense have some ten thousand."""

LONGEST_LINE = 1_000_000
"""Bytes of a line of JSON; the longest that make sense have some thousand."""

LONGEST_NAME = 80
"""Characters of a name in a file that a message repeats."""

log = logging.getLogger(__name__)


def replace_file(path: Path, content: bytes, *, mode: int = 0o644) -> None:
    """Put this content in place of the file's, if there is one, and have the disk know."""
    with (
        replacing(path) as draft,
        open(draft, "xb", opener=lambda name, flags: os.open(name, flags, mode)) as file,
    ):
        file.write(content)


Upgrade = Callable[[Any], Any]
"""A JSON document of any version as today's, or a ConfigError; what is no document of that kind stays as it is."""


def read_document(path: Path, model: type[M], *, numbers: bool = True, upgrade: Upgrade | None = None) -> M:
    """What a JSON file holds.

    Args:
        path: of the file.
        model: of what it holds.
        numbers: whether one that is not finite makes it damaged; else whoever reads on looks at them.
        upgrade: makes of what any version stored what the model reads.

    Raises:
        FileNotFoundError: there is none.
        StoredUnreadable: it cannot be read; the message says why in words, with the file's name.

    """
    try:
        content = _content(path)
        document = _validated(content, model, upgrade)
        if numbers and not finite(from_json(content)):
            raise StoredUnreadable(f"{path.name} is damaged: a number in it is not finite")
        return document
    except ConfigError as error:
        raise StoredUnreadable(f"{path.name} cannot be read: {error}", tip=error.tip) from None
    except ValidationError as error:
        raise StoredUnreadable(f"{path.name} is damaged or of another version: {finding(error)}") from None
    except RecursionError:
        raise StoredUnreadable(f"{path.name} is damaged: it is nested too deeply") from None
    except FileNotFoundError:
        if path.is_symlink():
            raise StoredUnreadable(f"{path.name} is a link that leads nowhere") from None
        raise
    except OSError as error:
        raise StoredUnreadable(f"{path.name} cannot be read: {error.strerror}") from error


def _validated(content: bytes, model: type[M], upgrade: Upgrade | None) -> M:
    """A document of today's version, or one of any version through its upgrade."""
    if upgrade is None:
        return model.model_validate_json(content)
    try:
        stored = from_json(content)
    except ValueError:  # it is no JSON at all: the model says where
        return model.model_validate_json(content)
    return model.model_validate_json(to_json(upgrade(stored)))


def read_lines(path: Path, model: type[M], *, strict: bool = False, upgrade: Upgrade | None = None) -> Iterator[M]:
    """What each line of a file of JSON lines holds; nothing if there is none. A last line without an end is left out.

    Args:
        path: of the file.
        model: of one line.
        strict: whether a line that cannot be read ends it all; else it is left out, and the service's log says so.
        upgrade: makes of what any version stored what the model reads.

    Raises:
        StoredUnreadable: the file cannot be read, or with `strict` a line of it.

    """
    damaged = 0
    for number, document in enumerate(_documents(path, model, upgrade), 1):
        if not isinstance(document, _Damage):
            yield document
        elif strict:
            raise StoredUnreadable(f"line {number} of {path.name} is damaged: {document.why}")
        else:
            damaged += 1
    if damaged:
        log.warning("%s: %d damaged lines are left out", path, damaged)


def damaged_lines(path: Path, model: type[BaseModel], *, upgrade: Upgrade | None = None) -> int:
    """How many lines of a file of JSON lines `read_lines` leaves out.

    Raises:
        StoredUnreadable: the file cannot be read.

    """
    return sum(isinstance(document, _Damage) for document in _documents(path, model, upgrade))


class _Damage(NamedTuple):
    """In place of what a line would hold."""

    why: str


def _documents(path: Path, model: type[M], upgrade: Upgrade | None) -> Iterator[M | _Damage]:
    for line in _lines(path):
        try:
            document = _validated(line, model, upgrade)
            if not finite(from_json(line)):
                raise ValueError("a number in it is not finite")
        except (ValueError, RecursionError, ConfigError) as error:
            yield _Damage(finding(error) if isinstance(error, ValidationError) else str(error))
        else:
            yield document


def _lines(path: Path) -> Iterator[bytes]:
    """The lines that end, of bounded length each."""
    try:
        with _opened(path) as file:
            while (line := file.readline(LONGEST_LINE)).endswith(b"\n") or len(line) == LONGEST_LINE:
                yield line
    except FileNotFoundError:
        return
    except OSError as error:
        raise StoredUnreadable(f"{path.name} cannot be read: {error.strerror}") from error


def _content(path: Path) -> bytes:
    """The bytes of a regular file of bounded size."""
    with _opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > LARGEST_DOCUMENT:
            raise OSError(errno.EFBIG, f"it has {size} bytes, more than {LARGEST_DOCUMENT}", str(path))
        return file.read(LARGEST_DOCUMENT + 1)


def _opened(path: Path) -> BinaryIO:
    """A regular file, opened to be read; a pipe or a device in its place is not waited for."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    return os.fdopen(descriptor, "rb")


def finite(value: Any) -> bool:
    """Whether every number in a document is one that JSON can say."""
    if isinstance(value, dict):
        return all(map(finite, value.values()))
    if isinstance(value, list):
        return all(map(finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def finding(error: ValidationError) -> str:
    """The first thing wrong; names come from the file, so that they are cut and escaped."""
    first = error.errors(include_url=False, include_context=False)[0]
    where = shortened(".".join(map(str, first["loc"])), LONGEST_NAME)
    message = first["msg"].removeprefix("Value error, ")
    return f"{where}: {message}" if where else message


def remove_folder(folder: Path, record: str) -> None:
    """Remove a folder with all in it, its record first: what is half removed is nothing any more.

    Of a link in its place only the link goes.

    Raises:
        OSError: it cannot be removed; one that is gone already is no error.

    """
    if folder.is_symlink():
        folder.unlink(missing_ok=True)
        return
    with suppress(FileNotFoundError, IsADirectoryError):
        (folder / record).unlink()
    with suppress(FileNotFoundError):
        shutil.rmtree(folder)
