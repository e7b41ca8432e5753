"""What follows from time, measurement and trouble: the phase, the activity and the kind of plan to make now."""

from __future__ import annotations

import math

from sim.compiled import compiled
from sim.control.memory import NEVER
from sim.control.phases import Phase, Sequence
from sim.control.trajectory import end_plan, plan_end
from sim.method.co_moving_couple.memory import Activity, CoupleHandle, Dropped, PlanKind, Trouble
from sim.method.co_moving_couple.planner import CLOSINGS, COARSE, MOST_PASSES, REFINED, time_to_contact
from sim.method.co_moving_couple.reference import DRAWING_BACK, LIFTING, entry_time
from sim.record import Record

_MISSED_AFTER = 0.5
"""A hand that has not met its side by then has missed it [s]."""
_CLOSING_LIMIT = 3.0
"""A closing that takes longer has failed [s]."""
_OVERTIME = 0.2
"""How far past its planned end a touch may go on that has not braked enough [rad]."""
_BEFORE_DAMPING = 1.3
"""Times the manipulability at which damping of the joint rates starts, a touch ends."""
_UNSEEN_LIMIT = 0.2
"""Longest time without a sight of the target [s]."""
_FAR_OVER = 1.5
"""Times the cap: a force that no control error explains."""
_PATIENCE = 1.0
"""How long a squeeze may take to bring both hands in [s]."""


@compiled
def into(own: Record, state: Record, phase: int, activity: int) -> tuple[int, int, int]:
    """Begin an activity now, from where the hands are."""
    own.since, own.start_kept, own.manipulability = state.time, 0, math.inf
    begin_search(own)
    if activity == Activity.TOUCHING:
        own.first_touch, own.both_touch = NEVER, 0
        own.force_error[:] = 0.0
        own.touches += 1
        own.trouble, own.failures, own.waiting_since = Trouble.NONE, 0, NEVER
    return phase, activity, PlanKind.NONE


@compiled
def fail(own: Record, search: Record, state: Record, phase: int, trouble: int, following: int) -> tuple[int, int, int]:
    """Note the trouble, and begin what follows from it, unless that was tried too often in a row: then hold."""
    own.trouble = trouble
    own.failures += 1
    if own.failures >= search.most_failures:
        return Phase.HOLDING, Activity.NONE, PlanKind.NONE
    return into(own, state, phase, following)


@compiled
def wait(own: Record, search: Record, state: Record, phase: int, following: int) -> tuple[int, int, int]:
    """Note that there is no plan, and look again from what follows, unless there has been none for too long: then hold.

    A target that turns slowly takes long to bring the next corner or side; how many searches that is says nothing.
    """
    own.trouble = Trouble.NO_PLAN
    if own.waiting_since == NEVER:
        own.waiting_since = state.time
    if state.time - own.waiting_since >= search.patience:
        return Phase.HOLDING, Activity.NONE, PlanKind.NONE
    return into(own, state, phase, following)


