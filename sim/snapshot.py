"""What is published of a mission: one frozen snapshot, the same over REST, WebSocket, scene and library.

SI and radians. Poses (x, y, angle), twists (vx, vy, angular velocity) and wrenches (fx, fy, torque) are
in world axes; the world's origin is where the base's geometric centre starts.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

Vector3 = tuple[float, float, float]
Vector2 = tuple[float, float]


class FrozenMessage(BaseModel):
    """Base of what is published or stored: frozen, so that readers may share it, and without unknown fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class OutcomeClass(StrEnum):
    """How a capture ended: the paper's five classes, and unresolved."""

    CAGED_FORCE_REDUCED = "caged_force_reduced"
    CAGED_FORCE_NOT_REDUCED = "caged_force_not_reduced"
    CAGED_UNPLANNED_CONTACT = "caged_unplanned_contact"
    EJECTION = "ejection"
    BASE_COLLISION = "base_collision"
    UNRESOLVED = "unresolved"


class Touch(FrozenMessage):
    """One touch of an arm's tips on the target."""

    arm: Literal["left", "right"]
    start: float = Field(description="First contact [s]")
    end: float | None = Field(description="Last contact [s]; null while it lasts")
    peak: float = Field(description="Largest resultant of the hand's tip forces [N]")
    planned: bool = Field(description="False if a plan was still running when it began")


class Outcome(FrozenMessage):
    """How a capture ended: the verdict, and beside it the paper's."""

    outcome: OutcomeClass = Field(description="The verdict: that at locked arms")
    at_first_closure: OutcomeClass = Field(
        description="The paper's verdict: judged at the first closed instant, as its tables"
    )
    at_locked_arms: OutcomeClass = Field(description="Judged when the arms have locked, by the caging test")
    caged: bool = Field(description="No motion leads the target out of the locked hands")
    cage_margin: float | None = Field(
        description="How far the tips would have to give way to let it out [m]; null if not caged"
    )
    peak_tip_force: float = Field(description="Largest hand resultant of the whole sequence, to locked arms [N]")
    peak_tip_force_to_closure: float = Field(description="The same up to the first closed instant [N]")
    closed_at: float | None = Field(description="First closed instant [s]")
    locked_at: float | None = Field(description="Arms locked [s]")
    duration: float = Field(description="From the sequence's start to the verdict [s]")
    contacts: list[Touch]
    final_target_spin: float = Field(description="Target's angular velocity at the verdict [rad/s]")
    min_manipulability: float = Field(description="Smallest of both arms over the sequence [m2]")
    momentum_error: float = Field(
        description="Largest change of total momentum: linear [N s] plus angular about the origin [N m s]"
    )

    @model_validator(mode="before")
    @classmethod
    def _one_verdict(cls, stored: Any) -> Any:
        """Version 0.1.0 wrote into `outcome` whichever of the two verdicts `judging.rule` named."""
        if isinstance(stored, dict) and "at_locked_arms" in stored:
            return {**stored, "outcome": stored["at_locked_arms"]}
        return stored


class BodyState(FrozenMessage):
    """A rigid body in world axes."""

    pose: Vector3 = Field(description="x, y of the centre of mass [m], angle [rad]")
    twist: Vector3 = Field(description="vx, vy [m/s], angular velocity [rad/s]")


class ArmState(FrozenMessage):
    """One arm: joints, hand and what its tips feel."""

    joint_angle: Vector3 = Field(description="Joints 1 to 3 [rad]")
    joint_rate: Vector3 = Field(description="Measured [rad/s]")
    commanded_joint_rate: Vector3 = Field(description="[rad/s]")
    mount_angle: float = Field(description="Of the hand on link 3 [rad]")
    hand_pose: Vector3 = Field(description="Hand centre x, y [m], angle [rad]")
    hand_twist: Vector3 = Field(description="[m/s, rad/s]")
    desired_hand_pose: Vector3 = Field(description="Where the plan puts the hand [m, rad]")
    desired_hand_twist: Vector3 = Field(description="[m/s, rad/s]")
    hand_wrench: Vector3 = Field(description="Target on hand, about the hand centre [N, N m]")
    tip_force: tuple[Vector2, Vector2] = Field(description="Target on each tip [N]")
    wanted_force: float = Field(
        description="That the hand should press with [N]; 0 where its motion is what is wanted, or the method has none"
    )
    in_contact: bool
    manipulability: float = Field(description="Volume of the hand-velocity ellipsoid [m2]")


class TargetEstimate(FrozenMessage):
    """What the model-based estimator believes of the target, with standard deviations."""

    inertia: float = Field(description="About its centre of mass [kg m2]")
    inertia_deviation: float = Field(description="[kg m2]")
    twist_deviation: Vector3 = Field(description="Of its perceived twist [m/s, rad/s]")


