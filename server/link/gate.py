"""What the robot's end lets through: pure decisions about sessions, joint commands, heartbeats and STOP.

A robot follows one session at a time. What is old, out of order, beyond the limits or from another session is refused
with the reason. A heartbeat or joint command that is late ends the session: joint rates ramp to zero and stay there
until a new session is opened, so that nothing which waited in a queue while the link was broken is executed after it.
"""

from __future__ import annotations

import logging
import re
from collections import deque
from typing import NamedTuple

import numpy as np

from server.link.contract import DEADLINE, JOINT_NAMES, SESSION, RobotMode
from server.link.refusals import ThrottledLog
from server.link.wire import JointCommand, RobotCall, printable
from sim.compiled import FloatArray

RAMP_TIME = 0.05
"""From full rates to zero, when the session is lost [s]."""
AHEAD = 5_000_000
"""How far a stamp may lie in the receiver's future: no state has that one yet [ns]."""
SHOWN_NAME = 80
"""Characters of a session's name in what the robot reports."""
AGES_KEPT = 400
"""Ages of joint commands that percentiles are taken of: two seconds."""

log = logging.getLogger(__name__)


class Limits(NamedTuple):
    """What the robot itself allows."""

    joint_rate: float = 10.0
    """Largest joint rate that is followed [rad/s]."""
    deadline: float = DEADLINE
    """How old a heartbeat or joint command may be [s]."""


class Permission(NamedTuple):
    """The answer to a request."""

    granted: bool
    reason: str = ""


