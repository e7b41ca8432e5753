"""Whether the data folder is there, and how much room its disk has, looked at every second."""

from __future__ import annotations

import asyncio
import logging
import os
import shutil
from collections.abc import Sequence
from pathlib import Path

from server.errors import DataFolderLost, DiskFull

PERIOD = 1.0
"""Wall time between two looks [s]; a live mission writes half a megabyte a second."""

GIGABYTE = 1e9

log = logging.getLogger(__name__)


FAULT_TIP = "bring the folder back, or fix its permissions; then reset, and the mission is recorded again"


def _fault(folder: Path) -> str | None:
    """Why nothing can be written in a folder, in words."""
    try:
        there = folder.is_dir()
    except OSError as error:
        return f"the folder {folder} cannot be looked into: {error.strerror}"
    if not there:
        return f"the folder {folder} is gone"
    return None if os.access(folder, os.W_OK | os.X_OK) else f"the folder {folder} cannot be written"


class DiskGuard:
    """Warns before the disk is full. What flies goes on being recorded for as long as there is any room."""

    def __init__(self, folder: Path, least_free: float, needed: Sequence[Path] = ()) -> None:
        """Of the disk that holds `folder`, which need not exist yet; `least_free` in bytes.

        The folders in `needed` have to be there when it looks, and it must be possible to write in them.
        """
        self._folder = folder.absolute()
        self._needed = needed
        self._least_free = least_free
        self.free: float | None = None
        """At the last look [bytes]; None if the system did not say."""
        self.fault: str | None = None
        """At the last look, in words: what keeps everything from being written."""

    def look(self) -> None:
        """See what is there, and how much is free, now."""
        fault = next(filter(None, map(_fault, self._needed)), None)
        if fault is not None and self.fault is None:
            log.error("%s", fault)
        self.fault = fault
        there = next(each for each in (self._folder, *self._folder.parents) if each.exists())
        try:
            self.free = shutil.disk_usage(there).free
        except OSError as error:
            log.warning("the disk of %s does not say how much is free: %s", there, error)
            self.free = None

    async def keep_looking(self) -> None:
        """Look now and then, for as long as the service runs."""
        while True:
            await asyncio.to_thread(self.look)
            await asyncio.sleep(PERIOD)

    @property
    def warning(self) -> str | None:
        """What is wrong, in words; None while there is room."""
        if self.free is None or self.free >= self._least_free:
            return None
        left, least = self.free / GIGABYTE, self._least_free / GIGABYTE
        return f"{left:.2f} GB are free where the runs lie, less than the {least:g} GB of min_free_gb"

    def require_folder(self) -> None:
        """Refuse to keep something where nothing can be kept, or beside the folder that the service was started with.

        Raises:
            DataFolderLost: the folder is gone, or cannot be written.

        """
        if fault := next(filter(None, map(_fault, self._needed)), None):
            raise DataFolderLost(fault, tip=FAULT_TIP)

    def require_room(self) -> None:
        """Refuse to begin something that could not be kept, or would fill the disk.

        Raises:
            DataFolderLost: the folder is gone, or cannot be written.
            DiskFull: less is free than there should be.

        """
        self.require_folder()
        if self.warning:
            raise DiskFull(self.warning, tip="delete runs or studies, or move BECALM_DATA_DIR to a larger disk")
