"""Retention: nothing goes without a setting, and never what somebody cares for."""

from __future__ import annotations

import asyncio
import shutil
from datetime import UTC, datetime, timedelta

import pytest

from server.library import retention
from server.library.folder import LOCK_NAME
from server.library.record import Note, Remarks
from server.library.retention import expired, keep_removing, remove_expired
from server.library.runs import RunStore, new_record
from sim.configurations import named_configuration
from sim.file_lock import ProcessLock

NOW = datetime(2026, 11, 25, tzinfo=UTC)


@pytest.fixture
def store(tmp_path):
    """Five runs, a day apart: 0 is today's, 1 is starred, 3 has a note, 4 still flies."""
    store = RunStore(tmp_path)
    for days in range(5):
        day = NOW - timedelta(days=days)
        status = "queued" if days == 4 else "finished"
        fields = {"id": f"{day:%Y%m%d}T000000000-abcdef", "started": day.isoformat(), "status": status}
        record = new_record("scripted", "published", named_configuration("published")).model_copy(update=fields)
        store.create(record)
        (tmp_path / record.id / "log.mcap").write_bytes(bytes(1_000_000))
        remarks = {1: Remarks(starred=True), 3: Remarks(notes=(Note(text="look here"),))}.get(days)
        if remarks:
            store.remark(record.id, remarks)
    return store


@pytest.mark.parametrize(
    ("keep_days", "keep_gigabytes", "days"),
    [(None, None, []), (0.5, None, [2]), (30, None, []), (None, 0.0025, [2]), (None, 0.0, [0, 2]), (None, 1.0, [])],
)
def test_what_goes(store, keep_days, keep_gigabytes, days):
    found = expired(store.newest(), keep_days, keep_gigabytes, NOW)
    assert [each.run_id[:8] for each in found] == [f"{NOW - timedelta(days=each):%Y%m%d}" for each in days]


def _names(store):
    return {path.name for path in store.root.iterdir()}


def test_what_goes_is_told_with_the_reason(store):
    gone = []
    remove_expired(store, 0.5, None, gone.append)
    assert len(_names(store)) == 3
    assert {each.run_id for each in gone}.isdisjoint(_names(store))
    assert all("days old, more than keep_days = 0.5" in each.why for each in gone)


def test_a_copy_never_takes_the_original_along(store):
    """A copied folder bears the identifier of the one that it was copied from, which here is starred."""
    starred = next(reader.record.id for reader in store.newest() if reader.remarks.starred)
    copy = store.root / (starred[:-6] + "fedcba")
    shutil.copytree(store.root / starred, copy)
    (copy / "remarks.json").unlink()
    remove_expired(store, 0.0, None, lambda _: None)
    assert {starred, copy.name} <= _names(store)


def test_what_is_still_written_stays_though_its_mission_has_ended(store):
    newest = next(store.newest()).record.id
    lock = ProcessLock(store.root / newest / LOCK_NAME)
    remove_expired(store, 0.0, None, lambda _: None)
    assert newest in _names(store)
    lock.release()
    remove_expired(store, 0.0, None, lambda _: None)
    assert newest not in _names(store)


def test_what_is_starred_between_the_look_and_the_end_stays(store, monkeypatch):
    found = expired(store.newest(), 0.0, None, datetime.now(UTC))
    for each in found:
        store.remark(each.run_id, Remarks(starred=True))
    monkeypatch.setattr(retention, "expired", lambda *_: found)
    before = _names(store)
    remove_expired(store, 0.0, None, lambda _: None)
    assert _names(store) == before


async def test_one_look_that_fails_is_not_the_last(store, monkeypatch):
    looks = asyncio.Queue()

    def look(*_):
        looks.put_nowait(None)
        raise RuntimeError("odd")

    monkeypatch.setattr(retention, "remove_expired", look)
    monkeypatch.setattr(retention, "PERIOD", 0.001)
    task = asyncio.create_task(keep_removing(store, 1.0, None, lambda _: None))
    async with asyncio.timeout(60):
        for _ in range(3):
            await looks.get()
    task.cancel()
