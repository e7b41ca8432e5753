"""The numbers of the co-moving couple, which a person may choose; sources as in `sim.config`."""

from __future__ import annotations

from enum import StrEnum
from typing import ClassVar, Self

from pydantic import model_validator

from sim.parameters import ConfigModel, MethodConfig, Number, WholeNumber, parameter


class Part(StrEnum):
    """A part of the method that can be left out, to see what it is for."""

    NONE = "none"
    FOLLOWING = "following"
    """Touching hands do not move with their faces."""
    TURNING = "turning"
    """Closing hands do not turn with the target."""
    LEAN = "lean"
    """The hands' axis does not lean while they touch."""
    PREDICTION = "prediction"
    """Plans do not look at base rotation and manipulability."""


class SearchConfig(ConfigModel):
    """What the planner looks for, and what it never accepts."""

    estimating_time: Number = parameter(
        0.15, "Base and target are watched before a plan is made", unit="s", source="prototype", ge=0, le=10, live=True
    )
    least_approach_time: Number = parameter(
        0.9, "Shortest time to the stand-off", unit="s", source="prototype", gt=0, le=60, live=True
    )
    stand_off: Number = parameter(
        0.010,
        "From the circle that the target's corners sweep to a tip that waits",
        unit="m",
        source="prototype: 131 mm from the centre of a square",
        gt=0,
        le=0.2,
        live=True,
    )
    manipulability_floor: Number = parameter(
        0.006,
        "A hand that comes under it backs out; a plan of a touch keeps 1.5 times as much",
        unit="m2",
        source="chosen: an eighth of the arm's greatest, L1 L2",
        ge=0,
        le=1,
        live=True,
    )
    most_base_rotation: Number = parameter(
        0.7,
        "A plan that turns the base further is dropped",
        unit="rad",
        source="chosen: 40 degrees",
        gt=0,
        le=6,
        live=True,
    )
    manipulability_comfort: Number = parameter(
        0.036,
        "A plan is the worse the further it comes under it",
        unit="m2",
        source="measured: plans that came under it ended in a singularity in 1 of 10",
        ge=0,
        le=1,
        live=True,
    )
    least_clearance: Number = parameter(
        0.0015, "Of tips that should not touch yet", unit="m", source="prototype", ge=0, le=0.1, live=True
    )
    least_apart: Number = parameter(
        0.01,
        "Between the hands, and from either to the base, of a plan",
        unit="m",
        source="twice the room that a cage must have: poses are believed to some millimetres",
        ge=0,
        le=0.1,
        live=True,
    )
    force_price: Number = parameter(
        3.0, "Time that one newton less is worth", unit="s/N", source="prototype", ge=0, le=100, live=True
    )
    turn_price: Number = parameter(
        3.0,
        "Time that one radian less of base rotation is worth",
        unit="s/rad",
        source="prototype",
        ge=0,
        le=100,
        live=True,
    )
    patience: Number = parameter(
        10.0,
        "Without a plan for so long the arms hold",
        unit="s",
        source="chosen: until then the next corner has come at the spin that is left on purpose",
        ge=0,
        le=600,
        live=True,
    )
    most_failures: WholeNumber = parameter(
        5,
        "Sequences broken off in a row after which the arms hold",
        unit="1",
        source="chosen: what fails five times fails for a reason",
        ge=1,
        le=100,
        live=True,
    )


