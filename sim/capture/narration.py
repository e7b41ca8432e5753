"""The words beside the numbers: what is happening, and whether the next phase may begin."""

from __future__ import annotations

from collections.abc import Sequence as Ordered
from typing import Any

from sim.capture.events import verdict_in_words
from sim.capture.snapshot import Outcome, Plan, Readiness, Touch
from sim.config import MissionConfig
from sim.control.phases import Activity, Phase


def description(
    row: Any, config: MissionConfig, plan: Plan | None, touches: Ordered[Touch], outcome: Outcome | None
) -> str:
    """One sentence on what is happening at a tick, one element of `TICK`."""
    phase, activity = Phase(int(row["phase"])), Activity(int(row["activity"]))
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


def readiness(row: Any, config: MissionConfig, outcome: Outcome | None) -> Readiness:
    """Whether the phase that would come next may begin at a tick, and what speaks for or against it."""
    phase, activity = Phase(int(row["phase"])), Activity(int(row["activity"]))
    spin, threshold = abs(float(row["target_twist"][2])), config.control.caging.spin_threshold
    slow = spin < threshold
    spin_reason = f"spin {spin:.2f} rad/s is {'under' if slow else 'over'} the threshold of {threshold:g} rad/s"
    if phase is Phase.IDLE:
        return Readiness(next="caging" if slow else "detumbling", go=True, reasons=[spin_reason])
    if phase is Phase.DETUMBLING:
        reasons = [spin_reason]
        if slow and activity is Activity.ABSORBING:
            reasons.append("the hand is still absorbing the touch")
        return Readiness(next="caging", go=slow and activity is not Activity.ABSORBING, reasons=reasons)
    if phase is Phase.CAGING:
        closed, done = bool(row["closed"]), activity is not Activity.CLOSING
        reasons = ["the tips enclose the target" if closed else "the tips do not enclose the target yet"]
        reasons.append("the closing motion is done" if done else "the closing motion is under way")
        return Readiness(next="holding", go=closed and done, reasons=reasons)
    return _readiness_at_rest(phase, outcome)


def _readiness_at_rest(phase: Phase, outcome: Outcome | None) -> Readiness:
    if phase in (Phase.STOPPED, Phase.FAULTED):
        return Readiness(next="reset", go=True, reasons=[f"the mission is {phase.label}"])
    if phase is Phase.RELEASED:
        return Readiness(next="capture", go=True, reasons=["the hands are open"])
    if outcome is None:
        return Readiness(next="verdict", go=False, reasons=["the arms hold; the cage is being verified"])
    if outcome.caged:
        return Readiness(next="release", go=True, reasons=["the target is caged for good"])
    return Readiness(next="reset", go=True, reasons=["the capture has ended without a cage"])
