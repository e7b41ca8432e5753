"""Which runs a library may let go of: by age, by total size, and only if a setting says so."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

from server.instants import instant
from server.library.reader import RunReader
from server.library.runs import RunStore
from sim.errors import CaptureError

PERIOD = 3600.0
"""Wall time between two looks [s]."""

log = logging.getLogger(__name__)


class Expired(NamedTuple):
    """A run to remove."""

    run_id: str
    why: str


def expired(
    readers: Iterable[RunReader], keep_days: float | None, keep_gigabytes: float | None, now: datetime
) -> list[Expired]:
    """The runs to remove, given from the newest to the oldest.

    A run that has not ended, is starred, or has a name or a note is always kept, but its size counts.
    """
    found: list[Expired] = []
    size = 0
    for reader in readers:
        taken = reader.size
        size += taken
        age = now - instant(reader.record.started)
        why = None
        if keep_days is not None and age > timedelta(days=keep_days):
            why = f"{age / timedelta(days=1):.1f} days old, more than keep_days = {keep_days:g}"
        elif keep_gigabytes is not None and size > keep_gigabytes * 1e9:
            why = f"the newer runs take what keep_gb = {keep_gigabytes:g} leaves"
        if why is not None and not _is_kept(reader):
            found.append(Expired(reader.record.id, why))
            size -= taken
    return found


def _is_kept(reader: RunReader) -> bool:
    """Whether a run stays, whatever the settings say; one whose star and notes cannot be read may have them."""
    remarks = reader.remarks
    cared_for = remarks.starred or bool(remarks.notes or remarks.name) or reader.remarks_damage is not None
    return cared_for or not reader.record.ended or reader.is_open


def remove_expired(
    store: RunStore, keep_days: float | None, keep_gigabytes: float | None, note: Callable[[Expired], None]
) -> None:
    """Remove the runs that the settings let go of, now; `note` is called with each."""
    for each in expired(store.newest(), keep_days, keep_gigabytes, datetime.now(UTC)):
        try:
            with store.remarks_lock:  # nobody stars it between the look and the end
                if _is_kept(store.read(each.run_id)):
                    continue
                store.delete(each.run_id)
        except (CaptureError, OSError) as error:
            log.warning("run %s should go (%s) but stays: %s", each.run_id, each.why, error)
            continue
        log.warning("run %s is removed: %s", each.run_id, each.why)
        note(each)


async def keep_removing(
    store: RunStore, keep_days: float | None, keep_gigabytes: float | None, note: Callable[[Expired], None]
) -> None:
    """Look every hour, for as long as the service runs, whatever one look meets; not at all without a setting."""
    while keep_days is not None or keep_gigabytes is not None:
        try:
            await asyncio.to_thread(remove_expired, store, keep_days, keep_gigabytes, note)
        except Exception:
            log.exception("the library could not be looked through for runs to remove")
        await asyncio.sleep(PERIOD)