class Gate:
    """The robot's guard. Times are whole nanoseconds of the robot's clock."""

    def __init__(self, limits: Limits, robot: str) -> None:
        """The guard of the robot of that identity."""
        self.limits = limits
        self.robot = robot
        self.mode = RobotMode.WAITING
        self.why = "no session yet"
        self.session = ""
        self.accepted = 0
        self.refused = 0
        self.last_refusal = ""
        self._deadline = round(1e9 * limits.deadline)
        self._throttled_log = ThrottledLog(log)
        self._ages: deque[float] = deque(maxlen=AGES_KEPT)
        self._wanted = np.zeros((2, 3))
        self._given = np.zeros((2, 3))
        self._heard = 0
        self._heartbeat = 0
        self._joint_commanded = 0
        self._answered = 0
        self._opened = 0
        self._stopped = 0

    def open(self, call: RobotCall, now: int) -> Permission:
        """Give the robot to a session, unless another console holds it and is alive.

        The request answers a joint state, as a joint command does: one that waited somewhere, or was sent before the
        last STOP or the last session, is refused whoever sent it, and however its session is numbered.
        """
        reason = self._fault_of_opening(call, now)
        if reason:
            return self._refuse(call.session, reason, now)
        if call.session == self.session:
            return Permission(True)  # once more: its acknowledgement was not heard yet
        self.session, self.mode, self.why = call.session, RobotMode.FOLLOWING, ""
        self._heard, self._heartbeat, self._joint_commanded = now, 0, now
        self._opened = call.stamp
        self._wanted[:] = 0.0
        log.info("session %s holds the robot", call.session)
        return Permission(True)

    def stop(self, call: RobotCall | None, now: int) -> Permission:
        """Joint rates zero; anyone may, also by a message that cannot be read."""
        session = call.session if call is not None else ""
        self.mode, self.why = RobotMode.STOPPED, f"STOP from {printable(session, SHOWN_NAME) or 'unknown'}"
        self._stopped = now
        self._wanted[:] = self._given[:] = 0.0
        self._throttled_log.warning("stop", self.why, 1e-9 * now)
        return Permission(True)

    def heartbeat(self, call: RobotCall, now: int) -> None:
        """Note that the holder of the session is alive.

        Its clock is not known here, but that it runs as this one does: a stamp that is further ahead of the last one
        than time has passed is not the holder's, and would make its next ones look old.
        """
        if call.session != self.session or call.stamp <= self._heartbeat:
            return
        ahead = call.stamp - self._heartbeat - (now - self._heard) - self._deadline
        if self._heartbeat and ahead > 0:
            self._refuse(call.session, f"its heartbeat's stamp jumped ahead by {1e-6 * ahead:.0f} ms", now)
            return
        self._heartbeat, self._heard = call.stamp, now

    def joint_command(self, command: JointCommand, now: int, arrived: int | None = None) -> Permission:
        """Follow these joint rates from now on, or refuse them; they arrived now, or were looked at later."""
        reason = self._fault_of(command, now)
        if reason:
            return self._refuse(command.session, reason, now)
        self._answered, self._joint_commanded = command.stamp, now
        self._wanted[:] = command.rate
        self.accepted += 1
        self._ages.append(1e-9 * ((now if arrived is None else arrived) - command.stamp))
        return Permission(True)

    def rates(self, now: int, period: float) -> FloatArray:
        """Joint rates for the period [s] that begins now, shape (2, 3) [rad/s]."""
        self.check(now)
        if self.mode is RobotMode.FOLLOWING:
            self._given[:] = self._wanted
        elif self._given.any():
            step = self.limits.joint_rate * period / RAMP_TIME
            self._given -= np.clip(self._given, -step, step)
        return self._given

    def check(self, now: int) -> None:
        """Let the session go if its heartbeat or its joint commands are late."""
        if self.mode is not RobotMode.FOLLOWING:
            return
        for what, since in (("heartbeat", self._heard), ("joint commands", self._joint_commanded)):
            if now - since > self._deadline:
                self._hold(f"no {what} for {1e-6 * (now - since):.0f} ms")
                return

    @property
    def ages(self) -> tuple[float, float] | None:
        """Median and 99 % quantile of the ages of the last joint commands when they arrived [s]."""
        if not self._ages:
            return None
        median, most = np.quantile(np.array(self._ages), (0.5, 0.99)).tolist()
        return median, most

    def _hold(self, why: str) -> None:
        self.mode, self.why = RobotMode.HOLDING, why
        self._wanted[:] = 0.0
        log.warning("session %s: %s; joint rates go to zero", self.session, why)

    def _fault_of_opening(self, call: RobotCall, now: int) -> str:
        """Why a session cannot be opened; empty if it can."""
        asked, own = re.fullmatch(SESSION, call.session), re.fullmatch(SESSION, self.session)
        if asked is None:
            return "a session is named CONSOLE.NUMBER@ROBOT"
        if asked["robot"] != self.robot:
            return f"this robot is {self.robot}"
        if self.mode is RobotMode.FOLLOWING and own is not None and own["console"] != asked["console"]:
            return f"the robot is held by {self.session}"
        if call.session == self.session:
            return "" if self.mode is RobotMode.FOLLOWING else f"it was let go: {self.why}"
        return self._overtaken(call.stamp) or self._untimely(call.stamp, now)

    def _overtaken(self, stamp: int) -> str:
        """What has come after the state of that stamp and wins over a request that answers it; empty if nothing has."""
        if stamp <= self._opened:
            return f"session {self.session} is newer"
        return f"it was asked for before the {self.why}" if stamp <= self._stopped else ""

    def _untimely(self, stamp: int, now: int) -> str:
        """Why what answers that state is not of now; empty if it is."""
        age = now - stamp
        if age > self._deadline:
            return f"old: it answers a state of {1e-6 * age:.0f} ms ago, at most {1e3 * self.limits.deadline:.0f} ms"
        if age < -AHEAD:
            return f"it answers a state of {-1e-6 * age:.0f} ms in the future"
        return ""

    def _fault_of(self, command: JointCommand, now: int) -> str:
        """Why a joint command cannot be followed; empty if it can."""
        if command.session != self.session or not self.session:
            return f"another session holds the robot ({self.session or 'none'})"
        if self.mode is not RobotMode.FOLLOWING:
            return f"the robot is {self.mode}: {self.why}"
        late = self._untimely(command.stamp, now)
        if late:
            return late
        if command.stamp <= self._answered:
            return "out of order: this state or a later one was answered already"
        return self._beyond(command.rate)

    def _beyond(self, rate: FloatArray) -> str:
        fastest = int(np.abs(rate).argmax())
        value, limit = float(rate.flat[fastest]), self.limits.joint_rate
        return f"{JOINT_NAMES[fastest]} = {value:.3g} rad/s: the limit is {limit:g} rad/s" if abs(value) > limit else ""

    def refuse_tare(self, call: RobotCall, now: int) -> str:
        """Why the wrists cannot be tared; empty if they can."""
        if call.session != self.session or not self.session:
            return f"another session holds the robot ({self.session or 'none'})"
        return "the arms move" if self._given.any() else self._untimely(call.stamp, now)

    def unreadable(self, what: str, reason: str, now: int) -> None:
        """Note a message that is none."""
        self._refuse("", f"{what}: {reason}", now)

    def _refuse(self, session: str, reason: str, now: int) -> Permission:
        self.refused += 1
        who = printable(session, SHOWN_NAME) or "unknown"
        self.last_refusal = f"{who}: {reason}"
        kind = re.sub(r"[-+.\d]+", "#", reason)
        self._throttled_log.warning(f"{who} {kind}", f"refused from {who}: {reason}", 1e-9 * now)
        return Permission(False, reason)
