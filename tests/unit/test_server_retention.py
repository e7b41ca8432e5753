"""Retention: nothing goes without a setting, and never what somebody cares for."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest

from server.retention import expired
from server.run_folder import Note, Remarks
from server.runs import RunStore, new_record
from sim.configurations import named_configuration

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
    assert [run_id[:8] for run_id in found] == [f"{NOW - timedelta(days=each):%Y%m%d}" for each in days]
