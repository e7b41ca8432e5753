"""What is noted of a capture while it runs, from the truth, and what that says about how it ended.

The notes are one record, `MONITOR`, kept by compiled code at every tick. `outcome_of` reads it: once as the paper's
tables judge, at the first closed instant, and once after the arms have locked.
"""

from __future__ import annotations

import math

import numpy as np

from sim.capture.caging import Cage, tips_enclose
from sim.capture.tick import ARMS
from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import MissionConfig
from sim.control.phases import Phase, Sequence, Verdict
from sim.control.trajectory import plan_end
from sim.model.clearance import corners_overlap
from sim.model.generalized_jacobian import manipulability
from sim.model.robot import Chain, RobotModel
from sim.record import Record, copy_vector
from sim.snapshot import Outcome, OutcomeClass, Touch

MAX_TOUCHES = 256


TOUCH = np.dtype(
    [
        ("arm", np.int64),
        ("start", np.float64),
        ("last", np.float64),
        ("peak", np.float64),
        ("planned", np.int64),
        ("target_twist", np.float64, (3,)),  # at the last contact
    ],
    align=True,
)

MONITOR = np.dtype(
    [
        ("begun_at", np.float64),  # of the sequence being judged [s]; NaN if none is
        ("verdict", np.int64),
        ("verdict_at", np.float64),
        ("closed_at", np.float64),  # first closed instant of a slow target [s]; NaN before
        ("locked_at", np.float64),
        ("peak", np.float64),  # largest hand resultant [N]
        ("peak_at", np.float64),  # the first time that it was reached [s]
        ("peak_phase", np.int64),  # in that tick
        ("peak_activity", np.int64),  # likewise
        ("peak_to_closure", np.float64),
        ("unplanned", np.int64),
        ("unplanned_to_closure", np.int64),
        ("closed", np.int64),  # the tips enclose the target at its present angle
        ("base_overlap", np.int64),  # now, geometrically or in solid contact
        ("min_manipulability", np.float64),
        ("manipulability", np.float64, (2,)),  # now
        ("base_turn", np.float64),  # the base's angle where it was largest [rad]
        ("initial_momentum", np.float64, (3,)),
        ("momentum_error", np.float64),
        ("open_touch", np.int64, (2,)),  # place in `touches` of each arm's present touch; -1 if none
        ("touch_count", np.int64),
        ("touches", TOUCH, (MAX_TOUCHES,)),
    ],
    align=True,
)


@compiled
def begin_monitoring(monitor: Record, time: float, momentum: FloatArray) -> None:
    """Clear the monitor; a sequence begins now [s], with that total momentum, shape (3,)."""
    monitor.begun_at = time
    monitor.verdict = Verdict.NONE
    monitor.verdict_at = monitor.closed_at = monitor.locked_at = math.nan
    monitor.peak = monitor.peak_to_closure = monitor.base_turn = 0.0
    monitor.peak_at = math.nan
    monitor.unplanned = monitor.unplanned_to_closure = monitor.base_overlap = 0
    monitor.min_manipulability = math.inf
    monitor.initial_momentum[:] = momentum
    monitor.momentum_error = 0.0
    monitor.open_touch[:] = -1
    monitor.touch_count = 0


@compiled_inline
def watch(
    monitor: Record,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    shapes: Record,
    state: Record,
    links: Chain,
) -> None:
    """Note what this tick shows, before the controller acts on it."""
    monitor.closed = tips_enclose(robot, shapes.target, links.hand_pose, state.target_pose)
    monitor.base_overlap = overlaps_base(shapes, state)
    for arm in range(2):
        monitor.manipulability[arm] = manipulability(links, arm)
    if math.isnan(monitor.begun_at) or monitor.verdict != Verdict.NONE:
        return
    _watch_touches(monitor, memory, parameters, state)
    monitor.min_manipulability = min(monitor.min_manipulability, monitor.manipulability[0], monitor.manipulability[1])
    if abs(state.base_pose[2]) > abs(monitor.base_turn):
        monitor.base_turn = state.base_pose[2]
    error = 0.0
    for axis in range(3):
        error += abs(state.momentum[axis] - monitor.initial_momentum[axis])
    monitor.momentum_error = max(monitor.momentum_error, error)
    if math.isnan(monitor.closed_at):
        monitor.peak_to_closure, monitor.unplanned_to_closure = monitor.peak, monitor.unplanned
    _reach_verdict(monitor, memory, parameters, state)


@compiled_inline
def note_decision(monitor: Record, memory: Record, state: Record) -> None:
    """Note what this tick decided, after `watch`."""
    if monitor.peak_at == state.time:
        monitor.peak_phase, monitor.peak_activity = memory.phase, memory.activity


@compiled_inline
def _reach_verdict(monitor: Record, memory: Record, parameters: Record, state: Record) -> None:
    """Ejection over base collision over capture in the same tick, as the authors' simulator."""
    judging = parameters.judging
    x, y = state.target_pose[0] - state.base_pose[0], state.target_pose[1] - state.base_pose[1]
    capturing = memory.sequence not in (Sequence.NONE, Sequence.DETUMBLE_ONLY)
    verdict = Verdict.NONE
    if abs(x) + abs(y) >= judging.ejection_distance and math.hypot(x, y) >= judging.ejection_distance:
        verdict = Verdict.EJECTION
    elif monitor.base_overlap:
        verdict = Verdict.BASE_COLLISION
    elif memory.phase in (Phase.DETUMBLING, Phase.CAGING) and capturing:
        if math.isnan(monitor.closed_at) and monitor.closed and _target_is_slow(parameters, state):
            monitor.closed_at = state.time
        if state.time - monitor.begun_at + 0.5 * parameters.control.period >= judging.time_limit:
            verdict = Verdict.TIME_LIMIT
    elif memory.phase == Phase.HOLDING and capturing:
        if math.isnan(monitor.locked_at):
            monitor.locked_at = state.time
        if state.time - monitor.locked_at + 0.5 * parameters.control.period >= judging.hold_time:
            verdict = Verdict.LOCKED
    if verdict != Verdict.NONE:
        monitor.verdict, monitor.verdict_at = verdict, state.time


