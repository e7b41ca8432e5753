"""What is noted of a capture while it runs, and what the notes say about how it ended.

The notes are one record, `JUDGEMENT`, kept by compiled code at every tick. `outcome_of` reads them: once as
the paper's tables judge, at the first closed instant, and once after the arms have locked.
"""

from __future__ import annotations

import math

import numpy as np

from sim.capture.caging import Cage, tips_enclose
from sim.capture.tick import ARMS
from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.control.phases import Phase, Sequence, Verdict
from sim.control.trajectory import plan_end
from sim.model.clearance import corner_inside
from sim.model.generalized_jacobian import manipulability
from sim.model.planar import rotated
from sim.model.robot import Chain, RobotModel, arm_jacobian
from sim.record import Record
from sim.snapshot import Outcome, OutcomeClass, Touch

MAX_TOUCHES = 256


TOUCH = np.dtype(
    [("arm", np.int64), ("start", np.float64), ("last", np.float64), ("peak", np.float64), ("planned", np.int64)],
    align=True,
)

JUDGEMENT = np.dtype(
    [
        ("begun_at", np.float64),  # of the sequence being judged [s]; NaN if none is
        ("verdict", np.int64),
        ("verdict_at", np.float64),
        ("closed_at", np.float64),  # first closed instant of a slow target [s]; NaN before
        ("locked_at", np.float64),
        ("peak", np.float64),  # largest hand resultant [N]
        ("peak_to_closure", np.float64),
        ("unplanned", np.int64),
        ("unplanned_to_closure", np.int64),
        ("base_overlap", np.int64),  # now, geometrically or in solid contact
        ("min_manipulability", np.float64),
        ("manipulability", np.float64, (2,)),  # now
        ("initial_momentum", np.float64, (3,)),
        ("momentum_error", np.float64),
        ("open_touch", np.int64, (2,)),  # place in `touches` of each arm's present touch; -1 if none
        ("touch_count", np.int64),
        ("touches", TOUCH, (MAX_TOUCHES,)),
    ],
    align=True,
)


@compiled
def begin_judgement(notes: Record, time: float, momentum: FloatArray) -> None:
    """Forget all notes; a sequence begins now [s], with that total momentum, shape (3,)."""
    notes.begun_at = time
    notes.verdict = Verdict.NONE
    notes.verdict_at = notes.closed_at = notes.locked_at = math.nan
    notes.peak = notes.peak_to_closure = 0.0
    notes.unplanned = notes.unplanned_to_closure = notes.base_overlap = 0
    notes.min_manipulability = math.inf
    notes.initial_momentum[:] = momentum
    notes.momentum_error = 0.0
    notes.open_touch[:] = -1
    notes.touch_count = 0


@compiled
def judge(notes: Record, memory: Record, parameters: Record, robot: RobotModel, state: Record, links: Chain) -> None:
    """Note what this tick shows, before the controller acts on it; `memory.closed` is set for it."""
    memory.closed = tips_enclose(robot, links.hand_pose, state.target_pose, parameters.target.side)
    notes.base_overlap = overlaps_base(parameters, state)
    for arm in range(2):
        notes.manipulability[arm] = manipulability(arm_jacobian(links, arm))
    if math.isnan(notes.begun_at) or notes.verdict != Verdict.NONE:
        return
    _note_touches(notes, memory, parameters, state)
    notes.min_manipulability = min(notes.min_manipulability, notes.manipulability[0], notes.manipulability[1])
    error = 0.0
    for axis in range(3):
        error += abs(state.momentum[axis] - notes.initial_momentum[axis])
    notes.momentum_error = max(notes.momentum_error, error)
    if math.isnan(notes.closed_at):
        notes.peak_to_closure, notes.unplanned_to_closure = notes.peak, notes.unplanned
    _reach_verdict(notes, memory, parameters, state)


@compiled
def _reach_verdict(notes: Record, memory: Record, parameters: Record, state: Record) -> None:
    """Ejection over base collision over capture in the same tick, as the authors' simulator."""
    judging = parameters.judging
    distance = math.hypot(state.target_pose[0] - state.base_pose[0], state.target_pose[1] - state.base_pose[1])
    capturing = memory.sequence not in (Sequence.NONE, Sequence.DETUMBLE_ONLY)
    verdict = Verdict.NONE
    if distance >= judging.ejection_distance:
        verdict = Verdict.EJECTION
    elif notes.base_overlap:
        verdict = Verdict.BASE_COLLISION
    elif memory.phase in (Phase.DETUMBLING, Phase.CAGING) and capturing:
        if math.isnan(notes.closed_at) and memory.closed and _target_is_slow(parameters, state):
            notes.closed_at = state.time
        if state.time - notes.begun_at + 0.5 * parameters.control.period >= judging.time_limit:
            verdict = Verdict.TIME_LIMIT
    elif memory.phase == Phase.HOLDING and capturing:
        if math.isnan(notes.locked_at):
            notes.locked_at = state.time
        if state.time - notes.locked_at + 0.5 * parameters.control.period >= judging.hold_time:
            verdict = Verdict.LOCKED
    if verdict != Verdict.NONE:
        notes.verdict, notes.verdict_at = verdict, state.time