@compiled
def search(handle: CoupleHandle, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Watch, then roll candidates out, one a tick; then begin what the best of them says.

    A round target is braked by friction in the closing: no touch comes before.
    """
    own, method, phase = handle.own[0], parameters.co_moving_couple, memory.phase
    slow = abs(state.target_twist[2]) <= method.touch.no_touch_spin or handle.fixed[0].shape.sides == 0
    if state.time - state.target_seen_at > _UNSEEN_LIMIT:
        return into(own, state, phase, Activity.ESTIMATING)
    if state.time - own.since < method.search.estimating_time:
        return phase, Activity.ESTIMATING, PlanKind.NONE
    own.sense = 1.0 if state.target_twist[2] >= 0.0 else -1.0
    if phase == Phase.DETUMBLING and slow:
        over = memory.sequence == Sequence.DETUMBLE_ONLY
        return Phase.HOLDING if over else Phase.CAGING, Activity.NONE, PlanKind.NONE
    return _roll_on(own, method, state, phase)


@compiled
def _roll_on(own: Record, method: Record, state: Record, phase: int) -> tuple[int, int, int]:
    """The next candidate, or what the best of them says."""
    if phase == Phase.CAGING:
        if own.candidate < CLOSINGS:
            return phase, Activity.ESTIMATING, PlanKind.ROLL_OUT_CLOSING
        return _begin_found(own, method, state, phase, Activity.REGRASPING, PlanKind.CAGE)
    if own.candidate >= COARSE and own.found.cost == math.inf and own.passing + 1 < MOST_PASSES:
        own.candidate = 0
        own.passing += 1
    if own.candidate < COARSE or (own.candidate < COARSE + REFINED and own.found.cost < math.inf):
        return phase, Activity.ESTIMATING, PlanKind.ROLL_OUT_TOUCH
    return _begin_found(own, method, state, phase, Activity.APPROACHING, PlanKind.TOUCH)


@compiled
def begin_search(own: Record) -> None:
    """Nothing is rolled out yet; the touch that is under way stays known."""
    own.candidate = own.passing = 0
    own.dropped[:] = 0
    own.found.cost = math.inf


@compiled
def _begin_found(
    own: Record, method: Record, state: Record, phase: int, activity: int, kind: int
) -> tuple[int, int, int]:
    """Begin what the search has found, or look again, or give up."""
    own.since, own.start_kept = state.time, 0
    if own.found.cost < math.inf:
        if activity == Activity.REGRASPING:
            own.close = own.found
        else:
            own.best = own.found
        return phase, activity, kind
    on_the_sides = phase == Phase.CAGING and own.trouble == Trouble.NONE and own.touches > 0
    following = Activity.RECOVERING if on_the_sides else Activity.ESTIMATING
    return wait(own, method.search, state, phase, following)


@compiled
def trouble_now(own: Record, memory: Record, parameters: Record, state: Record) -> int:
    """What is wrong now, a code of `Trouble`."""
    method, activity, lasted = parameters.co_moving_couple, memory.activity, state.time - own.since
    trouble = Trouble.NONE
    if activity == Activity.RECOVERING:
        return trouble
    gripping = activity in (Activity.SQUEEZING, Activity.SETTLING)  # to lock is then safer than to back out
    if state.time - state.target_seen_at > _UNSEEN_LIMIT:
        trouble = Trouble.SENSOR_LOST
    elif own.manipulability < method.search.manipulability_floor and not gripping:
        trouble = Trouble.OUT_OF_REACH
    elif activity == Activity.TOUCHING and not own.both_touch and lasted > _MISSED_AFTER:
        trouble = Trouble.HAND_MISSED
    elif activity == Activity.TOUCHING and _largest_force(state) > _FAR_OVER * method.touch.force_cap:
        trouble = Trouble.FORCE_OVER_CAP
    elif activity == Activity.CLOSING and lasted > _CLOSING_LIMIT:
        trouble = Trouble.NOT_ENCLOSED
    return trouble


@compiled
def _largest_force(state: Record) -> float:
    """Of both hands, as felt [N]."""
    left = math.hypot(state.hand_wrench[0, 0], state.hand_wrench[0, 1])
    return max(left, math.hypot(state.hand_wrench[1, 0], state.hand_wrench[1, 1]))


@compiled
def detumble(own: Record, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Approach, enter, touch, draw back, and again."""
    activity, phase = memory.activity, Phase.DETUMBLING
    left = time_to_contact(own.best, state)
    if activity == Activity.APPROACHING and own.best.dropped_for != Dropped.NONE:
        search = parameters.co_moving_couple.search
        return wait(own, search, state, phase, Activity.ESTIMATING)
    if activity == Activity.APPROACHING and left <= entry_time(state.target_twist[2]):
        return into(own, state, phase, Activity.ENTERING)
    if activity == Activity.ENTERING and (left <= 0.0 or state.touching[0] or state.touching[1]):
        return into(own, state, phase, Activity.TOUCHING)
    if activity == Activity.TOUCHING and _is_over(own, parameters, state):
        slow = abs(state.target_twist[2]) <= parameters.co_moving_couple.touch.no_touch_spin
        closing = slow and memory.sequence != Sequence.DETUMBLE_ONLY
        return into(own, state, Phase.CAGING if closing else phase, Activity.RETREATING)
    if activity == Activity.RETREATING:
        return _retreat(own, memory, parameters, state)
    return _go_on_or_recover(own, memory, state)


@compiled
def _retreat(own: Record, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Draw back from a touch that no closing follows: to the next one, or to rest."""
    method, lasted = parameters.co_moving_couple, state.time - own.since + 0.5 * parameters.control.period
    if lasted < method.closing.retreat_time:
        return Phase.DETUMBLING, Activity.RETREATING, PlanKind.NONE
    if abs(state.target_twist[2]) <= method.touch.no_touch_spin:
        if memory.sequence == Sequence.DETUMBLE_ONLY:
            return Phase.HOLDING, Activity.NONE, PlanKind.NONE
        return into(own, state, Phase.CAGING, Activity.ESTIMATING)
    if own.touches >= method.touch.most_touches:
        own.trouble = Trouble.TOO_MANY_TOUCHES
        return Phase.HOLDING, Activity.NONE, PlanKind.NONE
    return into(own, state, Phase.DETUMBLING, Activity.ESTIMATING)


@compiled
def _go_on_or_recover(own: Record, memory: Record, state: Record) -> tuple[int, int, int]:
    """Stay in what is done; after a recovery look for another plan."""
    if memory.activity == Activity.RECOVERING and state.time - own.since >= DRAWING_BACK:
        return into(own, state, memory.phase, Activity.ESTIMATING)
    return memory.phase, memory.activity, PlanKind.NONE


@compiled
def _is_over(own: Record, parameters: Record, state: Record) -> bool:
    """Whether a touch is over: the spin is braked, the arc long used up, or an arm soon too near a singularity.

    There joint rates are damped, so that a hand falls behind its face, which strikes it.
    """
    past = own.sense * (state.target_pose[2] + own.best.normal_offset - own.best.end_angle)
    braked = own.sense * state.target_twist[2] <= parameters.co_moving_couple.touch.spin_left
    stretched = own.manipulability < _BEFORE_DAMPING * parameters.control.rates.manipulability_warning
    return bool(braked or stretched or past >= _OVERTIME)


@compiled
def cage(handle: CoupleHandle, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Lift off and look how to close, go to the corners, come in, squeeze, settle."""
    own, closing, activity = handle.own[0], parameters.co_moving_couple.closing, memory.activity
    lasted = state.time - own.since + 0.5 * parameters.control.period
    if activity == Activity.RETREATING:
        return _lift_off(own, parameters.co_moving_couple, state, lasted)
    if activity == Activity.REGRASPING and lasted >= own.close.regrasp:
        return into(own, state, Phase.CAGING, Activity.CLOSING)
    if activity == Activity.CLOSING and state.touching[0] and state.touching[1]:
        return into(own, state, Phase.CAGING, Activity.SQUEEZING)
    if activity == Activity.SQUEEZING and lasted >= closing.squeeze_time:
        return _squeezed(handle, parameters, state, lasted)
    out_of_reach = own.manipulability < parameters.co_moving_couple.search.manipulability_floor
    if activity == Activity.SETTLING and (lasted >= closing.settling_time or out_of_reach):
        end_plan(memory, state.time)
        return Phase.HOLDING, Activity.NONE, PlanKind.NONE
    return _go_on_or_recover(own, memory, state)


@compiled
def _lift_off(own: Record, method: Record, state: Record, lasted: float) -> tuple[int, int, int]:
    """Lift off the sides while ways to close are rolled out."""
    if own.candidate < CLOSINGS or lasted < LIFTING:
        kind = PlanKind.ROLL_OUT_CLOSING if own.candidate < CLOSINGS else PlanKind.NONE
        return Phase.CAGING, Activity.RETREATING, kind
    return _begin_found(own, method, state, Phase.CAGING, Activity.REGRASPING, PlanKind.CAGE)


@compiled
def _squeezed(handle: CoupleHandle, parameters: Record, state: Record, lasted: float) -> tuple[int, int, int]:
    """Settle if both hands are far enough in for a cage, by perceived poses; open again if they do not come in."""
    own, fixed, method = handle.own[0], handle.fixed[0], parameters.co_moving_couple
    enclosed = max(own.radius[0], own.radius[1]) <= fixed.cage_radius
    braked = fixed.shape.sides > 0 or own.sense * state.target_twist[2] <= method.touch.spin_left
    if enclosed and braked:
        return into(own, state, Phase.CAGING, Activity.SETTLING)
    if lasted < (method.search.patience if enclosed else _PATIENCE):
        return Phase.CAGING, Activity.SQUEEZING, PlanKind.NONE
    search = parameters.co_moving_couple.search
    return fail(own, search, state, Phase.CAGING, Trouble.NOT_ENCLOSED, Activity.RECOVERING)


@compiled
def release(own: Record, memory: Record, state: Record) -> tuple[int, int, int]:
    """Open once, then rest."""
    if memory.plan_kind != PlanKind.RELEASE:
        own.since, own.start_kept = state.time, 1
        return Phase.RELEASED, Activity.OPENING, PlanKind.RELEASE
    opening = state.time < plan_end(memory)
    return Phase.RELEASED, Activity.OPENING if opening else Activity.NONE, PlanKind.NONE
