"""What the published method says about itself: one sentence at any moment, and what comes next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.conditions import OPEN, enclosed_condition, open_hands_condition
from sim.method.method import Words
from sim.method.published.memory import Activity
from sim.snapshot import Condition, Plan, Touch


def _motion(row: Any, plan: Plan | None, touches: Sequence[Touch]) -> str:
    activity = Activity(int(row["activity"]))
    if Phase(int(row["phase"])) is Phase.RELEASED:
        return "Both hands draw back." if activity is Activity.OPENING else OPEN
    spin = float(row["target_perceived_twist"][2])
    hand = "right" if plan and plan.right and not plan.left else "left"
    remaining = max(0.0, plan.times[-1] - float(row["time"])) if plan else 0.0
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


def _next_step(row: Any, config: MissionConfig, phase: Phase) -> tuple[str, list[Condition]]:
    activity = Activity(int(row["activity"]))
    spin = _spin_condition(float(row["target_perceived_twist"][2]), config.published.caging.spin_threshold)
    if phase is Phase.IDLE:
        fast = spin.model_copy(update={"met": True, "words": f"{spin.words}: the touches come first"})
        return ("caging", [spin]) if spin.met else ("detumbling", [fast])
    if phase is Phase.DETUMBLING:
        absorbed = activity is not Activity.ABSORBING
        words = "no touch is being absorbed" if absorbed else "the hand is still absorbing the touch"
        return "caging", [spin, Condition.of("absorbed", words, met=absorbed)]
    if phase is Phase.CAGING:
        return "holding", _closing_conditions(bool(row["perceived_closed"]), activity)
    return "capture", [open_hands_condition(met=activity is not Activity.OPENING)]


def _spin_condition(spin: float, threshold: float) -> Condition:
    slow = abs(spin) < threshold
    words = f"spin {abs(spin):.2f} rad/s is {'under' if slow else 'over'} the threshold of {threshold:g} rad/s"
    return Condition(name="spin", met=slow, value=abs(spin), bound=threshold, unit="rad/s", words=words)


def _closing_conditions(closed: bool, activity: Activity) -> list[Condition]:
    done = activity is not Activity.CLOSING
    moved = "the closing motion is done" if done else "the closing motion is under way"
    return [enclosed_condition(met=closed), Condition.of("closing_done", moved, met=done)]


def _unmet(row: Any, config: MissionConfig) -> str:
    phase = Phase(int(row["phase"]))
    if phase is Phase.DETUMBLING:
        slow = abs(float(row["target_perceived_twist"][2])) < config.published.caging.spin_threshold
        return "" if slow else "the spin was still over its threshold"
    return "" if phase is not Phase.CAGING or row["perceived_closed"] else "the tips did not enclose the target"


WORDS = Words(
    phase={
        Phase.DETUMBLING: "Detumbling begins",
        Phase.CAGING: "Caging begins: the spin is under its threshold",
        Phase.RELEASED: "The hands open",
    },
    plan={
        Activity.APPROACHING: "A touch is planned",
        Activity.CLOSING: "The closing of both hands is planned",
        Activity.OPENING: "The opening of both hands is planned",
    },
    trouble={},
    motion=_motion,
    next_step=_next_step,
    unmet=_unmet,
)