@compiled
def _target_is_slow(parameters: Record, state: Record) -> bool:
    """Whether spin and speed relative to the turning base are within the limits of a capture."""
    judging = parameters.judging
    spin = state.target_twist[2] - state.base_twist[2]
    x, y = state.target_pose[0] - state.base_pose[0], state.target_pose[1] - state.base_pose[1]
    vx = state.target_twist[0] - state.base_twist[0] + state.base_twist[2] * y
    vy = state.target_twist[1] - state.base_twist[1] - state.base_twist[2] * x
    return bool(abs(spin) <= judging.relative_spin_limit and math.hypot(vx, vy) <= judging.relative_speed_limit)


@compiled
def overlaps_base(parameters: Record, state: Record) -> bool:
    """Whether the target and the base's rectangle overlap by a corner, or touch as solids."""
    base, half_side = parameters.robot.base, 0.5 * parameters.target.side
    dx, dy = rotated(state.base_pose[2], 0.0, -base.centre_of_mass_ahead)
    rectangle = np.array([state.base_pose[0] + dx, state.base_pose[1] + dy, state.base_pose[2]])
    half_x, half_y = 0.5 * base.width, 0.5 * base.depth
    return bool(
        state.base_contact > 0
        or corner_inside(state.target_pose, half_side, half_side, rectangle, half_x, half_y)
        or corner_inside(rectangle, half_x, half_y, state.target_pose, half_side, half_side)
    )


@compiled
def _note_touches(notes: Record, memory: Record, parameters: Record, state: Record) -> None:
    """Peaks, and the list of touches: contacts of one arm with shorter gaps than `touch_gap` are one."""
    for arm in range(2):
        force = math.hypot(state.hand_wrench[arm, 0], state.hand_wrench[arm, 1])
        notes.peak = max(notes.peak, force)
        touching = state.tip_contact[arm, 0] or state.tip_contact[arm, 1]
        place = notes.open_touch[arm]
        if place >= 0 and not touching and state.time - notes.touches[place].last > parameters.judging.touch_gap:
            notes.open_touch[arm] = place = -1
        if not touching:
            continue
        plan_running = memory.plan_knots > 1 and state.time < plan_end(memory)
        notes.unplanned = notes.unplanned or plan_running
        if place < 0 and notes.touch_count < MAX_TOUCHES:
            place = notes.touch_count
            notes.touch_count += 1
            notes.open_touch[arm] = place
            touch = notes.touches[place]
            touch.arm, touch.start, touch.peak, touch.planned = arm, state.time, 0.0, not plan_running
        if place >= 0:
            notes.touches[place].last = state.time
            notes.touches[place].peak = max(notes.touches[place].peak, force)
    if state.arm_contact > 0:
        notes.unplanned = 1


def touches_of(notes: Record) -> list[Touch]:
    """The touches noted so far."""
    return [
        Touch(
            arm=ARMS[touch["arm"]],
            start=float(touch["start"]),
            end=None if place in notes["open_touch"] and notes["verdict"] == Verdict.NONE else float(touch["last"]),
            peak=float(touch["peak"]),
            planned=bool(touch["planned"]),
        )
        for place, touch in enumerate(notes["touches"][: notes["touch_count"]])
    ]


def outcome_of(notes: Record, config: MissionConfig, spin: float, cage: Cage) -> Outcome:
    """The outcome that the notes show at their verdict; `cage` is that of the hands and target now."""
    failure = {
        Verdict.EJECTION: OutcomeClass.EJECTION,
        Verdict.BASE_COLLISION: OutcomeClass.BASE_COLLISION,
    }.get(Verdict(int(notes["verdict"])), OutcomeClass.UNRESOLVED)
    closed_at, locked_at = _time(notes["closed_at"]), _time(notes["locked_at"])
    caged = locked_at is not None and notes["verdict"] == Verdict.LOCKED and cage.caged
    bound = config.judging.force_bound
    at_closure = failure
    if closed_at is not None:
        at_closure = _caged_class(bool(notes["unplanned_to_closure"]), float(notes["peak_to_closure"]), bound)
    at_lock = _caged_class(bool(notes["unplanned"]), float(notes["peak"]), bound) if caged else failure
    return Outcome(
        outcome=at_lock,
        at_first_closure=at_closure,
        at_locked_arms=at_lock,
        caged=caged,
        cage_margin=cage.margin if caged else None,
        peak_tip_force=float(notes["peak"]),
        peak_tip_force_to_closure=float(notes["peak_to_closure"]),
        closed_at=closed_at,
        locked_at=locked_at,
        duration=float(notes["verdict_at"] - notes["begun_at"]),
        contacts=touches_of(notes),
        final_target_spin=spin,
        min_manipulability=float(notes["min_manipulability"]),
        momentum_error=float(notes["momentum_error"]),
    )


def _time(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _caged_class(unplanned: bool, peak: float, bound: float) -> OutcomeClass:
    if unplanned:
        return OutcomeClass.CAGED_UNPLANNED_CONTACT
    return OutcomeClass.CAGED_FORCE_REDUCED if peak < bound else OutcomeClass.CAGED_FORCE_NOT_REDUCED