@compiled
def _target_is_slow(parameters: Record, state: Record) -> bool:
    """Whether spin and speed relative to the turning base are within the limits of a capture."""
    judging = parameters.judging
    spin = state.target_twist[2] - state.base_twist[2]
    x, y = state.target_pose[0] - state.base_pose[0], state.target_pose[1] - state.base_pose[1]
    vx = state.target_twist[0] - state.base_twist[0] + state.base_twist[2] * y
    vy = state.target_twist[1] - state.base_twist[1] - state.base_twist[2] * x
    return bool(abs(spin) <= judging.relative_spin_limit and math.hypot(vx, vy) <= judging.relative_speed_limit)


@compiled_inline
def overlaps_base(shapes: Record, state: Record) -> bool:
    """Whether the target and the base overlap by a corner, or touch as solids."""
    return bool(
        state.base_contact > 0 or corners_overlap(shapes.target, state.target_pose, shapes.base, state.base_pose)
    )


@compiled_inline
def _watch_touches(monitor: Record, memory: Record, parameters: Record, state: Record) -> None:
    """Peaks, and the list of touches: contacts of one arm with shorter gaps than `touch_gap` are one."""
    for arm in range(2):
        wrench = state.hand_wrench
        force = math.hypot(wrench[arm, 0], wrench[arm, 1]) if wrench[arm, 0] != 0.0 or wrench[arm, 1] != 0.0 else 0.0
        if force > monitor.peak:
            monitor.peak, monitor.peak_at = force, state.time
        touching = state.tip_contact[arm, 0] or state.tip_contact[arm, 1]
        place = monitor.open_touch[arm]
        if place >= 0 and not touching and state.time - monitor.touches[place].last > parameters.judging.touch_gap:
            monitor.open_touch[arm] = place = -1
        if not touching:
            continue
        plan_running = memory.plan_knots > 1 and state.time < plan_end(memory) and not memory.expects_contact[arm]
        monitor.unplanned = monitor.unplanned or plan_running
        if place < 0 and monitor.touch_count < MAX_TOUCHES:
            place = monitor.touch_count
            monitor.touch_count += 1
            monitor.open_touch[arm] = place
            touch = monitor.touches[place]
            touch.arm, touch.start, touch.peak, touch.planned = arm, state.time, 0.0, not plan_running
        if place >= 0:
            monitor.touches[place].last = state.time
            monitor.touches[place].peak = max(monitor.touches[place].peak, force)
            copy_vector(monitor.touches[place].target_twist, state.target_twist)
    if state.arm_contact > 0:
        monitor.unplanned = 1


def touches_of(monitor: Record) -> list[Touch]:
    """The touches noted so far."""
    return [
        Touch(
            arm=ARMS[touch["arm"]],
            start=float(touch["start"]),
            end=None if place in monitor["open_touch"] and monitor["verdict"] == Verdict.NONE else float(touch["last"]),
            peak=float(touch["peak"]),
            planned=bool(touch["planned"]),
        )
        for place, touch in enumerate(monitor["touches"][: monitor["touch_count"]])
    ]


def outcome_of(monitor: Record, config: MissionConfig, spin: float, cage: Cage) -> Outcome:
    """The outcome that the monitor shows at its verdict; `cage` is that of the hands and target now."""
    failure = {
        Verdict.EJECTION: OutcomeClass.EJECTION,
        Verdict.BASE_COLLISION: OutcomeClass.BASE_COLLISION,
    }.get(Verdict(int(monitor["verdict"])), OutcomeClass.UNRESOLVED)
    closed_at, locked_at = _time(monitor["closed_at"]), _time(monitor["locked_at"])
    caged = locked_at is not None and monitor["verdict"] == Verdict.LOCKED and cage.caged
    bound = config.judging.force_bound
    at_closure = failure
    if closed_at is not None:
        at_closure = _caged_class(bool(monitor["unplanned_to_closure"]), float(monitor["peak_to_closure"]), bound)
    at_lock = _caged_class(bool(monitor["unplanned"]), float(monitor["peak"]), bound) if caged else failure
    return Outcome(
        outcome=at_lock,
        at_first_closure=at_closure,
        at_locked_arms=at_lock,
        caged=caged,
        cage_margin=cage.margin if caged else None,
        peak_tip_force=float(monitor["peak"]),
        peak_tip_force_to_closure=float(monitor["peak_to_closure"]),
        closed_at=closed_at,
        locked_at=locked_at,
        duration=float(monitor["verdict_at"] - monitor["begun_at"]),
        contacts=touches_of(monitor),
        final_target_spin=spin,
        min_manipulability=float(monitor["min_manipulability"]),
        momentum_error=float(monitor["momentum_error"]),
    )


def _time(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _caged_class(unplanned: bool, peak: float, bound: float) -> OutcomeClass:
    if unplanned:
        return OutcomeClass.CAGED_UNPLANNED_CONTACT
    return OutcomeClass.CAGED_FORCE_REDUCED if peak < bound else OutcomeClass.CAGED_FORCE_NOT_REDUCED
