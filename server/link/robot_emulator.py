"""An emulator of the air-bearing testbed at the robot's end of the link: the simulated plant in real time.

One thread does everything with the plant and the gate, 200 times a second: take what came, step, measure, report.
zenoh's threads only put messages into its inbox. Stamps are those of the schedule, so that a late wake-up of this
thread does not show in them, as it would not in a robot whose sensors are read by a clock.
"""

from __future__ import annotations

import logging
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from server.link import contract, wire
from server.link.clock import Clock
from server.link.contract import JOINT_NAMES, Channel, RobotMode
from server.link.faults import Faults, Outbox
from server.link.gate import Gate, Limits, Permission
from server.link.imperfections import Imperfections
from server.link.session import LinkSession, Transport
from server.link.testbed import EmulatedTestbed
from server.process.realtime import realtime_priority
from sim.compiled import FloatArray
from sim.config import MissionConfig

WAITING = 32
"""Messages of one key that wait for the thread, the oldest go first: more than a deadline's, and few enough to be read
within a control period. Each key has its own, so that none crowds out a STOP."""
OBEYED = (contract.STOP, contract.HEARTBEAT, contract.OPEN, contract.TARE, contract.JOINT_COMMAND)
"""In this order: STOP before everything else, who holds the robot before joint commands."""
GIVE_UP = 0.25
"""Lateness beyond which periods are made up for without a word [s]."""
MADE_UP = 5.0
"""The longest hold-up that is made up for [s]."""

log = logging.getLogger(__name__)


