"""Which run a page that opens is shown as cut off: the newest live one, if a service's end met it under way."""

from __future__ import annotations

import numpy as np
import pytest

from server.library.folder import LOG_NAME, write_record
from server.library.runs import RunStore, new_record
from server.mission.cut_off import CutOffRun, cut_off_run
from server.mission.live_run import CUT_OFF_NOTE, STOPPED_NOTE
from sim.capture.tick import TICK
from sim.configurations import named_configuration
from sim.control.phases import Phase


@pytest.fixture
def store(tmp_path):
    return RunStore(tmp_path / "runs").make_root()


def _written(store: RunStore, *phases: Phase, kind="live", **end):
    """A run that was in each of these phases for a second; killed unless it ends with some words."""
    record = new_record(kind, "published", named_configuration("published"))
    writer = store.write(record)
    ticks = np.zeros(100 * len(phases), TICK)
    ticks["tick"] = np.arange(len(ticks))
    ticks["time"] = 0.01 * ticks["tick"]
    ticks["phase"] = np.repeat(phases, 100)
    writer.append(ticks)
    writer.flush()
    if end:
        writer.close(**end)
    else:
        writer.abandon()
    return record.id


def test_nothing_was_flown(store):
    assert cut_off_run(store) is None


def test_a_run_whose_service_was_killed(store):
    run_id = _written(store, Phase.IDLE, Phase.DETUMBLING)
    assert cut_off_run(store) == CutOffRun(run_id=run_id, phase="detumbling", time=1.99)


def test_an_orderly_end_stops_the_robot_and_tells_the_phase_before(store):
    run_id = _written(store, Phase.IDLE, Phase.CAGING, status="cancelled", note=CUT_OFF_NOTE)
    assert cut_off_run(store) == CutOffRun(run_id=run_id, phase="caging", time=1.99)


def test_the_stop_at_the_end_is_not_taken_for_the_phase(store, monkeypatch):
    monkeypatch.setattr("server.mission.cut_off.LAST_MOMENTS", 1.5)
    _written(store, Phase.CAGING, Phase.STOPPED)
    cut_off = cut_off_run(store)
    assert cut_off is not None
    assert cut_off.phase == "caging"


@pytest.mark.parametrize(
    ("phases", "end"),
    [
        ((Phase.IDLE, Phase.DETUMBLING), {"status": "cancelled", "note": "ended by reset"}),
        ((Phase.DETUMBLING, Phase.STOPPED), {"status": "cancelled", "note": STOPPED_NOTE}),
        ((Phase.IDLE, Phase.FAULTED), {"status": "failed", "note": "the link was lost"}),
        ((Phase.IDLE,), {}),  # killed before anything moved
        ((Phase.CAGING, Phase.STOPPED, Phase.STOPPED, Phase.STOPPED), {}),  # stopped by the operator, then killed
        ((Phase.CAGING, Phase.STOPPED, Phase.STOPPED), {"status": "cancelled", "note": CUT_OFF_NOTE}),
    ],
)
def test_a_run_that_had_ended_or_never_moved_was_not_cut_off(store, phases, end):
    _written(store, *phases, **end)
    assert cut_off_run(store) is None


def test_a_fault_that_the_kill_came_after_keeps_its_reason(store):
    run_id = _written(store, Phase.CAGING, Phase.CAGING)
    revised = store.read(run_id).record.model_copy(update={"status": "failed", "note": "the link was lost"})
    write_record(store.root / run_id, revised.model_copy(update={"integrity": None}))
    assert cut_off_run(store) is None
    assert store.read(run_id).record.note == "the link was lost"


def test_only_the_newest_live_run_counts(store):
    _written(store, Phase.DETUMBLING)
    _written(store, Phase.DETUMBLING, status="cancelled", note="ended by reset")
    _written(store, Phase.DETUMBLING, kind="scripted")
    assert cut_off_run(store) is None


def test_a_damaged_log_keeps_no_service_from_starting(store):
    run_id = _written(store, Phase.DETUMBLING, status="cancelled", note=CUT_OFF_NOTE)
    (store.root / run_id / LOG_NAME).write_bytes(b"\x00" * 5000)
    assert cut_off_run(store) is None
