"""Recorded runs being replayed, each in a scene and a process of its own (`server.library.replay_session`)."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

from server.errors import ServiceBusy
from server.library.replay_session import Screening

AT_ONCE = 8
"""Recorded runs that may be watched at a time."""

_T = TypeVar("_T")


class Playbacks:
    """The screenings that are open, by keys that cannot be guessed; in one event loop, but for `shutdown`."""

    def __init__(self) -> None:
        self._open: dict[str, Screening | None] = {}
        self._threads = ThreadPoolExecutor(AT_ONCE, "becalm-playback")

    async def open(self, root: Path, run_id: str) -> tuple[str, Screening]:
        """A new screening of a run of that library, and its key.

        Raises:
            ServiceBusy: as many as may be are open.
            RunNotFound: there is no such run.
            MissionRefused: it has recorded nothing.
            ConfigError: the run's configuration cannot be laid out today.

        """
        if len(self._open) >= AT_ONCE:
            what = f"{AT_ONCE} recorded runs are being watched already"
            raise ServiceBusy(what, tip="close one of the pages that replay a run, then try again")
        key = secrets.token_hex(8)
        self._open[key] = None
        try:
            screening: Screening = await self.aside(Screening, root, run_id)
        except BaseException:
            self._open.pop(key, None)
            raise
        self._open[key] = screening
        return key, screening

    async def aside(self, work: Callable[..., _T], *arguments: Any) -> _T:
        """What a screening takes its time for, in a thread that only waits."""
        return await asyncio.get_running_loop().run_in_executor(self._threads, work, *arguments)

    def doorway(self, key: str) -> Path | None:
        """The unix socket of a screening's scene; None if there is none."""
        screening = self._open.get(key)
        return None if screening is None else screening.opened.doorway

    def close(self, key: str) -> None:
        """End a screening."""
        screening = self._open.pop(key, None)
        if screening is not None:
            screening.close()

    def shutdown(self) -> None:
        """End all of them."""
        for key in tuple(self._open):
            self.close(key)
        self._threads.shutdown(wait=False, cancel_futures=True)
