"""How much room the disk of the data folder has, looked at every few seconds."""

from __future__ import annotations

import asyncio
import logging
import shutil
from pathlib import Path

from server.problems import DiskFull

PERIOD = 5.0
"""Wall time between two looks [s]; a live mission writes half a megabyte a second."""

GIGABYTE = 1e9

log = logging.getLogger(__name__)


class DiskGuard:
    """Warns before the disk is full. What flies goes on being recorded for as long as there is any room."""

    def __init__(self, folder: Path, least_free: float) -> None:
        """Of the disk that holds `folder`, which need not exist yet; `least_free` in bytes."""
        self._folder = folder.absolute()
        self._least_free = least_free
        self.free: float | None = None
        """At the last look [bytes]; None if the system did not say."""

    def look(self) -> None:
        """See how much is free now."""
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

    def require_room(self) -> None:
        """Refuse to begin something that would fill the disk.

        Raises:
            DiskFull: less is free than there should be.

        """
        if self.warning:
            raise DiskFull(self.warning, tip="delete runs or studies, or move BECALM_DATA_DIR to a larger disk")
