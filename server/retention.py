"""Which runs a library may let go of: by age, by total size, and only if a setting says so."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta

from server.run_folder import RunReader
from server.runs import RunStore
from sim.errors import CaptureError

PERIOD = 3600.0
"""Wall time between two looks [s]."""

log = logging.getLogger(__name__)


def expired(
    readers: Iterable[RunReader], keep_days: float | None, keep_gigabytes: float | None, now: datetime
) -> list[str]:
    """The runs to remove, given from the newest to the oldest.

    A run that has not ended, is starred or has a note is always kept, but its size counts.
    """
    found, size = [], 0
    for reader in readers:
        size += reader.size
        old = keep_days is not None and datetime.fromisoformat(reader.record.started) < now - timedelta(days=keep_days)
        much = keep_gigabytes is not None and size > keep_gigabytes * 1e9
        kept = not reader.record.ended or reader.remarks.starred or reader.remarks.notes
        if (old or much) and not kept:
            found.append(reader.record.id)
            size -= reader.size
    return found


def remove_expired(store: RunStore, keep_days: float | None, keep_gigabytes: float | None) -> None:
    """Remove the runs that the settings let go of, now."""
    for run_id in expired(store.newest(), keep_days, keep_gigabytes, datetime.now(UTC)):
        try:
            store.delete(run_id)
            log.info("run %s is removed: older or more than the settings keep", run_id)
        except CaptureError:
            continue  # somebody else has removed it


async def keep_removing(store: RunStore, keep_days: float | None, keep_gigabytes: float | None) -> None:
    """Look every hour, for as long as the service runs; not at all without a setting."""
    while keep_days is not None or keep_gigabytes is not None:
        await asyncio.to_thread(remove_expired, store, keep_days, keep_gigabytes)
        await asyncio.sleep(PERIOD)