class RobotSettings(BaseModel):
    """An emulated robot."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    transport: Transport
    config: MissionConfig
    name: str = Field("emulator", pattern=r"^[A-Za-z0-9_-]{1,64}$", description="Of the robot")
    seed: int = Field(0, ge=0, description="Of every random number")
    deadline: float = Field(contract.DEADLINE, gt=0.01, le=10, description="Of heartbeat and joint commands [s]")
    clock_offset: float = Field(0.0, ge=-1e6, le=1e6, description="How far its clock is ahead of the machine's [s]")
    imperfections: Imperfections = Imperfections()


class _Message(NamedTuple):
    payload: bytes
    arrived: int


class RobotStatus(BaseModel):
    """What the emulator knows of itself, and no robot could report."""

    robot: str = Field(description="Identity: its name, and what it drew when it was last started")
    mode: RobotMode
    why: str
    session: str
    time: float = Field(description="Simulated time [s]")
    boots: int = Field(description="1 at first, one more after each restart")
    seed: int
    commands: int = Field(description="Joint commands followed since the boot")
    refused: int = Field(description="Refused since the boot")
    last_refusal: str
    lateness: float = Field(description="Worst of a cycle in the last second [s]")
    peak_force: float = Field(description="Largest true force of a hand since the boot [N]")
    joint_rate: list[list[float]] = Field(description="True joint rates [rad/s]")
    base_pose: list[float]
    target_pose: list[float]
    target_twist: list[float]
    faults: Faults


class RobotEmulator:
    """An emulated robot from its start to its end, restarts included."""

    def __init__(self, settings: RobotSettings) -> None:
        self.settings = settings
        self._faults = Faults()
        self._clock = Clock(settings.clock_offset)
        self._ended = threading.Event()
        self._restart: tuple[float, int] | None = None
        self._boots = 0
        self._seed = settings.seed
        self._robot: _Robot | None = None
        self.ready = threading.Event()
        self.left_open = False
        """Whether the link did not close when the robot last ended."""

    @realtime_priority()
    def run(self) -> None:
        """Be the robot, in this thread, until `shutdown`.

        Raises:
            ConfigError: the link cannot be opened.

        """
        while not self._ended.is_set():
            self._boots += 1
            robot = self._robot = _Robot(self.settings, self._clock, self._seed)
            robot.outbox.faults = self._faults
            self.ready.set()
            try:
                robot.run(self._stays)
            finally:
                self.left_open = not robot.close()
            if self._restart is not None:
                pause, self._seed = self._restart
                self._restart = None
                self._ended.wait(pause)

    def shutdown(self) -> None:
        """End it; for any thread."""
        self._ended.set()

    def inject_faults(self, faults: Faults) -> None:
        """Have these faults from now on."""
        self._faults = faults
        if self._robot is not None:
            self._robot.outbox.faults = faults

    @property
    def faults(self) -> Faults:
        """In force."""
        return self._faults

    def hang(self, duration: float) -> None:
        """Neither listen nor speak for that long [s]; the plant floats on."""
        if self._robot is not None:
            self._robot.hang(duration)

    def restart(self, pause: float, seed: int | None = None) -> None:
        """Lose everything, and come back after a pause [s] with the plant as at the start."""
        self._restart = (pause, self._seed if seed is None else seed)

    def status(self) -> RobotStatus | None:
        """What there is to know; None before the first start."""
        return self._robot.status(self._boots, self._seed) if self._robot is not None else None

    def _stays(self) -> bool:
        return not self._ended.is_set() and self._restart is None


class _Robot:
    """One life of the emulated robot."""

    def __init__(self, settings: RobotSettings, clock: Clock, seed: int) -> None:
        config = settings.config
        self._testbed = EmulatedTestbed(config, settings.imperfections, seed)
        self._period = config.control.period
        self._clock = clock
        self._seed = seed
        self._identity = f"{settings.name}.{secrets.token_hex(4)}"
        self._gate = Gate(Limits(config.control.rates.joint_rate_limit, settings.deadline), self._identity)
        self._mode_every = max(1, round(1.0 / (contract.MODE_RATE * self._period)))
        self._inboxes: dict[Channel, deque[_Message]] = {channel: deque(maxlen=WAITING) for channel in OBEYED}
        self._applied = np.zeros((2, 3))
        self._hung_until = 0.0
        self._shown: tuple[Any, ...] = ()
        self._cycle = 0
        self._late: deque[float] = deque(maxlen=round(1.0 / self._period))
        _warm_up(settings, seed, self._identity)
        self._session = LinkSession(settings.transport)
        self.outbox = Outbox(self._session.publish, seed)
        for channel in OBEYED:
            take = self._take_heartbeat if channel is contract.HEARTBEAT else self._taker(channel)
            self._session.subscribe(channel, take)

    def run(self, stays: Callable[[], bool]) -> None:
        """Cycle at the control period as long as `stays` says so."""
        due = time.monotonic()
        while stays():
            due += self._period
            now = time.monotonic()
            late = now - due
            if late > GIVE_UP:
                log.warning("the emulator was held up for %.0f ms", 1e3 * late)
                due = self._float_on(due, now)
            time.sleep(max(0.0, due - time.monotonic()))
            self._late.append(max(late, time.monotonic() - due))
            self._turn(self._clock.at(due), time.monotonic())

    def close(self) -> bool:
        """Leave the link; whether it closed in time."""
        self.outbox.close()
        return self._session.close()

    def hang(self, duration: float) -> None:
        """Neither listen nor speak for that long [s]."""
        self._hung_until = time.monotonic() + duration

    def status(self, boots: int, seed: int) -> RobotStatus:
        """What the emulator knows of itself; for any thread."""
        gate, state = self._gate, self._testbed.state
        return RobotStatus(
            robot=self._identity,
            mode=gate.mode,
            why=gate.why,
            session=gate.session,
            time=float(state["time"]),
            boots=boots,
            seed=seed,
            commands=gate.accepted,
            refused=gate.refused,
            last_refusal=gate.last_refusal,
            lateness=max(self._late, default=0.0),
            peak_force=self._testbed.peak_force,
            joint_rate=state["joint_rate"].tolist(),
            base_pose=state["base_pose"].tolist(),
            target_pose=state["target_pose"].tolist(),
            target_twist=state["target_twist"].tolist(),
            faults=self.outbox.faults,
        )

    def _turn(self, stamp: int, monotonic: float) -> None:
        """One control period, that ends at `stamp`: it was flown at the rates that held when it began."""
        hung = monotonic < self._hung_until
        self._gate.check(self._clock.now())  # before what waited: it may be too late for it
        if not hung:
            self._take_all()
        self._move(self._clock.now())
        self._cycle += 1
        if not hung:
            self._measure(stamp)
            self._tell_mode(stamp)

    def _float_on(self, due: float, until: float) -> float:
        """Make up for periods in which this process was held up: a robot would have moved on, and held in time."""
        due = max(due, until - MADE_UP)
        while due < until:
            self._move(self._clock.at(due))
            due += self._period
        return due

    def _move(self, now: int) -> None:
        """One control period of the plant; then the rates for the next one."""
        self._testbed.move(self._driven(self._applied))
        self._applied = self._gate.rates(now, self._period).copy()

    def _driven(self, rates: FloatArray) -> FloatArray:
        """The joint rates that reach the servos."""
        stuck = self.outbox.faults.joint_stuck
        if stuck is None:
            return rates
        driven = rates.copy()
        driven.flat[JOINT_NAMES.index(stuck)] = 0.0
        return driven

    def _taker(self, channel: Channel) -> Callable[[bytes], None]:
        inbox = self._inboxes[channel]
        return lambda payload: inbox.append(_Message(payload, self._clock.now()))

    def _take_heartbeat(self, payload: bytes) -> None:
        """Send a heartbeat back as soon as it comes, so that its way can be timed."""
        arrived = self._clock.now()
        self._inboxes[contract.HEARTBEAT].append(_Message(payload, arrived))
        if time.monotonic() >= self._hung_until:
            try:
                call = wire.decode_call(payload)
            except wire.WireError:
                return  # the thread that obeys it counts it
            echo = wire.Echo(arrived, call.stamp, call.session, self._identity)
            self.outbox.send(contract.HEARTBEAT_ECHO, wire.encode_echo(echo))

    def _take_all(self) -> None:
        """Obey what came; whatever its bytes are, the robot goes on."""
        for channel, inbox in self._inboxes.items():
            for message in [inbox.popleft() for _ in range(len(inbox))]:
                try:
                    self._obey(channel, message)
                except Exception as error:
                    self._gate.unreadable(channel.key, str(error), self._clock.now())
                    if channel is contract.STOP:
                        self._gate.stop(None, self._clock.now())

    def _obey(self, channel: Channel, message: _Message) -> None:
        now = self._clock.now()
        if channel is contract.JOINT_COMMAND:
            self._gate.joint_command(wire.decode_joint_command(message.payload), now, message.arrived)
            return
        call = wire.decode_call(message.payload)
        if channel is contract.HEARTBEAT:
            self._gate.heartbeat(call, message.arrived)
        elif channel is contract.STOP:
            self._acknowledge(channel, call, self._gate.stop(call, now))
        elif channel is contract.OPEN:
            self._acknowledge(channel, call, self._gate.open(call, now))
        else:
            self._acknowledge(channel, call, self._tare(call, now))

    def _tare(self, call: wire.RobotCall, now: int) -> Permission:
        refusal = self._gate.refuse_tare(call, now)
        if refusal:
            return Permission(False, refusal)
        self._testbed.tare()
        return Permission(self._testbed.tared, "" if self._testbed.tared else "no reading yet")

    def _acknowledge(self, channel: Channel, call: wire.RobotCall, verdict: Permission) -> None:
        name = channel.key.removeprefix(f"{contract.PREFIX}/")
        values = {"session": call.session, "stamp": str(call.stamp)}
        report = wire.StatusReport(self._clock.now(), self._identity, name, verdict.granted, verdict.reason, values)
        self.outbox.send(contract.ACKNOWLEDGEMENT, wire.encode_report(report))

    def _measure(self, stamp: int) -> None:
        for channel, payload, delay in self._testbed.measure(stamp, self._identity, self.outbox.faults.sensor_freeze):
            self.outbox.send(channel, payload, delay)

    def _tell_mode(self, stamp: int) -> None:
        gate = self._gate
        shown = (gate.mode, gate.session, gate.why, gate.last_refusal)
        if shown == self._shown and self._cycle % self._mode_every:
            return
        self._shown = shown
        healthy = gate.mode in (RobotMode.WAITING, RobotMode.FOLLOWING)
        report = wire.StatusReport(stamp, self._identity, "robot", healthy, gate.mode, self._mode_values())
        self.outbox.send(contract.MODE, wire.encode_report(report))

    def _mode_values(self) -> Mapping[str, str]:
        gate = self._gate
        ages = gate.ages
        return {
            "contract": contract.VERSION,
            "session": gate.session,
            "why": gate.why,
            "tared": str(self._testbed.tared).lower(),
            "commands": str(gate.accepted),
            "refused": str(gate.refused),
            "last_refusal": gate.last_refusal,
            "command_age_p50": "" if ages is None else f"{ages[0]:.6f}",
            "command_age_p99": "" if ages is None else f"{ages[1]:.6f}",
        }


def _warm_up(settings: RobotSettings, seed: int, identity: str) -> None:
    """Load all compiled code before the schedule begins."""
    testbed = EmulatedTestbed(settings.config, settings.imperfections, seed)
    testbed.move(np.zeros((2, 3)))
    for _ in testbed.measure(0, identity):
        pass