class Prediction(FrozenMessage):
    """What a method expects of the plan under way, rolled out to the closed cage."""

    until: float = Field(description="The cage will be closed [s]")
    force: float = Field(description="That each hand will press with while braking [N]; 0: no braking touch")
    base_rotation: float = Field(description="Largest, from here on [rad]")
    manipulability: float = Field(description="Least of both arms [m2]")
    clearance: float | None = Field(description="Least, of tips that should not touch [m]; null: none comes near")


class PlannedTouch(FrozenMessage):
    """Where both hands press on the target; places are from its middle, in its axes."""

    left_side: tuple[Vector2, Vector2] = Field(description="Ends of the side that the left hand presses on [m]")
    right_side: tuple[Vector2, Vector2] = Field(description="Of the right hand's, likewise")
    left_point: Vector2 = Field(description="Where on it the left hand touches first [m]")
    right_point: Vector2 = Field(description="Likewise, the right hand")
    lever: float = Field(description="That the torque of both hands acts with: as planned, then as measured [m]")
    arc_left: float = Field(description="Along which they may still press, turning with the target [rad]")


class Plan(FrozenMessage):
    """The motion being followed: straight lines through these hand poses at these times."""

    kind: str = Field(description="What it is for, by the method: touch, cage or release of the published one")
    times: list[float] = Field(description="Time of each pose [s]")
    left: list[Vector3] = Field(description="Left hand's poses; empty if it is idle")
    right: list[Vector3] = Field(description="Right hand's poses; empty if it is idle")
    target_at_end: Vector3 = Field(description="Predicted target pose at the end of the plan [m, rad]")
    predicted: Prediction | None = Field(description="Null where the method does not roll its plans out")
    touch: PlannedTouch | None = Field(description="Null where the plan is for no touch of both hands on two sides")


class Condition(FrozenMessage):
    """One thing that must hold before the next phase may begin."""

    name: str = Field(description="By the method; spin, absorbed, enclosed, closing_done, caged or hands_open")
    met: bool
    value: float | None = Field(description="What it is now, in `unit`; null if it is not a number")
    bound: float | None = Field(description="What it is compared with, in `unit`; null likewise")
    unit: str = Field(description="SI; empty if it is not a number")
    words: str = Field(description="The same in words")

    @classmethod
    def of(cls, name: str, words: str, *, met: bool) -> Condition:
        """A condition without a number."""
        return cls(name=name, met=met, value=None, bound=None, unit="", words=words)


class Readiness(FrozenMessage):
    """Go or no-go for what comes next, and what speaks for or against it."""

    next: str = Field(description="The phase or command this is about")
    go: bool = Field(description="Nothing blocks it, and every condition is met")
    blocked: str | None = Field(description="Why nothing can come next whatever the conditions; null if it can")
    conditions: list[Condition]


class Stage(FrozenMessage):
    """One phase of the sequence as this mission goes through it."""

    phase: str
    state: Literal["done", "failed", "skipped", "now", "ahead"] = Field(
        description="skipped: never entered, and no longer to come"
    )
    why: str = Field(description="Of failed and skipped, in words; else empty")
    lasted: float | None = Field(description="Time spent in it [s]; null if it was not entered")


class Snapshot(FrozenMessage):
    """The mission at one tick."""

    tick: int
    time: float = Field(description="Mission time [s]")
    method: str = Field(description="How the target is captured")
    phase: str
    activity: str = Field(description="What the hands are doing, by the method")
    description: str = Field(description="What is happening, in words")
    base: BodyState
    target: BodyState
    left: ArmState
    right: ArmState
    target_estimate: TargetEstimate | None = Field(description="Null where nothing is estimated")
    trouble: str = Field(description="Why the sequence was last broken off or found no plan; empty: it was not")
    spin: float = Field(description="Target's angular velocity [rad/s]")
    spin_threshold: float | None = Field(description="Below it caging may begin [rad/s]; null: at any spin")
    drift: float = Field(description="Speed of the target's centre [m/s]")
    cage_closed: bool = Field(description="The tips enclose the target at its present angle")
    cage_margin: float | None = Field(description="Margin of the locked cage [m]; null unless the arms hold one")
    peak_tip_force: float = Field(description="So far [N]")
    momentum: Vector3 = Field(description="Of robot and target about the world's origin [N s, N m s]")
    contacts: list[Touch]
    plan: Plan | None
    readiness: Readiness
    stages: list[Stage] = Field(description="Idle, detumbling, caging, holding, and the present phase if it is another")
    outcome: Outcome | None
