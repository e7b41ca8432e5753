"""The words beside the numbers: what is happening, and whether the next phase may begin."""

from __future__ import annotations

from collections.abc import Sequence as Ordered
from typing import Any

from sim.capture.events import verdict_in_words
from sim.capture.snapshot import Condition, Outcome, Plan, Readiness, Touch
from sim.config import MissionConfig
from sim.control.phases import Activity, Phase


def description(row: Any, phase: Phase, plan: Plan | None, touches: Ordered[Touch], outcome: Outcome | None) -> str:
    """One sentence on what is happening at a tick, one element of `TICK`, in that phase."""
    activity = Activity(int(row["activity"]))
    if outcome is not None and phase in (Phase.HOLDING, Phase.STOPPED):
        return verdict_in_words(outcome) + "."
    spin = float(row["target_twist"][2])
    if phase is Phase.DETUMBLING or phase is Phase.CAGING:
        return _motion(activity, float(row["time"]), plan, touches, spin)
    return {
        Phase.IDLE: f"The target spins at {spin:.2f} rad/s; the robot waits for a command.",
        Phase.HOLDING: "The arms hold; joint rates are zero.",
        Phase.RELEASED: "Both hands draw back."
        if activity is Activity.OPENING
        else "The hands are open; the arms hold.",
        Phase.STOPPED: "Stopped. Joint rates are zero; a reset begins anew.",
        Phase.FAULTED: "The plant can no longer be trusted; joint rates are zero.",
    }[phase]


def _motion(activity: Activity, time: float, plan: Plan | None, touches: Ordered[Touch], spin: float) -> str:
    hand = "right" if plan and plan.right and not plan.left else "left"
    remaining = max(0.0, plan.times[-1] - time) if plan else 0.0
    touching = next((touch for touch in reversed(touches) if touch.end is None), None)
    return {
        Activity.APPROACHING: f"The {hand} hand goes to meet the target; in place in {remaining:.1f} s.",
        Activity.WAITING: f"The {hand} hand waits; the target's face comes to it."
        if plan and plan.kind == "touch"
        else "The closing is done, but the tips do not enclose the target.",
        Activity.ABSORBING: f"The {touching.arm if touching else hand} hand yields and absorbs; spin {spin:.2f} rad/s.",
        Activity.RETREATING: "Joints are held while the target leaves the hand.",
        Activity.SETTLING: f"Spin {spin:.2f} rad/s is under its threshold; the closing is planned in a moment.",
        Activity.CLOSING: f"Both hands close around the target; done in {remaining:.1f} s.",
    }.get(activity, "The sequence begins.")


def readiness(row: Any, config: MissionConfig, phase: Phase, outcome: Outcome | None) -> Readiness:
    """Go or no-go for what comes next at a tick, one element of `TICK`, in that phase."""
    activity = Activity(int(row["activity"]))
    spin = _spin_condition(float(row["target_twist"][2]), config.control.caging.spin_threshold)
    if phase in (Phase.STOPPED, Phase.FAULTED):
        why = "the mission was stopped" if phase is Phase.STOPPED else "the mission has a fault"
        return _verdict("reset", f"{why}; only a reset goes on", [])
    if outcome is not None and not outcome.caged:
        return _verdict("reset", f"the capture has ended: {_first_lower(verdict_in_words(outcome))}", [])
    if phase is Phase.IDLE:
        fast = spin.model_copy(update={"met": True, "words": f"{spin.words}: the touches come first"})
        return _verdict("caging", None, [spin]) if spin.met else _verdict("detumbling", None, [fast])
    if phase is Phase.DETUMBLING:
        absorbed = activity is not Activity.ABSORBING
        told = "no touch is being absorbed" if absorbed else "the hand is still absorbing the touch"
        return _verdict("caging", None, [spin, _condition("absorbed", told, met=absorbed)])
    if phase is Phase.CAGING:
        return _verdict("holding", None, _closing_conditions(bool(row["closed"]), activity))
    return _readiness_at_rest(phase, activity, outcome)


def _spin_condition(spin: float, threshold: float) -> Condition:
    slow = abs(spin) < threshold
    words = f"spin {abs(spin):.2f} rad/s is {'under' if slow else 'over'} the threshold of {threshold:g} rad/s"
    return Condition(name="spin", met=slow, value=abs(spin), bound=threshold, unit="rad/s", words=words)


def _closing_conditions(closed: bool, activity: Activity) -> list[Condition]:
    done = activity is not Activity.CLOSING
    enclosed = "the tips enclose the target" if closed else "the tips do not enclose the target yet"
    moved = "the closing motion is done" if done else "the closing motion is under way"
    return [_condition("enclosed", enclosed, met=closed), _condition("closing_done", moved, met=done)]


def _readiness_at_rest(phase: Phase, activity: Activity, outcome: Outcome | None) -> Readiness:
    if phase is Phase.RELEASED:
        opened = activity is not Activity.OPENING
        told = "the hands are open" if opened else "the hands are still opening"
        return _verdict("capture", None, [_condition("hands_open", told, met=opened)])
    if outcome is None:
        return _verdict("verdict", None, [_condition("caged", "the arms hold; the cage is not verified", met=False)])
    margin = outcome.cage_margin
    words = "the target is caged" + ("" if margin is None else f" with a margin of {1e3 * margin:.1f} mm")
    caged = Condition(name="caged", met=True, value=margin, bound=0.0, unit="m", words=words)
    return _verdict("release", None, [caged])


def _condition(name: str, words: str, *, met: bool) -> Condition:
    return Condition(name=name, met=met, value=None, bound=None, unit="", words=words)


def _verdict(following: str, blocked: str | None, conditions: list[Condition]) -> Readiness:
    go = blocked is None and all(condition.met for condition in conditions)
    return Readiness(next=following, go=go, blocked=blocked, conditions=conditions)


def _first_lower(words: str) -> str:
    return words[:1].lower() + words[1:]
