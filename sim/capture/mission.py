"""A mission: the plant, perception, the controller and the monitor, one control tick after another.

`Mission.advance` is the only way that time passes: live, headless and in replay. Its loop is compiled;
`tick` is one turn of it. A mission belongs to one thread.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from sim.capture.caging import Cage, cage
from sim.capture.events import (
    Event,
    Ticks,
    closed_event,
    events_of,
    fault_event,
    locked_event,
    touch_event,
    verdict_event,
)
from sim.capture.monitor import (
    MONITOR,
    begin_monitoring,
    outcome_of,
    touches_of,
    watch,
)
from sim.capture.snapshots import Flown, snapshot_of
from sim.capture.stages import Visit, visits_after
from sim.capture.tick import TICK
from sim.capture.tick_loop import control_tick, fly, follow, know, recall, write_tick
from sim.config import Engine, MissionConfig, differences, is_live
from sim.configurations import require_clear_start, require_shape_for_method, revised
from sim.control.memory import MEMORY
from sim.control.phases import AT_REST, Command, Phase, Sequence, Verdict, next_phase
from sim.errors import MissionRefused, PlantDiverged, PlantError
from sim.method.method import begin_sequence, enter_phase, method_of
from sim.model.clearance import shapes_of
from sim.model.robot import chain, robot_model
from sim.perception.perceived import PERCEIVED, Perceived
from sim.plant.engine import simulated_plant
from sim.plant.plant import Plant, copy_state, diverged_at
from sim.record import Record, record_of
from sim.snapshot import Outcome, Snapshot, Touch


def prepare(engine: Engine = Engine.PYMUNK) -> None:
    """Compile all that a mission in that engine runs (half a minute at the first start; cached on disk afterwards)."""
    mission = Mission(revised(MissionConfig(), {"simulation": {"engine": engine.value}}))
    mission.request(Command.DIRECT_CAGE)
    mission.advance(2)
    mission.cage()


class Mark(NamedTuple):
    """Where a mission that follows a recording was."""

    config: MissionConfig
    memory: Record
    own: np.ndarray[Any, np.dtype[Any]]
    monitor: Record
    state: Record
    known: Perceived
    last: Ticks
    outcome: Outcome | None
    touches: tuple[Touch, ...]
    visits: tuple[Visit, ...]
    announced: frozenset[str]


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
        self._robot, self._shapes = robot_model(config.robot), shapes_of(config)
        self._parameters: Record = record_of(config)
        self._fault: PlantError | None = None
        self.method = method_of(config)
        self._own = np.zeros(1, self.method.memory)
        self._method_handle = self.method.handle(config, self._own)
        self._memory: Record = np.zeros(1, MEMORY)[0]
        begin_sequence(self._method_handle, self._memory, int(Phase.IDLE), int(Sequence.NONE))
        self._monitor: Record = np.zeros(1, MONITOR)[0]
        self._monitor["begun_at"] = math.nan
        self._known = np.zeros(1, PERCEIVED)
        self._monitor["open_touch"] = -1
        self._last = self._start()
        self._touches: list[Touch] = []
        self._visits = visits_after([], self._last, config)
        self._announced: set[str] = set()
        self._events: list[Event] = []
        self._outcome: Outcome | None = None

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
        return self._outcome

    def request(self, command: Command) -> None:
        """Grant an operator's request from the next tick on.

        Raises:
            MissionRefused: the phase does not allow it, or the method has no such command.

        """
        phase, sequence = next_phase(self.phase, command, self.method.commands)
        if self.activity == AT_REST and self.phase not in (Phase.DETUMBLING, Phase.CAGING):
            self._known[:] = np.zeros(1, PERCEIVED)  # ticks at rest are not recorded, and a replay must know the same
        begin_sequence(self._method_handle, self._memory, int(phase), int(sequence))
        if sequence is not Sequence.NONE:
            begin_monitoring(self._monitor, self.time, self._plant.state["momentum"])
            self._outcome = None
            self._touches = []
            self._visits = self._visits[-1:]
            self._announced = set()

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
        rows = np.zeros(ticks, TICK)
        flown = self._fly(rows) if self._plant.handle is not None else self._advance_paced(rows)
        rows = rows[:flown]
        if flown:
            self._announce(rows)
        if self._fault is not None:
            enter_phase(self._memory, int(Phase.FAULTED), AT_REST, int(Sequence.NONE))
            self._events.append(fault_event(self._fault, self.time, self.config.control.period))
        return rows

    def _fly(self, rows: Ticks) -> int:
        """How many of the rows were flown with a plant that compiled code steps."""
        plant = self._plant
        flown, finite = fly(
            plant.handle,
            self._method_handle,
            self._robot,
            self._shapes,
            self._parameters,
            self._memory,
            self._monitor,
            plant.state,
            self._known,
            rows,
        )
        if not finite:
            self._fault = PlantDiverged(diverged_at(self.time), tip="reset the mission")
        return flown

    def _advance_paced(self, rows: Ticks) -> int:
        """How many of the rows were flown with a plant that keeps its own time."""
        plant = self._plant
        for place in range(len(rows)):
            try:
                plant.observe()
                over = control_tick(
                    self._method_handle,
                    self._robot,
                    self._shapes,
                    self._parameters,
                    self._memory,
                    self._monitor,
                    plant.state,
                    self._known,
                    rows[place],
                )
                plant.apply_joint_rates(self._memory["commanded_joint_rate"])
            except PlantError as error:
                self._fault = error
                return place
            if over:
                return place + 1
        return len(rows)

    def recall(self, row: Any) -> None:
        """Take a recorded tick, one element of `TICK`, in place of the plant's state; such a mission never flies."""
        recall(row, self._plant.state)

    def follow(self, recorded: Ticks) -> Ticks:
        """What the current code judges and commands in recorded states, an array of `TICK`; the same ticks again."""
        rows = np.zeros(len(recorded), TICK)
        done = 0
        while done < len(rows):
            followed = follow(
                self._method_handle,
                self._robot,
                self._shapes,
                self._parameters,
                self._memory,
                self._monitor,
                self._plant.state,
                self._known,
                recorded[done:],
                rows[done:],
            )
            self._announce(rows[done : done + followed])
            done += followed
        return rows

    def mark(self) -> Mark:
        """Where a mission that follows a recording is now; `go_back` returns to it: a plant cannot go back."""
        return Mark(
            self.config,
            self._memory.copy(),
            self._own.copy(),
            self._monitor.copy(),
            self._plant.state.copy(),
            self._known.copy(),
            self._last,
            self._outcome,
            tuple(self._touches),
            tuple(self._visits),
            frozenset(self._announced),
        )

    def go_back(self, mark: Mark) -> None:
        """Return to where the mission was at that mark; it then follows as it did from there."""
        if mark.config is not self.config:
            self.config = mark.config
            self._adopt(mark.config)
        self._memory, self._monitor, self._known = mark.memory.copy(), mark.monitor.copy(), mark.known.copy()
        self._own[:] = mark.own
        copy_state(self._plant.state, mark.state)
        self._last, self._outcome = mark.last, mark.outcome
        self._touches, self._announced = list(mark.touches), set(mark.announced)
        self._visits = list(mark.visits)
        self._events = []

    def tick(self) -> Any:
        """Fly one control tick; its record, one element of `TICK`."""
        return self.advance(1)[0]

    def take_events(self) -> list[Event]:
        """The events since the last call, in the order in which they happened."""
        events, self._events = self._events, []
        return sorted(events, key=lambda event: event.time)

    def cage(self) -> Cage:
        """Whether the hands, if they stayed as in the last tick, cage the target."""
        row = self._last[-1]
        return cage(self.config, row["hand_pose"], row["target_pose"])

    def snapshot(self, phase: Phase | None = None) -> Snapshot:
        """The snapshot of the last tick; before the first tick, of the start.

        Args:
            phase: what the mission is in by now, if the last tick does not show it yet.

        """
        row = self._last[-1]
        flown = Flown(self.config, row, self._monitor, self._memory, self._visits, self._outcome)
        return snapshot_of(flown, Phase(int(row["phase"])) if phase is None else phase, self.phase)

    def _adopt(self, config: MissionConfig) -> None:
        self._parameters = record_of(config)
        self._method_handle = self.method.handle(config, self._own)

    def _start(self) -> Ticks:
        """The state before the first tick, as one row of `TICK`; nothing is flown."""
        rows = np.zeros(1, TICK)
        state, robot = self._plant.state, self._robot
        links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        watch(self._monitor, self._memory, self._parameters, robot, self._shapes, state, links)
        belief = self._known.copy()[0]  # the first tick perceives this state, and remembers it
        know(belief, self._parameters, robot, self._shapes, state, links, self._monitor["closed"])
        write_tick(rows[0], self._memory, self._monitor, state, links, belief)
        return rows

    def _announce(self, rows: Ticks) -> None:
        """Events of the ticks just flown, and the outcome if they reached a verdict."""
        self._events += events_of(rows, self._last, self.config)
        self._visits = visits_after(self._visits, rows, self.config)
        self._last = rows[-1:].copy()
        if math.isnan(self._monitor["begun_at"]):
            return
        period = self.config.control.period
        touches = touches_of(self._monitor)
        for place, touch in enumerate(touches):
            if place >= len(self._touches):
                self._events.append(touch_event(touch.model_copy(update={"end": None}), period))
            if touch.end is not None and (place >= len(self._touches) or self._touches[place].end is None):
                self._events.append(touch_event(touch, period))
        self._touches = touches
        self._announce_once("closed_at", closed_event)
        self._announce_once("locked_at", locked_event)
        if self._outcome is None and self._monitor["verdict"] != Verdict.NONE:
            self._outcome = outcome_of(self._monitor, self.config, float(rows[-1]["target_twist"][2]), self.cage())
            self._events.append(verdict_event(self._outcome, float(self._monitor["verdict_at"]), period))

    def _announce_once(self, field: str, event: Callable[[float, float], Event]) -> None:
        """The event of a noted instant [s], the first time that it is there."""
        instant = float(self._monitor[field])
        if not math.isnan(instant) and field not in self._announced:
            self._announced.add(field)
            self._events.append(event(instant, self.config.control.period))
