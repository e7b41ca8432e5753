"""One cell as one row: what is kept of an outcome, and of a cell that cannot be flown."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from sim.capture.monitor import MONITOR, begin_monitoring, note_decision, watch
from sim.capture.run import RunResult
from sim.config import MissionConfig, RobotConfig
from sim.control.memory import MEMORY
from sim.control.phases import Phase
from sim.errors import PlantDiverged
from sim.method.published.memory import Activity
from sim.model.clearance import shapes_of
from sim.model.robot import chain, robot_model
from sim.plant.plant import PLANT_STATE
from sim.record import Record, record_of
from sim.snapshot import Outcome, OutcomeClass, Touch
from sim.study import run
from sim.study.design import study_of
from sim.study.run import MEASURES, CellTask, columns, failed_row, fly_cell

STUDY = study_of({"grid": {"published.impedance.mass": [0.05, 0.1], "contact.corner": ["face", "radial"]}})

OUTCOME = Outcome(
    outcome=OutcomeClass.CAGED_FORCE_REDUCED,
    at_first_closure=OutcomeClass.CAGED_FORCE_REDUCED,
    at_locked_arms=OutcomeClass.CAGED_UNPLANNED_CONTACT,
    caged=True,
    cage_margin=0.005,
    peak_tip_force=1.9,
    peak_tip_force_to_closure=0.9,
    closed_at=5.3,
    locked_at=6.2,
    duration=8.2,
    contacts=[
        Touch(arm="right", start=3.4, end=4.1, peak=0.9, planned=True),
        Touch(arm="left", start=5.7, end=5.9, peak=1.9, planned=False),
    ],
    final_target_spin=0.06,
    min_manipulability=0.04,
    momentum_error=1e-7,
)


def noted(outcome: Outcome) -> Record:
    """Ten ticks a second: the target slows from 1 rad/s to 0.1 at 4.1 s, when it drifts; forces as the outcome has."""
    monitor, memory, state = (np.zeros(1, kind)[0] for kind in (MONITOR, MEMORY, PLANT_STATE))
    parameters, robot, shapes = record_of(MissionConfig()), robot_model(RobotConfig()), shapes_of(MissionConfig())
    links = chain(robot, np.zeros(3), np.zeros((2, 3)), np.zeros(2))
    begin_monitoring(monitor, 0.0, np.zeros(3))
    state["target_pose"][1] = 0.35
    for tick in range(83):
        late = tick >= 41
        state["time"], state["base_pose"][2] = tick / 10, -0.5 * tick / 82
        state["target_twist"] = (0.03, -0.04, 0.1) if late else (0.0, 0.0, 1.0)
        memory["phase"], memory["activity"] = Phase.DETUMBLING, Activity.APPROACHING
        state["hand_wrench"], state["tip_contact"] = 0.0, 0
        for touch in outcome.contacts:
            arm = int(touch.arm == "right")
            if round(10 * touch.start) <= tick <= round(10 * (touch.end or 0.0)):
                state["tip_contact"][arm, 0] = 1
                state["hand_wrench"][arm, 0] = touch.peak if tick == round(10 * touch.start) + 1 else 0.0
        watch(monitor, memory, parameters, robot, shapes, state, links)
        if tick >= 44:
            memory["phase"], memory["activity"] = Phase.CAGING, Activity.CLOSING
        note_decision(monitor, memory, state)
    return monitor


def task(index: int = 1) -> CellTask:
    return CellTask(STUDY.base, STUDY.direct, STUDY.cell(index))


@pytest.fixture
def flown(monkeypatch):
    """What `run_capture` was asked for; it answers with the outcome above."""
    asked = []

    def answer(config, *, direct):
        asked.append((config, direct))
        return RunResult(OUTCOME, ticks=8200, simulated_time=8.2, wall_time=0.1, monitor=noted(OUTCOME))

    monkeypatch.setattr(run, "run_capture", answer)
    return asked


@pytest.mark.usefixtures("flown")
def test_row_has_the_columns_in_their_order():
    row = fly_cell(task())
    assert list(row) == [column.name for column in columns(STUDY)]
    for column in columns(STUDY)[:-1]:
        assert type(row[column.name]) is column.kind
    assert row["error"] is None


def test_row_tells_cell_outcome_and_hardest_touch(flown):
    row = fly_cell(task())
    assert (row["cell"], row["published.impedance.mass"], row["contact.corner"]) == (1, 0.05, "radial")
    assert (row["outcome"], row["at_locked_arms"]) == ("caged_force_reduced", "caged_unplanned_contact")
    assert row["engine"] == "reduced"
    assert (row["touches"], row["hardest_touch_arm"], row["hardest_touch_start"]) == (2, "left", 5.7)
    assert row["hardest_touch_peak"] == 1.9
    ((config, direct),) = flown
    assert config.simulation.seed == row["seed"]
    assert config.contact.corner == "radial"
    assert not direct


@pytest.mark.usefixtures("flown")
def test_without_a_touch_there_is_no_hardest(monkeypatch):
    monkeypatch.setitem(globals(), "OUTCOME", OUTCOME.model_copy(update={"contacts": [], "closed_at": None}))
    row = fly_cell(task())
    assert (row["touches"], row["hardest_touch_arm"], row["hardest_touch_peak"]) == (0, None, None)
    assert row["closed_at"] is None
    assert (row["first_touch_end"], row["peak_at"], row["peak_stage"]) == (None, None, None)


@pytest.mark.usefixtures("flown")
def test_row_tells_what_the_first_touch_left_and_when_the_peak_came():
    row = fly_cell(task())
    assert (row["first_touch_end"], row["first_touch_peak"]) == (4.1, 0.9)
    assert row["spin_after_first_touch"] == 0.1
    assert row["drift_after_first_touch"] == pytest.approx(0.05)
    assert (row["peak_at"], row["peak_stage"]) == (5.8, "after_closure")
    assert row["base_turn"] == -0.5


@pytest.mark.parametrize(("closed_at", "stage"), [(None, "closing"), (5.9, "closing"), (5.7, "after_closure")])
@pytest.mark.usefixtures("flown")
def test_peak_is_after_closure_only_after_the_first_closed_instant(monkeypatch, closed_at, stage):
    monkeypatch.setitem(globals(), "OUTCOME", OUTCOME.model_copy(update={"closed_at": closed_at}))
    assert fly_cell(task())["peak_stage"] == stage


@pytest.mark.usefixtures("flown")
def test_a_peak_before_the_hands_close_is_a_touch(monkeypatch):
    monkeypatch.setitem(globals(), "OUTCOME", OUTCOME.model_copy(update={"contacts": OUTCOME.contacts[:1]}))
    row = fly_cell(task())
    assert (row["peak_at"], row["peak_stage"]) == (3.5, "touch")


@pytest.mark.parametrize(
    ("error", "words"),
    [(PlantDiverged("not finite after 3 s"), "not finite after 3 s"), (ValueError("odd"), "ValueError: odd")],
)
def test_a_cell_that_fails_is_a_row_that_says_why(monkeypatch, error, words):
    def fail(_config, **_options):
        raise error

    monkeypatch.setattr(run, "run_capture", fail)
    assert fly_cell(task()) == failed_row(task().cell, words)


def test_values_that_do_not_fit_together_fail_that_cell_only():
    study = study_of({"grid": {"simulation.time_step": [3e-4]}})
    row = fly_cell(CellTask(study.base, study.direct, study.cell(0)))
    assert "simulation.time_step = 0.0003 s does not divide" in row["error"]
    assert all(row[column.name] is None for column in MEASURES)


def test_columns_have_unit_and_description():
    by_name = {column.name: column for column in columns(STUDY)}
    assert by_name["published.impedance.mass"].unit == "kg"
    assert by_name["contact.corner"].kind is str
    assert all(column.unit and column.description for column in by_name.values())


def test_a_task_travels_as_a_small_pickle():
    packed = pickle.dumps(task())
    assert pickle.loads(packed) == task()
    assert len(packed) < 10_000
