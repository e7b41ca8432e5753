"""The robot at the other end of the link as a `Plant`: one mission's session on it.

Each tick waits for the next joint state and sends the joint rates that answer it at once. Whatever makes the robot
unfit to be flown raises `LinkLost`, after a STOP to it; the session is not taken up again. A new mission, which an
operator asks for, opens a new one, so nothing that was sent for this one is executed later.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import NoReturn

import numpy as np

from server.link.contract import CONTROL_RATE, JOINT_NAMES, RobotMode
from server.link.robot_link import SETTLING_TIME, RobotLink
from server.link.trouble import Trouble
from server.link.wire import JointSample
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.errors import Cause, ConfigError, LinkLost, MissionRefused
from sim.perception.perceived import PERCEIVED
from sim.plant.plant import PLANT_STATE
from sim.record import Record

LAG_LIMIT = 0.08
"""How far a joint may fall behind its commanded motion [rad]."""
JUMP = 0.05
"""Farther than this beyond its commanded motion, a joint has jumped [rad]."""
RATES_UNDER_WAY = 4
"""Commanded joint rates of which any may be in force: a joint follows if it moves between the least and the most."""
BEGIN_TIME = 10.0
"""How long the robot is held for a mission that has not begun to fly it [s]."""
LAG_TIME = 0.6
"""How long falling behind is remembered [s]."""


def require_robot_config(config: MissionConfig) -> None:
    """Refuse what no robot can be flown with: another control period than the link's.

    Its sensors are its own: what a configuration says of simulated ones is for rehearsals of its missions.

    Raises:
        ConfigError: the message names parameter, value and what would be right.

    """
    period = 1.0 / CONTROL_RATE
    if not math.isclose(config.control.period, period, rel_tol=1e-9):
        raise ConfigError(
            f"control.period = {config.control.period:g} s: the robot's joint states come every {period:g} s",
            tip=f"the configuration testbed has it, or set control.period={period:g}",
        )


class ZenohPlant:
    """One mission's robot. Owned by the mission thread."""

    handle = None

    def __init__(self, link: RobotLink, config: MissionConfig) -> None:
        """Take the robot, tare its wrists if nobody has since its start, and see where it is.

        Raises:
            ConfigError: the control period is not the link's.
            MissionRefused: the robot cannot be flown now; the message says why.
            LinkLost: it did not answer.

        """
        require_robot_config(config)
        self._link = link
        self._state: Record = np.zeros(1, PLANT_STATE)[0]
        self._state["tick"] = -1
        self._perceived: Record = np.zeros(1, PERCEIVED)[0]
        self._lag = np.zeros((2, 3))
        self._recent_rates: deque[FloatArray] = deque(maxlen=RATES_UNDER_WAY)
        self._stopped = False
        link.open_session(config)
        self._first: int | None = None
        self._last = 0
        self._angle = np.zeros((2, 3))
        self._hold_still(self._is_seen, "it granted a session")
        if self._tare_if_needed():
            link.reset_perception()
            self._hold_still(lambda: link.perceives, "its wrists were tared")
        link.write_state(self._state, self._perceived)
        self._lost: LinkLost | None = None
        self._begun = threading.Event()
        self._holder = threading.Thread(target=self._hold_until_begun, name="becalm-holder", daemon=True)
        self._holder.start()

    def configure(self, config: MissionConfig) -> None:
        """Perceive by that configuration from now on; that a robot can be flown with it is for the asker to see."""
        self._link.configure(config)

    def _is_seen(self) -> bool:
        """Whether the robot has reported this session, and both bodies are perceived by its configuration."""
        return self._link.reports.of_session is not None and self._link.perceives

    @property
    def state(self) -> Record:
        """As perceived at the joint state last observed."""
        return self._state

    @property
    def perceived(self) -> Record:
        """What the controller gets of it."""
        return self._perceived

    @property
    def copyable(self) -> None:
        """A robot does not return to where it stood."""

    @property
    def next_tick(self) -> int:
        """The tick after the last one, which has been observed and answered already."""
        return int(self._state["tick"]) + 1

    def observe(self) -> None:
        """Wait for the next joint state and perceive the rest.

        Raises:
            LinkLost: it does not come, or reports an impossible state; the robot has been sent a STOP.

        """
        link = self._link
        if not self._begun.is_set():
            self._begun.set()
            self._holder.join()
        if link.await_joints(self._last, link.settings.deadline) is None:
            self._give_up(self._silence())
        if self._first is None:
            self._first = link.count_from_now()
        joints = link.write_state(self._state, self._perceived)
        trouble = self._trouble(joints)
        if trouble is not None:
            self._give_up(trouble)
        self._state["tick"] += 1
        self._state["time"] = 1e-9 * (joints.stamp - self._first)
        self._perceived["tick"], self._perceived["time"] = self._state["tick"], self._state["time"]
        self._last, self._angle = joints.stamp, joints.angle

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """Send joint rates [rad/s], shape (2, 3), that answer the state last observed."""
        if self._stopped:
            self._link.heartbeat()
            return
        self._link.send_joint_rates(self._last, joint_rate)
        self._recent_rates.append(joint_rate.copy())

    def stop(self) -> None:
        """Send joint rates no more in this session, but heartbeats."""
        self._stopped = True

    def require_held(self, span: float) -> None:
        """Hold the robot still for that long [s] before its mission begins.

        Raises:
            LinkLost: it was lost meanwhile.

        """
        self._holder.join(span)
        if not self._holder.is_alive():
            lost = self._lost
            cause = lost.cause if lost else Cause.NO_ANSWER
            raise LinkLost(f"the robot was lost within {span:g} s: {lost}", cause=cause, tip="it is tried again")

    @property
    def _stopping(self) -> bool:
        """Whether a STOP was asked for here: it is sent to the robot at once, before this mission hears of it."""
        return self._stopped or self._link.stop_sent is not None

    def _give_up(self, trouble: Trouble) -> NoReturn:
        """Send a STOP, and fly on no more.

        Raises:
            LinkLost: for that reason.

        """
        self._link.stop()
        raise LinkLost(trouble.message, cause=trouble.cause, tip="fix the robot or its network, then reset")

    def _silence(self) -> Trouble:
        """Why no joint state came."""
        age = self._link.age() or 0.0
        return self._link.trouble() or Trouble(Cause.ROBOT_SILENT, f"no joint states for {1e3 * age:.0f} ms")

    def _trouble(self, joints: JointSample) -> Trouble | None:
        """Why the robot cannot be flown on."""
        link, deadline = self._link, self._link.settings.deadline
        stale = link.staleness(joints.stamp)
        if stale > deadline:
            return Trouble(Cause.STREAM_LATE, f"joint states late: what arrives is {1e3 * stale:.0f} ms old")
        if joints.stamp - self._last > deadline * 1e9:
            words = f"joint states jumped by {1e-6 * (joints.stamp - self._last):.0f} ms"
            return Trouble(Cause.READING_JUMPED, words)
        return self._jumped(joints) or link.trouble() or self._lost_session() or self._lagging(joints)

    def _jumped(self, joints: JointSample) -> Trouble | None:
        """Whether a joint is where it cannot have come to since the last state."""
        moved = np.abs(joints.angle - self._angle)
        worst = int(moved.argmax())
        fastest = max((float(np.abs(rate).max()) for rate in self._recent_rates), default=0.0)
        reach = JUMP + 1e-9 * (joints.stamp - self._last) * fastest
        if moved.flat[worst] <= reach:
            return None
        return Trouble(Cause.READING_JUMPED, f"{JOINT_NAMES[worst]} jumped by {moved.flat[worst]:.3f} rad")

    def _lost_session(self) -> Trouble | None:
        """Whether the robot follows this session no more, though nobody stopped it here."""
        report = self._link.reports.of_session
        if report is None or self._stopping:
            return None
        holder, why = report.values.get("session", ""), report.values.get("why", "")
        if holder != self._link.session:
            words = f"the robot has let this session go; it is held by {holder or 'nobody'}"
            return Trouble(Cause.SESSION_TAKEN, words)
        if report.message == RobotMode.FOLLOWING:
            return None
        return Trouble(Cause.ROBOT_STOPPED, f"the robot is {report.message}: {why}")

    def _lagging(self, joints: JointSample) -> Trouble | None:
        """Whether a joint does not follow its commanded rate."""
        if self._stopping or not self._recent_rates:
            return None
        dt = 1e-9 * (joints.stamp - self._last)
        moved, commanded = joints.angle - self._angle, dt * np.array(self._recent_rates)
        self._lag = (
            self._lag * math.exp(-dt / LAG_TIME) + np.clip(moved, commanded.min(axis=0), commanded.max(axis=0)) - moved
        )
        worst = int(np.abs(self._lag).argmax())
        behind = abs(float(self._lag.flat[worst]))
        if behind <= LAG_LIMIT:
            return None
        return Trouble(Cause.JOINT_BLOCKED, f"{JOINT_NAMES[worst]} does not follow: {behind:.3f} rad behind")

    def _hold_until_begun(self) -> None:
        """Answer the robot while the mission that flies it is made, and its log; what is wrong shows when it begins."""
        try:
            self._hold_still(self._begun.is_set, "its session was opened", BEGIN_TIME)
        except LinkLost as error:
            self._lost = error

    def _hold_still(self, enough: Callable[[], bool], since: str, patience: float = SETTLING_TIME) -> JointSample:
        """Hold the arms still until that is so; the joint state then."""
        link = self._link
        until = time.monotonic() + patience
        while True:
            joints = link.await_joints(self._last, link.settings.deadline)
            trouble = link.trouble()
            if joints is None or trouble is not None or time.monotonic() > until:
                why = f": {trouble.message}" if trouble is not None else ""
                cause = trouble.cause if trouble is not None else Cause.NO_ANSWER
                raise LinkLost(f"the robot was lost after {since}{why}", cause=cause, tip="reset to try again")
            self._last, self._angle = joints.stamp, joints.angle
            link.send_joint_rates(joints.stamp, np.zeros((2, 3)))
            if enough():
                return joints

    def _tare_if_needed(self) -> bool:
        """Tare wrists that have not been since the robot was started; whether that was needed."""
        if self._link.reports.value("tared") == "true":
            return False
        answer = self._link.tare()
        if not answer.granted:
            raise MissionRefused(f"the wrist sensors cannot be tared: {answer.reason}", tip="reset to try again")
        return True