class TouchConfig(ConfigModel):
    """How both hands brake the target."""

    force_cap: Number = parameter(
        0.6,
        "Never more than this of a hand's force is asked for",
        unit="N",
        source="prototype",
        gt=0,
        le=100,
        live=True,
    )
    planned_cap: Number = parameter(
        0.45,
        "... nor this in a plan, because mass and inertia are not known",
        unit="N",
        source="prototype",
        gt=0,
        le=100,
        live=True,
    )
    force_floor: Number = parameter(
        0.15,
        "Least force of a plan: feebler touches take longer and end no softer",
        unit="N",
        source="prototype",
        gt=0,
        le=100,
        live=True,
    )
    least_force: Number = parameter(
        0.07,
        "Least force while braking: below it contact is lost",
        unit="N",
        source="prototype",
        gt=0,
        le=100,
        live=True,
    )
    damping: Number = parameter(
        20.0,
        "d_a: force error a hand yields to, for its speed relative to the face",
        unit="N s/m",
        source="prototype: with a contact of 800 N/m it settles in 25 ms",
        gt=0,
        le=1e4,
        live=True,
    )
    integral_time: Number = parameter(
        0.08,
        "In which a standing force error is taken out",
        unit="s",
        source="chosen: three times the time in which a hand yields",
        gt=0,
        le=100,
        live=True,
    )
    integral_limit: Number = parameter(
        0.3, "... by at most so much", unit="N", source="chosen: half of the cap", ge=0, le=100, live=True
    )
    approach_damping: Number = parameter(
        10.0,
        "Guarded approach: the wanted force over its speed",
        unit="N s/m",
        source="chosen: above sqrt(k m) = 6 N s/m of a contact, so that the first one is softer",
        gt=0,
        le=1e4,
        live=True,
    )
    equalising_force: Number = parameter(
        0.08, "Until both hands touch, neither presses more", unit="N", source="prototype", gt=0, le=100, live=True
    )
    equalising_time: Number = parameter(
        0.1, "... for so long at most", unit="s", source="prototype", ge=0, le=10, live=True
    )
    edge_distance: Number = parameter(
        0.018,
        "A tip ends so far from the face's corner",
        unit="m",
        source="prototype: a lever of 57 mm on a square",
        gt=0,
        le=1,
        live=True,
    )
    slip: Number = parameter(
        0.2,
        "A tip slides outwards by this part of half the face per radian, so that friction brakes, too",
        unit="1",
        source="prototype",
        ge=0,
        le=2,
        live=True,
    )
    assumed_friction: Number = parameter(
        0.2,
        "Friction between tips and faces that plans count on",
        unit="1",
        source="prototype: a lever of 60 mm in all",
        ge=0,
        le=3,
        live=True,
    )
    imposed_mass: Number = parameter(
        0.0,
        "m of the impedance that a hand has about the moving face; 0: it yields in first order",
        unit="kg",
        source="for comparison with the published method",
        ge=0,
        le=100,
        live=True,
    )
    imposed_damping: Number = parameter(
        1.5, "... its d", unit="N s/m", source="Sec. IV-B, representative case", ge=0, le=1e4, live=True
    )
    imposed_stiffness: Number = parameter(
        10.0, "... its k", unit="N/m", source="Sec. IV-B, representative case", ge=0, le=1e5, live=True
    )
    drift_time: Number = parameter(
        0.25,
        "In which a difference of the forces takes the target's drift out",
        unit="s",
        source="prototype",
        gt=0,
        le=100,
        live=True,
    )
    drift_part: Number = parameter(
        0.6, "... with at most this part of the force", unit="1", source="prototype", ge=0, le=0.9, live=True
    )
    spin_left: Number = parameter(
        0.1,
        "Spin left on purpose: the robot turns on with the caged target anyway",
        unit="rad/s",
        source="prototype",
        ge=0,
        le=2,
        live=True,
    )
    no_touch_spin: Number = parameter(
        0.35,
        "Below it the closing turns with the target without a touch before",
        unit="rad/s",
        source="prototype",
        ge=0,
        le=5,
        live=True,
    )
    most_touches: WholeNumber = parameter(
        6,
        "After so many the arms hold",
        unit="1",
        source="chosen: each turns the base by 15 degrees or more",
        ge=1,
        le=100,
        live=True,
    )

    @model_validator(mode="after")
    def _caps_are_over_the_floor(self) -> Self:
        for name in ("force_cap", "planned_cap"):
            cap = getattr(self, name)
            if cap < self.force_floor:
                raise ValueError(
                    f"{name} = {cap:g} N is less than force_floor = {self.force_floor:g} N, the least "
                    "force of a plan: raise the cap, or lower the floor"
                )
        return self


class ClosingConfig(ConfigModel):
    """How both hands enclose the target, turning with it."""

    gain: Number = parameter(
        8.0, "Of a hand's pose error, into its speed", unit="1/s", source="prototype", gt=0, le=100, live=True
    )
    retreat_time: Number = parameter(
        0.20,
        "Hands draw back from the faces, still moving with them",
        unit="s",
        source="chosen: 15 mm at 0.1 m/s",
        gt=0,
        le=10,
        live=True,
    )
    regrasp_time: Number = parameter(
        0.45,
        "From the faces to the corners",
        unit="s",
        source="chosen: 50 mm at 0.2 m/s, and less time to drift in than the prototype's 0.7",
        gt=0,
        le=10,
        live=True,
    )
    far_gap: Number = parameter(
        0.062,
        "Hands begin the closing so far before both tips would touch, if they come from afar",
        unit="m",
        source="prototype: 150 mm from the centre of a square",
        gt=0,
        le=1,
        live=True,
    )
    near_gap: Number = parameter(
        0.018,
        "... if they come from a touch",
        unit="m",
        source="chosen: tips go straight from face to corner, 13 mm clear of a square; further out is near the reach",
        gt=0,
        le=1,
        live=True,
    )
    fast_time: Number = parameter(
        0.2, "From there to just before the faces", unit="s", source="chosen: 12 mm", gt=0, le=10, live=True
    )
    slow_gap: Number = parameter(
        0.006, "... so far before them", unit="m", source="prototype: 96 mm on a square", ge=0, le=0.1, live=True
    )
    slow_speed: Number = parameter(
        0.020, "From there on, until both hands feel the target", unit="m/s", source="prototype", gt=0, le=1, live=True
    )
    contact_force: Number = parameter(
        0.06, "That counts as felt", unit="N", source="prototype", gt=0, le=100, live=True
    )
    squeeze_force: Number = parameter(
        0.10, "Both hands press so much before they lock", unit="N", source="prototype", gt=0, le=100, live=True
    )
    squeeze_time: Number = parameter(0.12, "... for so long", unit="s", source="prototype", ge=0, le=10, live=True)
    settling_time: Number = parameter(
        0.4, "In which the joints come to rest", unit="s", source="chosen: 0.1 N suffice", gt=0, le=10, live=True
    )
    release_distance: Number = parameter(
        0.20,
        "Hand centres from the target's centre after a release",
        unit="m",
        source="the published method's",
        gt=0,
        le=2,
        live=True,
    )
    release_time: Number = parameter(
        2.0, "Time of a release", unit="s", source="the published method's", gt=0, le=60, live=True
    )


class CoMovingCoupleConfig(MethodConfig):
    """Both hands brake the target as a couple that moves with its faces, then close while turning with it (Becalm)."""

    target_shapes: ClassVar = ("square", "regular_polygon", "circle")
    why_these_shapes: ClassVar = (
        "its hands touch opposite sides and enclose opposite corners whose sides are alike, or hold what is round"
    )
    opposite_sides: ClassVar = True

    search: SearchConfig = SearchConfig()
    touch: TouchConfig = TouchConfig()
    closing: ClosingConfig = ClosingConfig()
    without: Part = parameter(Part.NONE, "Part that is left out, to see what it is for", unit="1", source="none is")
