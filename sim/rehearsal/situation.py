"""A state that futures begin in: what is believed of robot and target, and what the controller remembers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.capture.events import Ticks
from sim.capture.mission import Mark, Mission
from sim.capture.refusal import refusal
from sim.capture.replay import FlightHistory, Follower
from sim.compiled import FloatArray
from sim.config import Estimator, MissionConfig, Source
from sim.control.phases import Command, Phase, Sequence, next_phase
from sim.errors import MissionRefused
from sim.method.method import method_of
from sim.plant.plant import PLANT_STATE
from sim.record import Record

_BELIEVED = (
    "base_pose", "base_twist", "joint_angle", "joint_rate", "mount_angle", "mount_rate", "target_pose", "target_twist",
)  # fmt: skip
"""What `PERCEIVED` has of a state; what else a plant reports follows from it."""

_RATES = {
    "base_pose": "base_twist", "joint_angle": "joint_rate", "mount_angle": "mount_rate", "target_pose": "target_twist",
}  # fmt: skip


@dataclass(frozen=True)
class Situation:
    """One instant of a mission, as the controller knows it. What the simulation knows beside that is not in it."""

    mark: Mark
    """What the mission remembered; its state is the believed one."""

    @classmethod
    def of(cls, mission: Mission) -> Situation:
        """That a mission is in now; a copy, so that the mission may fly on."""
        return cls.at(mission.mark(), mission.next_tick)

    @classmethod
    def at(cls, mark: Mark, next_tick: int) -> Situation:
        """That a mission is in at that mark, before that tick: what was believed at its last one, moved on to it.

        Whose last belief was the truth to the last bit reads the next state as well: that it is then. A robot's mission
        time is its clock's; futures count theirs by ticks, so that theirs begin at the nearest one.
        """
        last, known, state = mark.happened.last[0], mark.flight[0]["known"], np.zeros(1, PLANT_STATE)[0]
        remembered = known["time"] == last["time"] and known["base_pose"].any()
        perfect = remembered and all(np.array_equal(known[name], last[name]) for name in _BELIEVED)
        if perfect and last["tick"] < mark.state["tick"] == next_tick:
            return cls(mark)
        for name in _BELIEVED:
            state[name] = known[name] if remembered else _from_row(last, name)
        state["tip_contact"] = (known if remembered else last)["tip_contact"]
        period = mark.config.control.period
        tick = round(float(last["time"]) / period) + next_tick - int(last["tick"])
        state["tick"], state["time"] = tick, tick * period
        ahead = float(state["time"] - last["time"])
        for name, rate in _RATES.items():
            state[name] += ahead * state[rate]
        return cls(mark._replace(state=state))

    @classmethod
    def recorded(cls, history: FlightHistory, chunks: Iterable[Ticks], at: float) -> Situation:
        """That a recorded mission was in at a time [s]: the controller is driven through the ticks until then.

        Args:
            history: what was done to it.
            chunks: its recorded ticks, consecutive arrays of `TICK`; at least until then.
            at: mission time; the last tick not later than that one counts.

        Raises:
            MissionRefused: nothing is recorded until then, or a command that was granted then is refused now.

        """
        follower, period = Follower(history), history.config.control.period
        followed = 0
        for chunk in chunks:
            wanted = chunk[chunk["time"] <= at + 0.5 * period]
            if len(wanted):
                follower.follow(wanted)
                followed += len(wanted)
                follower.mission.take_events()
            if len(wanted) < len(chunk):
                break
        if not followed:
            raise MissionRefused(f"at = {at:g} s: no tick is recorded until then", tip="take a later time")
        mark = follower.mission.mark()
        return cls.at(mark, int(mark.happened.last[0]["tick"]) + 1)

    @property
    def config(self) -> MissionConfig:
        """In force."""
        return self.mark.config

    @property
    def state(self) -> Record:
        """What is believed, one element of `PLANT_STATE`."""
        return self.mark.state

    @property
    def tick(self) -> int:
        """Of the state."""
        return int(self.state["tick"])

    @property
    def time(self) -> float:
        """Mission time [s]."""
        return float(self.state["time"])

    @property
    def target_pose(self) -> FloatArray:
        """Believed, shape (3,)."""
        pose: FloatArray = self.state["target_pose"]
        return pose

    @property
    def phase(self) -> Phase:
        """What the mission is doing."""
        return Phase(int(self.mark.flight[0]["memory"]["phase"]))

    @property
    def touching(self) -> bool:
        """Whether a hand is felt to touch the target."""
        return bool(self.mark.flight[0]["known"]["touching"].any() or self.state["tip_contact"].any())

    @property
    def estimate(self) -> Record | None:
        """What the filters of base and target believe and how surely, one element of `MOTION`; None without filters."""
        perception, motion = self.config.perception, self.mark.flight[0]["known"]["motion"]
        filtered = perception.estimator is Estimator.MODEL_BASED or perception.source is Source.MOTION_CAPTURE
        return motion if filtered and motion["target"]["taken"] > 0 else None

    def require_can_begin(self, config: MissionConfig, request: Command | None) -> None:
        """Refuse a request that would not be granted here, or that no verdict follows.

        Args:
            config: that would be in force.
            request: the sequence to begin; None goes on with the one under way.

        Raises:
            MissionRefused: the message says why.

        """
        if request is None:
            self._require_under_way(config)
            return
        if request not in REQUESTS:
            known = ", ".join(each.value for each in REQUESTS)
            raise MissionRefused(
                f"request = {request.value}: no verdict follows it",
                tip=f"rehearse {known}, or leave request out to go on with what is under way",
            )
        next_phase(self.phase, request, method_of(config).commands)
        if self.touching:
            raise MissionRefused(
                f"request = {request.value}: a hand touches the target, and no sequence can begin there",
                tip="leave request out to go on with what is under way, or release the target first",
            )
        if speaks_against := refusal(request, config, self.phase, self.mark.happened, on_robot=False):
            raise MissionRefused(speaks_against)

    def _require_under_way(self, config: MissionConfig) -> None:
        memory, known = self.mark.flight[0]["memory"], ", ".join(each.value for each in REQUESTS)
        if self.mark.happened.outcome is not None or memory["sequence"] in (Sequence.NONE, Sequence.DETUMBLE_ONLY):
            raise MissionRefused(
                f"request = none: no capture is under way in phase {self.phase.label}", tip=f"name one of {known}"
            )
        if config.method is not self.config.method:
            raise MissionRefused(
                f"method = {config.method.value}: {self.config.method.value} is under way, and cannot be taken over",
                tip=f"name a request, one of {known}",
            )


REQUESTS = (Command.CAPTURE, Command.CAGE, Command.DIRECT_CAGE)
"""What can be rehearsed: the sequences that end with a verdict."""


def _from_row(row: Any, name: str) -> Any:
    """What a recorded tick says was believed, and the truth where it has no such field."""
    believed = name.replace("_", "_perceived_")
    return row[believed] if believed in (row.dtype.names or ()) else row[name]
