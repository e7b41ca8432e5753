"""What the co-moving couple says about itself: one sentence at any moment, and what comes next."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.co_moving_couple.memory import Activity, Trouble
from sim.method.conditions import OPEN, enclosed_condition, open_hands_condition, spin_condition
from sim.method.method import Words
from sim.snapshot import Condition, Plan, Touch


def _motion(row: Any, plan: Plan | None, touches: Sequence[Touch]) -> str:
    activity = Activity(int(row["activity"]))
    if Phase(int(row["phase"])) is Phase.RELEASED:
        return "Both hands draw back." if activity is Activity.OPENING else OPEN
    spin, forces, planned = float(row["target_perceived_twist"][2]), _forces(row), _planned(row, plan)
    return {
        Activity.ESTIMATING: "Base and target are watched, and ways to touch or to close are rolled out.",
        Activity.APPROACHING: f"Both hands go to where they wait for two opposite sides{planned}.",
        Activity.ENTERING: f"Both hands come in with the sides and take up their motion{planned}.",
        Activity.TOUCHING: f"Both hands brake the target, moving with it: {forces}{_arc(plan)}; spin {spin:.2f} rad/s.",
        Activity.RETREATING: "Both hands lift off, turning with the target.",
        Activity.REGRASPING: f"Both hands go to opposite corners{planned}.",
        Activity.CLOSING: f"Both hands close, turning with the target, {forces}.",
        Activity.SQUEEZING: f"Both hands press lightly, {forces}.",
        Activity.SETTLING: "The joints come to rest while robot and target turn on together.",
        Activity.RECOVERING: f"Both hands back out, then another plan is looked for: {_trouble(row)}.",
    }.get(activity, "The sequence begins.")


def _trouble(row: Any) -> str:
    return TROUBLE.get(int(row["trouble"]), "they touch where a sequence begins")


def _forces(row: Any) -> str:
    felt = [math.hypot(wrench[0], wrench[1]) for wrench in row["perceived_hand_wrench"].tolist()]
    left, right = (f"{force:.2f} of {wanted:.2f} N" for force, wanted in zip(felt, row["wanted_force"], strict=True))
    return f"left {left}, right {right}"


def _arc(plan: Plan | None) -> str:
    """With what lever they press and how far yet, to stand in a sentence."""
    touch = None if plan is None else plan.touch
    if touch is None:
        return ""
    return f", lever {1e3 * touch.lever:.0f} mm, {math.degrees(touch.arc_left):.0f} degrees of arc left"


def _planned(row: Any, plan: Plan | None) -> str:
    """What was predicted of the plan under way, to stand at the end of a sentence."""
    expected = None if plan is None else plan.predicted
    if expected is None:
        return ""
    force = f"{expected.force:.2f} N, " if expected.force > 0.0 else ""
    turn, left = math.degrees(expected.base_rotation), max(0.0, expected.until - float(row["time"]))
    return f"; planned: {force}base turns {turn:.0f} degrees, closed in {left:.1f} s"


def _next_step(row: Any, config: MissionConfig, phase: Phase) -> tuple[str, list[Condition]]:
    slow = _spin_condition(float(row["target_perceived_twist"][2]), config.co_moving_couple.touch.no_touch_spin)
    if phase is Phase.IDLE:
        fast = slow.model_copy(update={"met": True, "words": f"{slow.words}: a touch by both hands comes first"})
        return ("caging", [slow]) if slow.met else ("detumbling", [fast])
    if phase is Phase.DETUMBLING:
        return "caging", [slow]
    if phase is Phase.CAGING:
        resting = Activity(int(row["activity"])) is Activity.SETTLING
        settled = "the joints come to rest" if resting else "the hands have not gripped yet"
        return "holding", [
            enclosed_condition(met=_is_enclosed(row)),
            Condition.of("gripped", settled, met=resting),
        ]
    return "capture", [open_hands_condition(met=Activity(int(row["activity"])) is not Activity.OPENING)]


def _spin_condition(spin: float, bound: float) -> Condition:
    return spin_condition(spin, bound, met=abs(spin) <= bound, what=f"the {bound:g} rad/s that a closing takes")


def _unmet(row: Any, config: MissionConfig) -> str:
    phase = Phase(int(row["phase"]))
    if trouble := TROUBLE.get(int(row["trouble"])):
        return trouble
    if phase is Phase.DETUMBLING:
        slow = abs(float(row["target_perceived_twist"][2])) <= config.co_moving_couple.touch.no_touch_spin
        return "" if slow else "the spin was still more than a closing takes"
    return "" if phase is not Phase.CAGING or _is_enclosed(row) else "the tips did not enclose the target"


def _is_enclosed(row: Any) -> bool:
    """Whether the hands have the target: tips that have gripped it lie, by perceived poses, a little within it."""
    return bool(row["perceived_closed"]) or Activity(int(row["activity"])) is Activity.SETTLING


TROUBLE: Mapping[int, str] = {
    Trouble.NO_PLAN: "no way to touch or to close keeps to reach, clearance and force",
    Trouble.HAND_MISSED: "one hand did not meet its side",
    Trouble.OUT_OF_REACH: "an arm came near a singularity",
    Trouble.FORCE_OVER_CAP: "a hand felt much more than the force cap",
    Trouble.SENSOR_LOST: "the target was out of sight for too long",
    Trouble.NOT_ENCLOSED: "the tips did not come far enough around the target",
    Trouble.TOO_MANY_TOUCHES: "as many touches as are allowed did not calm the target",
}

WORDS = Words(
    phase={
        Phase.DETUMBLING: "Detumbling begins",
        Phase.CAGING: "Caging begins: the target turns slowly enough",
        Phase.RELEASED: "The hands open",
    },
    plan={
        Activity.APPROACHING: "A touch by both hands is planned",
        Activity.REGRASPING: "The closing of both hands is planned",
        Activity.OPENING: "The opening of both hands is planned",
    },
    trouble=TROUBLE,
    motion=_motion,
    next_step=_next_step,
    unmet=_unmet,
)
