"""What is noted and never changed: lines of JSON in the data folder, of which the newest are at hand."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import BaseModel

from server.errors import StoredUnreadable
from server.files import read_lines

AT_HAND = 500
"""Entries that are read without the disk."""

LARGEST = 4_000_000
"""Bytes of a file, beyond which it becomes the one before: some ten thousand entries each."""

M = TypeVar("M", bound=BaseModel)


class Journal(Generic[M]):
    """Entries of one kind in one data folder; from any thread."""

    def __init__(self, folder: Path, name: str, model: type[M], require_folder: Callable[[], None]) -> None:
        """Read nothing yet; the files are NAME.jsonl and NAME.1.jsonl. The last raises where the folder is lost."""
        self._require_folder = require_folder
        self._path, self._before = folder / f"{name}.jsonl", folder / f"{name}.1.jsonl"
        self._model = model
        self._lock = threading.Lock()
        self._entries: deque[M] | None = None

    def newest(self, count: int = AT_HAND) -> list[M]:
        """So many, the newest first."""
        with self._lock:
            entries = self._read()
            return [entries[-1 - place] for place in range(min(count, len(entries)))]

    def keep(self, *entries: M) -> None:
        """Add entries; whoever reads sees them, also where the disk does not take them.

        Raises:
            DataFolderLost: the folder is gone; nothing is written in its place.
            OSError: the disk does not take them.

        """
        with self._lock:
            self._read().extend(entries)
            self._require_folder()
            if self._path.exists() and self._path.stat().st_size > LARGEST:
                os.replace(self._path, self._before)
            with self._path.open("a", encoding="utf-8") as file:
                file.writelines(entry.model_dump_json() + "\n" for entry in entries)

    def _read(self) -> deque[M]:
        if self._entries is None:
            self._entries = deque(maxlen=AT_HAND)
            for path in (self._before, self._path):
                with suppress(StoredUnreadable):  # the log of the service says so
                    self._entries.extend(read_lines(path, self._model))
        return self._entries
