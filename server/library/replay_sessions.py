"""Recorded runs being replayed, each in a scene and a process of its own (`server.library.replay_session`)."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

from server.errors import ServiceBusy
from server.library.replay_session import ReplaySession

MAX_SESSIONS = 8
"""Recorded runs that may be watched at a time."""

_T = TypeVar("_T")


class ReplaySessions:
    """The sessions that are open, by keys that cannot be guessed; in one event loop, but for `shutdown`."""

    def __init__(self) -> None:
        self._open: dict[str, ReplaySession | None] = {}
        self._threads = ThreadPoolExecutor(MAX_SESSIONS, "becalm-playback")

    async def open(self, root: Path, run_id: str) -> tuple[str, ReplaySession]:
        """A new session of a run of that library, and its key.

        Raises:
            ServiceBusy: as many as may be are open.
            RunNotFound: there is no such run.
            MissionRefused: it has recorded nothing.
            ConfigError: the run's configuration cannot be laid out today.

        """
        if len(self._open) >= MAX_SESSIONS:
            what = f"{MAX_SESSIONS} recorded runs are being watched already"
            raise ServiceBusy(what, tip="close one of the pages that replay a run, then try again")
        key = secrets.token_hex(8)
        self._open[key] = None
        try:
            session: ReplaySession = await self.aside(ReplaySession, root, run_id)
        except BaseException:
            self._open.pop(key, None)
            raise
        self._open[key] = session
        return key, session

    async def aside(self, work: Callable[..., _T], *arguments: Any) -> _T:
        """What a session takes its time for, in a thread that only waits."""
        return await asyncio.get_running_loop().run_in_executor(self._threads, work, *arguments)

    def doorway(self, key: str) -> Path | None:
        """The unix socket of a session's scene; None if there is none."""
        session = self._open.get(key)
        return None if session is None else session.opened.doorway

    def close(self, key: str) -> None:
        """End a session."""
        session = self._open.pop(key, None)
        if session is not None:
            session.close()

    def shutdown(self) -> None:
        """End all of them."""
        for key in tuple(self._open):
            self.close(key)
        self._threads.shutdown(wait=False, cancel_futures=True)
