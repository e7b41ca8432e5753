"""A mission's face: snapshot, events, ticks (whole missions: tests/physics/test_whole_missions.py)."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command, Phase
from sim.snapshot import Snapshot

SHORT = revised(MissionConfig(), nested({"judging.time_limit": 0.5}))


class TestSnapshot:
    def test_before_the_first_tick_is_of_the_start(self):
        snapshot = Mission(MissionConfig()).snapshot()
        assert (snapshot.tick, snapshot.time, snapshot.phase) == (0, 0.0, "idle")
        assert snapshot.target.pose == (0.0, 0.35, 0.0)
        assert snapshot.spin == 1.0
        assert snapshot.plan is None
        assert snapshot.outcome is None
        assert snapshot.contacts == []

    def test_is_of_the_last_tick(self):
        mission = Mission(MissionConfig())
        mission.request(Command.CAPTURE)
        row = mission.advance(300)[-1]
        snapshot = mission.snapshot()
        assert snapshot.tick == row["tick"] == 299
        assert snapshot.phase == "detumbling"
        assert snapshot.activity == "approaching"
        assert snapshot.right.hand_pose == tuple(row["hand_pose"][1])
        assert snapshot.left.joint_angle == tuple(row["joint_angle"][0])

    def test_shows_the_plan_with_its_working_hand(self):
        mission = Mission(MissionConfig())
        mission.request(Command.CAPTURE)
        mission.advance(10)
        plan = mission.snapshot().plan
        assert plan.kind == "touch"
        assert plan.left == []
        assert len(plan.right) == len(plan.times) == 3
        mission.request(Command.CAGE)
        mission.advance(10)
        assert mission.snapshot().plan.kind == "cage"
        assert len(mission.snapshot().plan.left) == 3

    def test_survives_json(self):
        mission = Mission(MissionConfig())
        mission.request(Command.CAPTURE)
        mission.advance(100)
        snapshot = mission.snapshot()
        assert Snapshot.model_validate_json(snapshot.model_dump_json()) == snapshot


class TestTicks:
    def test_are_numbered_on_and_carry_the_state_they_began_with(self):
        mission = Mission(MissionConfig())
        rows = np.concatenate([mission.advance(3), mission.advance(4)])
        assert rows["tick"].tolist() == list(range(7))
        assert rows["time"] == pytest.approx(1e-3 * np.arange(7))
        assert rows[0]["target_pose"].tolist() == [0.0, 0.35, 0.0]

    def test_one_tick_is_one_row(self):
        assert Mission(MissionConfig()).tick()["tick"] == 0

    def test_none_are_none(self):
        assert len(Mission(MissionConfig()).advance(0)) == 0

    def test_stop_at_a_verdict_once(self):
        mission = Mission(SHORT)
        mission.request(Command.CAPTURE)
        assert len(mission.advance(2000)) == 501
        assert mission.outcome is not None
        assert mission.phase is Phase.HOLDING
        assert len(mission.advance(2000)) == 2000


class TestEvents:
    def test_are_taken_once_and_in_order(self):
        mission = Mission(SHORT)
        mission.request(Command.CAPTURE)
        mission.advance(2000)
        events = mission.take_events()
        assert [event.kind for event in events][:2] == ["phase", "plan"]
        assert events[-1].kind in {"verdict", "phase"}
        assert "verdict" in [event.kind for event in events]
        assert [event.time for event in events] == sorted(event.time for event in events)
        assert mission.take_events() == []


@pytest.mark.parametrize("engine", ["pymunk", "reduced"])
class TestUnrecorded:
    def config(self, engine):
        changes = {"simulation.engine": engine, "published.caging.spin_threshold": 0.9}
        return revised(named_configuration("published"), nested(changes))

    def test_is_the_same_flight(self, engine):
        """Events, outcome, last tick, stages, and the ticks after it: whether rows were kept makes no difference."""
        seen = []
        for recorded in (True, False):
            mission = Mission(self.config(engine))
            mission.request(Command.CAPTURE)
            ticks = 0
            while mission.outcome is None:
                ticks += len(mission.advance(700)) if recorded else mission.advance_unrecorded(700)
            seen.append((ticks, mission.take_events(), mission.snapshot(), mission.advance(1).tobytes()))
        assert seen[0] == seen[1]

    def test_reads_its_events_though_there_are_more_than_rows_to_keep(self, engine):
        seen = []
        for recorded in (True, False):
            changes = {"published.caging.spin_threshold": 1.0, "perception.noise.spin": 0.05}
            mission = Mission(revised(self.config(engine), nested(changes)))
            mission.request(Command.CAPTURE)
            ticks = len(mission.advance(1500)) if recorded else mission.advance_unrecorded(1500)
            seen.append((ticks, mission.take_events()))
        assert seen[0] == seen[1]
        assert len(seen[0][1]) > 64

    def test_flies_on_after_a_verdict_for_as_long_as_it_is_asked_to(self, engine, monkeypatch):
        monkeypatch.setattr("sim.capture.mission._MOST_KEPT", 5)  # room for one tick's rows at a time
        mission = Mission(self.config(engine))
        mission.request(Command.DIRECT_CAGE)
        while mission.outcome is None:
            mission.advance_unrecorded(5000)
        assert mission.advance_unrecorded(10) == 10


class TestRunCapture:
    def test_gives_consecutive_ticks_and_counts_them(self):
        ticks = []
        result = run_capture(SHORT, on_ticks=ticks.append)
        rows = np.concatenate(ticks)
        assert rows["tick"].tolist() == list(range(result.ticks))
        assert result.simulated_time == pytest.approx(result.ticks * 1e-3)
        assert result.outcome.duration == pytest.approx(0.5)
        assert result.real_time_factor > 0.0

    def test_what_its_listener_raises_ends_it(self):
        def full(_rows):
            raise OSError("no space left on device")

        with pytest.raises(OSError, match="no space left"):
            run_capture(SHORT, on_ticks=full)


def test_no_sequence_begins_while_a_caged_target_is_held():
    mission = Mission(revised(named_configuration("becalm"), {"simulation": {"engine": "reduced"}}))
    mission.request(Command.CAPTURE)
    for _ in range(20):
        mission.advance(1000)
    assert mission.outcome is not None
    assert mission.outcome.caged
    for command in (Command.CAPTURE, Command.DETUMBLE, Command.CAGE):
        assert "release it first" in mission.refusal(command, on_robot=False)
    mission.request(Command.RELEASE)
    mission.advance(2000)
    mission.request(Command.HOLD)
    assert not mission.refusal(Command.CAPTURE, on_robot=False)
