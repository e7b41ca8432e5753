"""A mission: the plant, perception, the controller and the monitor, one control tick after another.

`Mission.advance` is the only way that time passes: live, headless and in replay. Its loop is compiled;
`tick` is one turn of it. A mission belongs to one thread.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from sim.capture.caging import Cage, cage
from sim.capture.chronicle import Chronicle, Happened
from sim.capture.events import Event, Ticks, fault_event
from sim.capture.monitor import begin_monitoring
from sim.capture.refusal import refusal
from sim.capture.snapshots import Flown, snapshot_of
from sim.capture.tick import TICK
from sim.capture.tick_loop import FLIGHT, Flight, control_tick, fly, fly_unrecorded, follow, look, recall
from sim.compiled import compiling_alone
from sim.config import Engine, MissionConfig, differences, is_live
from sim.configurations import require_clear_start, require_shape_for_method
from sim.control.phases import AT_REST, Command, Phase, Sequence, next_phase
from sim.errors import MissionRefused, PlantDiverged, PlantError
from sim.method.method import MethodHandle, begin_sequence, enter_phase, method_of
from sim.method.registry import MethodName
from sim.model.clearance import shapes_of
from sim.model.robot import robot_model
from sim.perception.perceived import PERCEIVED
from sim.plant.engine import simulated_plant
from sim.plant.plant import Plant, SavedState, copy_state, diverged_at
from sim.record import Record, packed, record_of
from sim.snapshot import Outcome, Snapshot

_prepared: set[tuple[Engine, MethodName, bool]] = set()
_preparing = threading.Lock()


def prepare(config: MissionConfig, *, recorded: bool = True) -> None:
    """Compile all that a simulated mission so configured runs: a minute or so once, cached on disk afterwards.

    Of processes, or threads, that do so at once, one compiles; what has been prepared in this process takes no time.

    Args:
        config: of the mission; its engine and its method decide what is compiled.
        recorded: whether its ticks are kept; those of a study's cells are not.

    Raises:
        ConfigError: as `Mission`.

    """
    what = (config.simulation.engine, config.method, recorded)
    with _preparing:
        if what not in _prepared:
            with compiling_alone():
                _fly_a_little(config, recorded=recorded)
            _prepared.add(what)


def _fly_a_little(config: MissionConfig, *, recorded: bool) -> None:
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    if recorded:
        mission.advance(2)
    else:
        mission.advance_unrecorded(2)
    mission.cage()


_MOST_KEPT = 64
"""Rows of a flight that is not recorded, before its events are read from them."""


class Mark(NamedTuple):
    """Where a mission was: all but the plant, of which only what it last reported."""

    config: MissionConfig
    flight: Flight
    own: np.ndarray[Any, np.dtype[Any]]
    state: Record
    happened: Happened


class SavedMission(NamedTuple):
    """Where a mission was, and its plant: from there it flies the same ticks again, bit for bit."""

    mark: Mark
    plant: SavedState

    @property
    def tick(self) -> int:
        """The one that is flown next; what was granted or changed at it is not in it."""
        return int(self.plant.state["tick"])


class Mission:
    """One mission, on the simulated plant or on another."""

    def __init__(self, config: MissionConfig, plant: Plant | None = None) -> None:
        """Begin with the plant in its present state.

        Without one, a plant is laid out as configured, in the engine that is configured.

        Raises:
            ConfigError: the target overlaps the robot, or has a shape that the method cannot capture.

        """
        require_shape_for_method(config)
        if plant is None:
            require_clear_start(config)
        self.config = config
        self._plant = simulated_plant(config) if plant is None else plant
        self._fault: PlantError | None = None
        self._flight = np.zeros(1, FLIGHT)
        self._flight["robot"], self._flight["shapes"] = packed(robot_model(config.robot)), shapes_of(config)
        self._kept = np.zeros(_MOST_KEPT, TICK)
        self._memory: Record = self._flight[0]["memory"]
        self._monitor: Record = self._flight[0]["monitor"]
        self._known: Record = self._flight[0]["known"]
        self._flight["perceived_elsewhere"] = self._plant.perceived is not None
        self.method = method_of(config)
        self._own = np.zeros(1, self.method.memory)
        self._adopt(config)
        begin_sequence(self._method_handle, self._memory, int(Phase.IDLE), int(Sequence.NONE))
        self._monitor["begun_at"] = math.nan
        self._monitor["open_touch"] = -1
        self._chronicle = Chronicle(self._start(), config)

    @property
    def phase(self) -> Phase:
        """What the mission is doing."""
        return Phase(int(self._memory["phase"]))

    @property
    def activity(self) -> IntEnum:
        """What the hands are doing, one of the method's activities."""
        return self.method.activities(int(self._memory["activity"]))

    @property
    def fault(self) -> PlantError | None:
        """Why the plant can no longer be trusted; None while it can."""
        return self._fault

    @property
    def time(self) -> float:
        """Mission time [s]."""
        return float(self._plant.state["time"])

    @property
    def next_tick(self) -> int:
        """The tick that is flown next: what is granted now takes effect at it."""
        return self._plant.next_tick

    @property
    def outcome(self) -> Outcome | None:
        """How the last sequence ended; None before its verdict."""
        return self._chronicle.happened.outcome

    @property
    def monitor(self) -> Record:
        """What has been noted of the last sequence until now, one element of `MONITOR`: a copy."""
        return self._monitor.copy()

    def request(self, command: Command) -> None:
        """Grant an operator's request from the next tick on.

        Raises:
            MissionRefused: the phase does not allow it, or the method has no such command.

        """
        phase, sequence = next_phase(self.phase, command, self.method.commands)
        if self.activity == AT_REST and self.phase not in (Phase.DETUMBLING, Phase.CAGING):
            self._flight["known"] = np.zeros(1, PERCEIVED)  # ticks at rest are not recorded: a replay knows none
        begin_sequence(self._method_handle, self._memory, int(phase), int(sequence))
        if sequence is not Sequence.NONE:
            begin_monitoring(self._monitor, self.time, self._plant.state["momentum"])
            self._chronicle.begin_sequence()

    def refusal(self, command: Command, *, on_robot: bool) -> str:
        """Why a command cannot end well as things stand, with numbers; empty if it can. `request` does not ask."""
        return refusal(command, self.config, self.phase, self._chronicle.happened, on_robot=on_robot)

    def stop(self) -> None:
        """Joint rates zero from the next tick on; granted in every phase."""
        self.request(Command.STOP)

    def configure(self, config: MissionConfig) -> None:
        """Put a revised configuration in force from the next tick on.

        The admittance keeps its displacement and velocity, so that a hand's velocity does not jump.

        Raises:
            MissionRefused: a parameter differs that cannot change while a mission flies.

        """
        fixed = [path for path in differences(self.config, config) if not is_live(path)]
        if fixed:
            raise MissionRefused(
                f"{', '.join(fixed)} cannot change while a mission is under way",
                tip="reset the mission; the new value takes effect then",
            )
        self.config = config
        self._adopt(config)

    def advance(self, ticks: int) -> Ticks:
        """Fly up to that many control ticks; fewer if a verdict falls, after which the next call flies on.

        Returns:
            The ticks flown, an array of `TICK`.

        Raises:
            PlantError: the last call, which gave its ticks, ended in a state not to be trusted; phase `faulted`.

        """
        if self._fault is not None:
            raise self._fault
        rows = np.empty(ticks, TICK)
        flown, self._fault = _flown(self._plant, self._method_handle, self._flight, rows)
        rows = rows[:flown]
        if flown:
            self._chronicle.note(rows, self._monitor, self.config)
        self._end_if_faulted()
        return rows

    def advance_unrecorded(
        self, ticks: int, *, every: int = 0, on_kept: Callable[[Ticks], None] = lambda _: None
    ) -> int:
        """Fly as `advance` does, and as far, but keep no rows: what a tick costs less is what those cost.

        Args:
            ticks: to fly at most.
            every: rows of ticks that are a multiple of this are kept all the same; 0 for none.
            on_kept: called with what is kept of the ticks, consecutive arrays of `TICK` with gaps: those rows, and
                others; they are overwritten afterwards.

        Returns:
            How many ticks were flown.

        Raises:
            PlantError: as `advance`.

        """
        if self._fault is not None:
            raise self._fault
        plant, threshold = self._plant, self.method.spin_threshold(self.config)
        if plant.handle is None:
            return len(self.advance(ticks))
        total, finite, over = 0, True, False
        kept_rows = self._kept if every == 0 else np.empty(_MOST_KEPT + ticks // every, TICK)
        while finite and not over and total < ticks:
            flown, kept, finite, over = fly_unrecorded(
                plant.handle,
                self._method_handle,
                self._flight,
                plant.state,
                ticks - total,
                math.nan if threshold is None else threshold,
                every,
                kept_rows,
            )
            total += flown
            self._fault = None if finite else _diverged(plant)
            self._chronicle.note(kept_rows[:kept], self._monitor, self.config)
            on_kept(kept_rows[:kept])
        self._end_if_faulted()
        return total

    def _end_if_faulted(self) -> None:
        if self._fault is not None:
            enter_phase(self._memory, int(Phase.FAULTED), AT_REST, int(Sequence.NONE))
            self._chronicle.add(fault_event(self._fault, self.time, self.config.control.period))

    def perceive_as_recorded(self) -> None:
        """Know from here on what the recorded ticks that it follows say was known; such a mission never flies."""
        self._flight["perceived_elsewhere"] = True

    def recall(self, row: Any) -> None:
        """Take a recorded tick, one element of `TICK`, in place of the plant's state; such a mission never flies."""
        recall(row, self._plant.state)

    def follow(self, recorded: Ticks) -> Ticks:
        """What the current code judges and commands in recorded states, an array of `TICK`; the same ticks again."""
        rows = np.zeros(len(recorded), TICK)
        done = 0
        while done < len(rows):
            followed = follow(self._method_handle, self._flight, self._plant.state, recorded[done:], rows[done:])
            self._chronicle.note(rows[done : done + followed], self._monitor, self.config)
            done += followed
        return rows

    def mark(self) -> Mark:
        """Where the mission is now; one that follows a recording can `go_back` there, another mission `take_over`."""
        return Mark(
            self.config,
            self._flight.copy(),
            self._own.copy(),
            self._plant.state.copy(),
            self._chronicle.happened,
        )

    def go_back(self, mark: Mark) -> None:
        """Return to where the mission was at that mark; it then follows as it did from there."""
        if mark.config is not self.config:
            self.config = mark.config
            self._adopt(mark.config)
        self._flight[:], self._own[:] = mark.flight, mark.own
        copy_state(self._plant.state, mark.state)
        self._chronicle.go_back(mark.happened)

    def save(self) -> SavedMission | None:
        """All that the ticks to come follow from, but for what is granted or changed; None if it cannot be copied."""
        plant = self._plant.copyable
        return None if plant is None or self._fault is not None else SavedMission(self.mark(), plant.save())

    def restore(self, saved: SavedMission) -> None:
        """Stand where another mission that began as this one has stood.

        Raises:
            PlantError: this mission's plant cannot return to where it stood.

        """
        plant = self._plant.copyable
        if plant is None:
            raise PlantError("the plant cannot return to where it stood", tip="fly it again from the start")
        self.go_back(saved.mark)
        plant.restore(saved.plant)

    def take_over(self, mark: Mark) -> None:
        """Go on with what another mission remembered at that mark: sequence, beliefs, what was noted of the capture.

        Configuration and plant stay this mission's own. Of another method, the next request begins with its memory.
        """
        for field in ("memory", "monitor", "known"):
            self._flight[field] = mark.flight[field]
        if mark.config.method == self.config.method:
            self._own[:] = mark.own
        self._chronicle.go_back(mark.happened)

    def tick(self) -> Any:
        """Fly one control tick; its record, one element of `TICK`."""
        return self.advance(1)[0]

    def take_events(self) -> list[Event]:
        """The events since the last call, in the order in which they happened."""
        return self._chronicle.take_events()

    def cage(self) -> Cage:
        """Whether the hands, if they stayed as in the last tick, cage the target."""
        row = self._chronicle.happened.last[-1]
        return cage(self.config, row["hand_pose"], row["target_pose"])

    def snapshot(self) -> Snapshot:
        """The snapshot of the last tick; before the first tick, of the start."""
        flown = self.flown()
        return snapshot_of(flown, Phase(int(flown.row["phase"])), self.phase)

    def flown(self) -> Flown:
        """What a snapshot of the last tick is made of; it stays as it is while the mission flies on."""
        happened, monitor, memory = self._chronicle.happened, self._monitor.copy(), self._memory.copy()
        return Flown(self.config, happened.last[-1], monitor, memory, happened.visits, happened.outcome)

    def _adopt(self, config: MissionConfig) -> None:
        self._flight["parameters"] = record_of(config)
        self._method_handle = self.method.handle(config, self._own)

    def _start(self) -> Ticks:
        """The state before the first tick, as one row of `TICK`; nothing is flown."""
        _take_perceived(self._plant, self._flight)
        rows, known = np.zeros(1, TICK), self._known.copy()
        look(self._flight, self._plant.state, rows[0])
        self._flight["known"] = known  # the first tick perceives this state, and remembers it
        return rows


def _flown(plant: Plant, method: MethodHandle, flight: Flight, rows: Ticks) -> tuple[int, PlantError | None]:
    """How many of the rows were flown, and why the plant can no longer be trusted, if so."""
    if plant.handle is None:
        return _flown_paced(plant, method, flight, rows)
    flown, finite = fly(plant.handle, method, flight, plant.state, rows)
    return flown, None if finite else _diverged(plant)


def _flown_paced(plant: Plant, method: MethodHandle, flight: Flight, rows: Ticks) -> tuple[int, PlantError | None]:
    """The same with a plant that keeps its own time."""
    for place in range(len(rows)):
        try:
            plant.observe()
            _take_perceived(plant, flight)
            over = control_tick(method, flight, plant.state, rows[place])
            plant.apply_joint_rates(flight[0]["memory"]["commanded_joint_rate"])
        except PlantError as error:
            return place, error
        if over:
            return place + 1, None
    return len(rows), None


def _take_perceived(plant: Plant, flight: Flight) -> None:
    """What the plant's own sensors say, if it has any."""
    if plant.perceived is not None:
        flight["known"][0] = plant.perceived


def _diverged(plant: Plant) -> PlantDiverged:
    return PlantDiverged(diverged_at(float(plant.state["time"])), tip="reset the mission")
