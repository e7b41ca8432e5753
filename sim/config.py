"""Every number that a person may choose: unit, bounds, default and source.

`MissionConfig` is the root and is stored with each run. Values are SI and radians. The source of a
default is a place in the paper (Uchida, Uno, Yoshida, iSpaRo 2024), `authors` for the constants that
the authors' public simulator computes with (docs/method.md), or `chosen` with the reason.

The named configurations stand in `sim.configurations`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from enum import StrEnum
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, Field, model_validator

from sim.method.registry import MethodGroups, MethodName
from sim.parameters import LIVE, ConfigModel, Number, Points, WholeNumber, parameter
from sim.schema_history import VERSION, config_version


def _is_current(version: int) -> int:
    if version != config_version():
        raise ValueError(f"parameters have the names of version {config_version()} here")
    return version


NamesVersion = Annotated[WholeNumber, AfterValidator(_is_current)]
"""Of the parameters' names: the current one; what was stored under others is read by `sim.stored`."""

_PICTURES_UNDER_WAY = 60
"""Pictures of motion capture that may be on their way at once (`sim.perception.cameras` has room for 64)."""

_TICKS_REMEMBERED = 190
"""Ticks that motion capture may be behind (`sim.perception.estimators` remembers 200)."""

_MOST_STEPS = 100
"""Physics steps in one tick: what a live mission can still be stopped between."""


class CornerContact(StrEnum):
    """Which normal a tip feels beside a corner of the target."""

    FACE = "face"
    """That of the face it penetrates least, within one tip radius of the corner (authors, for their square).

    A target of any other shape has radial corners with this choice, too.
    """
    RADIAL = "radial"
    """From the corner to the tip's centre: continuous with both faces."""


class TargetShape(StrEnum):
    """What outline the target has, about its centre of mass."""

    SQUARE = "square"
    """Four sides of length `side`."""
    RECTANGLE = "rectangle"
    """`width` along its x axis, `depth` along its y axis."""
    REGULAR_POLYGON = "regular_polygon"
    """As many sides as `sides`, of length `side`, one of them facing +x."""
    CIRCLE = "circle"
    """Of radius `radius`."""
    POLYGON = "polygon"
    """Convex, with its corners at `vertices`."""


class SingularityHandling(StrEnum):
    """How hand velocities become joint rates near a singularity of an arm."""

    PSEUDO_INVERSE = "pseudo_inverse"
    """Plain Moore-Penrose inverse of the generalized Jacobian (authors); only the rate bound protects."""
    DAMPED = "damped_least_squares"
    """Levenberg damping that grows as manipulability falls under its warning level (Nakamura, Hanafusa 1986)."""


class HandMount(StrEnum):
    """How the hand sits on link 3."""

    YIELDING = "yielding"
    """As a fourth joint whose servo holds its rate at zero and, like the others, gives way to contact (authors)."""
    RIGID = "rigid"
    """One body with link 3."""


class Engine(StrEnum):
    """What simulates robot and target (`sim.plant.engine`)."""

    PYMUNK = "pymunk"
    """Ten rigid bodies held together by constraints (docs/decisions, findings)."""
    REDUCED = "reduced"
    """Reduced coordinates: fast, of second order through contact, and a state can be copied (decision 10)."""


class OutcomeRule(StrEnum):
    """Which of a capture's two verdicts a study's table gives as its outcome; a run's is that at locked arms."""

    FIRST_CLOSURE = "first_closure"
    """The first instant that the tips close around a slow target, as the paper's tables (authors)."""
    LOCKED_ARMS = "locked_arms"
    """After the arms have locked, with the caging test over every motion of the target."""


class BaseConfig(ConfigModel):
    """The robot's base: a rectangle, shoulders at its front corners."""

    width: Number = parameter(0.320, "Extent along the base's x axis", unit="m", source="Table I, l_a", gt=0, le=5)
    depth: Number = parameter(0.160, "Extent along the base's y axis", unit="m", source="Table I, l_b", gt=0, le=5)
    mass: Number = parameter(8.3084, "Mass", unit="kg", source="authors; Table I rounds to 8.31", gt=1e-3, le=1e4)
    inertia: Number = parameter(
        0.13526810,
        "Moment of inertia about the centre of mass",
        unit="kg m2",
        source="authors; Table I: 0.135",
        gt=1e-8,
        le=1e4,
    )
    centre_of_mass_ahead: Number = parameter(
        0.076078,
        "Centre of mass, ahead (+y) of the geometric centre",
        unit="m",
        source="authors; Table I: 0.0761",
        ge=-1,
        le=1,
    )


class LinkConfig(ConfigModel):
    """A link along its own +y axis, from its proximal joint."""

    length: Number = parameter(0.1, "Distance between its joints", unit="m", source="see the arm", gt=0, le=5)
    mass: Number = parameter(0.1, "Mass", unit="kg", source="see the arm", gt=1e-4, le=1e3)
    inertia: Number = parameter(
        1e-3, "Moment of inertia about its centre of mass", unit="kg m2", source="see the arm", gt=1e-8, le=1e3
    )
    centre_of_mass: Number = parameter(
        0.05, "Centre of mass from the proximal joint", unit="m", source="see the arm", ge=0, le=5
    )


class HandConfig(ConfigModel):
    """The U-shaped hand at the end of link 3; its centre is midway between the two tips."""

    centre_offset: Number = parameter(
        0.041556, "Hand centre beyond the end of link 3", unit="m", source="authors", ge=0, le=1
    )
    mass: Number = parameter(0.065, "Mass of the hand alone", unit="kg", source="authors", gt=1e-4, le=100)
    inertia: Number = parameter(
        1.1548e-4, "Moment of inertia about its centre of mass", unit="kg m2", source="authors", gt=1e-8, le=100
    )
    centre_of_mass: Number = parameter(
        0.02078, "Centre of mass beyond the end of link 3", unit="m", source="authors", ge=0, le=1
    )
    tip_offset: Number = parameter(
        0.039749, "Tip centre from the hand centre, across the hand", unit="m", source="authors", gt=0, le=1
    )
    tip_radius: Number = parameter(0.015, "Radius of a tip sphere", unit="m", source="Table I, d/2", gt=0, le=0.5)
    finger_radius: Number = parameter(
        0.008,
        "Half thickness of palm and fingers",
        unit="m",
        source="chosen: the paper draws fingers slimmer than their tips, so that tips touch first",
        gt=0,
        le=0.5,
    )


class ArmConfig(ConfigModel):
    """One arm; the other is its mirror image."""

    link_1: LinkConfig = LinkConfig(length=0.250, mass=0.6328, inertia=2.5515e-3, centre_of_mass=0.22098)
    link_2: LinkConfig = LinkConfig(length=0.180, mass=0.6470, inertia=1.18507e-3, centre_of_mass=0.16243)
    link_3: LinkConfig = LinkConfig(length=0.13655, mass=0.1417, inertia=1.7569e-4, centre_of_mass=0.06313)
    hand: HandConfig = HandConfig()
    link_radius: Number = parameter(
        0.015,
        "Half width of links 1 to 3, for solid contact and drawing",
        unit="m",
        source="chosen: the paper gives none",
        gt=0,
        le=0.5,
    )
    shoulder_clearance: Number = parameter(
        0.06,
        "Link 1 is solid from here on; nearer the shoulder the base's corner bars the way",
        unit="m",
        source="chosen: in the authors' simulator links are not solid, and the target reaches the base's corner first",
        ge=0,
        le=5,
    )
    initial_joint_angle_1: Number = parameter(
        math.radians(60),
        "Left joint 1 at the start; the right arm has the negative",
        unit="rad",
        source="authors",
        ge=-7,
        le=7,
    )
    initial_joint_angle_2: Number = parameter(
        math.radians(-60), "Left joint 2 at the start", unit="rad", source="authors", ge=-7, le=7
    )
    initial_joint_angle_3: Number = parameter(
        math.radians(-90), "Left joint 3 at the start", unit="rad", source="authors", ge=-7, le=7
    )


class ServoConfig(ConfigModel):
    """The joint rate servo: first order, with no rejection of contact forces.

    Under a contact wrench F on the hands the joint rates give way by time_constant H*^-1 J*^T F.
    """

    time_constant: Number = parameter(
        1.0e-3,
        "First-order time constant of the rate loop, and its compliance to contact forces",
        unit="s",
        source="authors' step of 1 ms taken as physics; gives the direct run's peak of 1.13 N",
        ge=0,
        le=0.1,
    )
    torque_limit: Number = parameter(10.0, "Largest joint torque", unit="N m", source="authors", gt=0, le=1e3)
    hand_mount: HandMount = parameter(
        HandMount.YIELDING,
        "How the hand sits on link 3",
        unit="1",
        source="authors: their arms have a fourth joint there; their direct run shows it yield by 2 degrees",
    )


class RobotConfig(ConfigModel):
    """The dual-arm free-flying robot."""

    base: BaseConfig = BaseConfig()
    arm: ArmConfig = ArmConfig()
    servo: ServoConfig = ServoConfig()


class TargetConfig(ConfigModel):
    """The debris: a prism seen from above, and how it moves at the start."""

    shape: TargetShape = parameter(TargetShape.SQUARE, "Outline", unit="1", source="Sec. II: a square")
    side: Number = parameter(
        0.150, "Length of a side of a square or regular polygon", unit="m", source="Table I, l_t", gt=0, le=2
    )
    width: Number = parameter(
        0.200, "Extent of a rectangle along its x axis", unit="m", source="chosen: twice its depth", gt=0, le=2
    )
    depth: Number = parameter(
        0.100, "Extent of a rectangle along its y axis", unit="m", source="chosen: fits between the hands", gt=0, le=2
    )
    sides: WholeNumber = parameter(
        6, "Number of sides of a regular polygon", unit="1", source="chosen: a hexagon", ge=3, le=12
    )
    radius: Number = parameter(
        0.075, "Radius of a circle", unit="m", source="chosen: touches the sides of the published square", gt=0, le=1
    )
    vertices: Points = parameter(
        ((0.0, 0.0), (0.14, 0.0), (0.11, 0.10), (0.0, 0.13)),
        "Corners of a polygon, counter-clockwise, from any origin: their centroid is the middle",
        unit="m",
        source="chosen: a wedge with no two sides alike",
        fewest=3,
        most=12,
    )
    mass: Number = parameter(2.34844, "Mass", unit="kg", source="authors; Table I: 2.35", gt=1e-3, le=1e4)
    inertia: Number = parameter(
        9.32724e-3,
        "Moment of inertia about its centre of mass",
        unit="kg m2",
        source="authors; Table I: 9.33e-3",
        gt=1e-8,
        le=1e4,
    )
    centre_of_mass_x: Number = parameter(
        0.0,
        "Centre of mass from the outline's centroid, along the target's x axis; motion capture sees the centroid",
        unit="m",
        source="Sec. II: an even plate",
        ge=-0.5,
        le=0.5,
    )
    centre_of_mass_y: Number = parameter(
        0.0, "Likewise, along its y axis", unit="m", source="Sec. II: an even plate", ge=-0.5, le=0.5
    )
    initial_x: Number = parameter(
        0.0, "Centre of mass at the start, from the base's geometric centre", unit="m", source="authors", ge=-5, le=5
    )
    initial_y: Number = parameter(
        0.350, "Centre of mass at the start, from the base's geometric centre", unit="m", source="authors", ge=-5, le=5
    )
    initial_angle: Number = parameter(0.0, "Angle at the start", unit="rad", source="authors", ge=-7, le=7)
    initial_velocity_x: Number = parameter(
        0.0, "Drift at the start", unit="m/s", source="Sec. III-A: none", ge=-2, le=2
    )
    initial_velocity_y: Number = parameter(
        0.0, "Drift at the start", unit="m/s", source="Sec. III-A: none", ge=-2, le=2
    )
    initial_spin: Number = parameter(
        1.0, "Angular velocity at the start, omega_0", unit="rad/s", source="Sec. IV-A", ge=-20, le=20
    )


class ContactConfig(ConfigModel):
    """Spring-damper law between a tip and the target (eq. of Sec. IV-A)."""

    stiffness: Number = parameter(800.0, "k_p", unit="N/m", source="Table II", gt=0, le=1e6)
    damping: Number = parameter(2.0, "c_p", unit="N s/m", source="Table II", ge=0, le=1e4)
    friction: Number = parameter(
        0.3, "Coefficient of sliding friction, mu", unit="1", source="authors; Table II prints 0.1", ge=0, le=3
    )
    friction_speed: Number = parameter(
        0.001,
        "Sliding speed at which friction reaches tanh(1) of its full value",
        unit="m/s",
        source="chosen: the authors' sign(v) sticks; above 1 mm/s hands creep along faces and cells change class",
        gt=0,
        le=1,
    )
    solid_stiffness: Number = parameter(
        4000.0,
        "Stiffness of base, links, palms and fingers against the target, in the reduced plant",
        unit="N/m",
        source="chosen: five times a tip's; a step of 1 ms is well inside its bound",
        gt=0,
        le=1e6,
    )
    solid_damping: Number = parameter(
        10.0,
        "Damping of the same contacts",
        unit="N s/m",
        source="chosen: five times a tip's",
        ge=0,
        le=1e4,
    )
    corner: CornerContact = parameter(
        CornerContact.FACE, "Normal beside a corner of the target", unit="1", source="authors: the formula of the face"
    )


class TrackingConfig(ConfigModel):
    """PID on the hand's pose error beside the feed-forward."""

    proportional: Number = parameter(
        0.0, "K_p", unit="1/s", source="Sec. IV-A: zero; Sec. V-A: 2.5 on the robot", ge=0, le=100, live=True
    )
    integral: Number = parameter(
        0.0, "K_i", unit="1/s2", source="Sec. IV-A: zero; Sec. V-A: 0.10 on the robot", ge=0, le=100, live=True
    )
    derivative: Number = parameter(0.0, "K_d", unit="1", source="Sec. IV-A and V-A: zero", ge=0, le=0.9, live=True)


class RateConfig(ConfigModel):
    """From hand velocities to joint rates."""

    singularity_handling: SingularityHandling = parameter(
        SingularityHandling.PSEUDO_INVERSE,
        "Behaviour near arm singularities",
        unit="1",
        source="authors: plain pseudo-inverse",
    )
    damping_factor: Number = parameter(
        0.05,
        "Largest damping of damped least squares",
        unit="m",
        source="chosen: a tenth of the arm's reach",
        ge=0,
        le=10,
        live=True,
    )
    manipulability_warning: Number = parameter(
        0.0113,
        "Manipulability below which damping starts and the console warns",
        unit="m2",
        source="chosen: a quarter of the arm's greatest, L1 L2",
        ge=0,
        le=100,
        live=True,
    )
    joint_rate_limit: Number = parameter(
        10.0,
        "Largest joint rate; all six are scaled together",
        unit="rad/s",
        source="chosen: well above any regular motion of the published runs, so that it acts at singularities only",
        gt=0,
        le=1e3,
        live=True,
    )


class ControlConfig(ConfigModel):
    """What the controllers of all methods share."""

    period: Number = parameter(1e-3, "Control period", unit="s", source="authors: step 1 ms", gt=1e-4, le=0.05)
    tracking: TrackingConfig = TrackingConfig()
    rates: RateConfig = RateConfig()


def _imperfection(words: str, unit: str, most: float) -> Any:
    """What is zero by default."""
    source = "chosen: the paper's simulation has perfect sensors"
    return parameter(0.0, words, unit=unit, source=source, ge=0, le=most, live=True)


def _noise(quantity: str, unit: str, most: float) -> Any:
    """A standard deviation; zero by default."""
    return _imperfection(f"Standard deviation of the noise in {quantity}", unit, most)


class NoiseDraws(StrEnum):
    """How noise is drawn: each is one stream of numbers, and a run is flown again with its own."""

    SINGLY = "singly"
    """Each number by itself (what all runs until now were flown with)."""
    IN_PAIRS = "in_pairs"
    """Two at a time, in half of the time (futures, which are many)."""


class NoiseConfig(ConfigModel):
    """White Gaussian noise in what the controller perceives, drawn again every tick (`sim.perception`)."""

    draws: NoiseDraws = parameter(
        NoiseDraws.SINGLY, "How noise is drawn", unit="1", source="chosen: runs stay as they were recorded"
    )
    position: Number = _noise("positions of base and target", "m", 1)
    angle: Number = _noise("angles of base and target", "rad", 3)
    velocity: Number = _noise("velocities of base and target", "m/s", 10)
    spin: Number = _noise("angular velocities of base and target", "rad/s", 20)
    joint_angle: Number = _noise("joint angles", "rad", 3)
    joint_rate: Number = _noise("joint rates", "rad/s", 20)
    force: Number = _noise("forces at the wrists", "N", 1000)
    torque: Number = _noise("torques at the wrists", "N m", 1000)


class ImperfectionsConfig(ConfigModel):
    """What sensors get wrong beside noise (`sim.perception.imperfections`)."""

    force_bias: Number = _imperfection(
        "Standard deviation of the bias that taring leaves in a wrist's forces, drawn once by the seed", "N", 1000
    )
    torque_bias: Number = _imperfection("Likewise in its torque", "N m", 1000)
    encoder_resolution: Number = _imperfection("Step of the joint encoders; 0: they have none", "rad", 0.1)
    outliers: Number = _imperfection("Part of the pictures of motion capture in which a body is seen elsewhere", "1", 1)
    outlier_distance: Number = parameter(
        0.1, "How far elsewhere", unit="m", source="the emulated testbed", ge=0, le=10, live=True
    )


class WristConfig(ConfigModel):
    """What a simulated wrist reads of what it feels: a calibration that is off, as a fit may find it."""

    gain: Number = parameter(1.0, "What a newton reads", unit="1", source="chosen: calibrated", gt=0.1, le=10)
    bias_x: Number = parameter(
        0.0, "Reading without a force, along the hand's x axis", unit="N", source="chosen: tared", ge=-100, le=100
    )
    bias_y: Number = parameter(
        0.0, "Reading without a force, along the hand's y axis", unit="N", source="chosen: tared", ge=-100, le=100
    )
    bias_torque: Number = parameter(0.0, "Reading without a torque", unit="N m", source="chosen: tared", ge=-10, le=10)


class WristsConfig(ConfigModel):
    """Both wrists of a simulation; a robot has its own."""

    left: WristConfig = WristConfig()
    right: WristConfig = WristConfig()


class Source(StrEnum):
    """How the controller comes by the motion of base and target."""

    EVERY_TICK = "every_tick"
    """Poses and twists in every tick, at once (the paper's simulation)."""
    MOTION_CAPTURE = "motion_capture"
    """Pictures at a rate of their own, late and with gaps, filtered as on the robot (`sim.perception.estimators`)."""


class CaptureConfig(ConfigModel):
    """The cameras that see base and target, where motion capture is the source."""

    rate: Number = parameter(100.0, "Pictures", unit="Hz", source="the link's contract", gt=0.1, le=1e4)
    delay: Number = parameter(
        0.010, "From a picture to its message", unit="s", source="the emulated testbed", ge=0, le=1
    )
    dropouts: Number = parameter(
        0.005, "Part of the pictures in which a body is not seen", unit="1", source="the emulated testbed", ge=0, lt=1
    )
    stamp_error: Number = parameter(
        0.0,
        "How much later than it was taken a picture's stamp says",
        unit="s",
        source="chosen: clocks that agree",
        ge=-0.1,
        le=0.1,
    )


class FilterConfig(ConfigModel):
    """What the filter of pictures expects of them, and of the bodies: standard deviations."""

    position: Number = parameter(3e-4, "Of a position", unit="m", source="chosen: 1.5 testbed's", gt=0, le=1)
    angle: Number = parameter(1.5e-3, "Of an angle", unit="rad", source="chosen: 1.5 testbed's", gt=0, le=3)
    velocity: Number = parameter(
        2e-3, "Of a velocity, where it is measured", unit="m/s", source="the couple's sample", gt=0, le=10
    )
    spin: Number = parameter(
        0.02, "Of an angular velocity, where it is measured", unit="rad/s", source="the couple's sample", gt=0, le=20
    )
    force: Number = parameter(0.02, "Of a wrist's force", unit="N", source="the couple's sample", gt=0, le=100)
    torque: Number = parameter(1e-3, "Of a wrist's torque", unit="N m", source="the couple's sample", gt=0, le=100)
    free_acceleration: Number = parameter(
        0.02, "Of a body that nothing touches", unit="m/s2", source="chosen: drag and tilt of a table", gt=0, le=100
    )
    free_angular_acceleration: Number = parameter(
        0.05, "Likewise", unit="rad/s2", source="chosen: drag of a table", gt=0, le=1e3
    )
    touched_acceleration: Number = parameter(
        0.6, "Of a body that is touched", unit="m/s2", source="chosen: 1.4 N on the target", gt=0, le=1e3
    )
    touched_angular_acceleration: Number = parameter(
        6.0, "Likewise", unit="rad/s2", source="chosen: 1.4 N at 40 mm on the target", gt=0, le=1e4
    )
    contact_memory: Number = parameter(
        0.15,
        "How long after a contact pictures may still show it",
        unit="s",
        source="chosen: motion capture's delay, and more",
        ge=0,
        le=5,
    )


class Estimator(StrEnum):
    """What is made of the readings before the controller gets them."""

    NONE = "none"
    """Nothing; pictures of motion capture are filtered as if nothing were known of the forces (the testbed's way)."""
    MODEL_BASED = "model_based"
    """Motion by a filter that knows momentum and felt forces, wrists tared and smoothed (`sim.perception.motion`)."""


class PerceptionConfig(ConfigModel):
    """What the controller knows of robot and target (`sim.perception`)."""

    source: Source = parameter(
        Source.EVERY_TICK, "Where the motion of base and target comes from", unit="1", source="the paper's simulation"
    )
    estimator: Estimator = parameter(
        Estimator.NONE, "What is made of the readings", unit="1", source="the paper's simulation has perfect sensors"
    )
    noise: NoiseConfig = NoiseConfig()
    imperfections: ImperfectionsConfig = ImperfectionsConfig()
    wrist: WristsConfig = WristsConfig()
    capture: CaptureConfig = CaptureConfig()
    filter: FilterConfig = FilterConfig()
    force_smoothing_time: Number = parameter(
        4e-3,
        "Time constant that the wrists' readings are smoothed with, by the model-based estimator",
        unit="s",
        source="chosen: a quarter of the time in which a hand yields",
        ge=0,
        le=1,
    )
    assumed_mass: Number = parameter(
        2.34844, "The target's mass, as assumed beforehand", unit="kg", source="Table I", gt=1e-3, le=1e4
    )
    assumed_mass_uncertainty: Number = parameter(
        0.3, "... and its standard deviation, relative", unit="1", source="the couple's sample", ge=0, le=1
    )
    assumed_inertia: Number = parameter(
        9.32724e-3,
        "The target's moment of inertia, as assumed beforehand",
        unit="kg m2",
        source="Table I",
        gt=1e-8,
        le=1e4,
    )
    assumed_inertia_uncertainty: Number = parameter(
        0.3, "... and its standard deviation, relative", unit="1", source="the couple's sample", ge=0, le=1
    )
    contact_threshold: Number = parameter(
        0.12,
        "Wrist force that counts as contact, until it falls under half of it; perfect sensors need none",
        unit="N",
        source="chosen: six standard deviations of the testbed's wrists",
        gt=0,
        le=100,
        live=True,
    )


class JudgingConfig(ConfigModel):
    """How a capture's outcome is judged."""

    rule: OutcomeRule = parameter(
        OutcomeRule.FIRST_CLOSURE, "Verdict that a study's table gives as its outcome", unit="1", source="authors"
    )
    force_bound: Number = parameter(
        1.12969,
        "Force counts as reduced below this hand resultant: direct caging's peak",
        unit="N",
        source="authors",
        gt=0,
        le=1e6,
    )
    relative_spin_limit: Number = parameter(
        0.5, "Captured at or below this spin relative to the base", unit="rad/s", source="authors", gt=0, le=20
    )
    relative_speed_limit: Number = parameter(
        0.1, "Captured at or below this speed relative to the turning base", unit="m/s", source="authors", gt=0, le=10
    )
    ejection_distance: Number = parameter(
        0.6, "Ejected at this distance between the centres of base and target", unit="m", source="authors", gt=0, le=50
    )
    time_limit: Number = parameter(45.0, "Unresolved at this time", unit="s", source="authors", gt=0, le=3600)
    hold_time: Number = parameter(
        2.0,
        "From locked arms to the verdict",
        unit="s",
        source="chosen: the target crosses its room in the cage several times",
        ge=0,
        le=600,
    )
    touch_gap: Number = parameter(
        0.1,
        "Contacts of one arm closer than this are one touch",
        unit="s",
        source="chosen: a tip that hammers at a corner leaves it for up to 0.06 s",
        ge=0,
        le=5,
    )


class TableConfig(ConfigModel):
    """The air table of a testbed; without drag and tilt bodies float free."""

    drag: Number = parameter(
        0.0,
        "Part of every velocity that is lost in a second, for small ones",
        unit="1/s",
        source="chosen: floating free",
        ge=0,
        le=10,
    )
    tilt_x: Number = parameter(
        0.0, "Tilt along x; what is on it slides that way", unit="rad", source="chosen: level", ge=-0.1, le=0.1
    )
    tilt_y: Number = parameter(0.0, "Tilt along y", unit="rad", source="chosen: level", ge=-0.1, le=0.1)


class SimulationConfig(ConfigModel):
    """What simulates the plant, and its numerics (docs/decisions, findings)."""

    engine: Engine = parameter(
        Engine.PYMUNK, "What simulates robot and target", unit="1", source="chosen: reproduces the paper"
    )
    time_step: Number = parameter(
        1e-3, "Physics step; divides the control period", unit="s", source="authors: 1 ms", ge=1e-5, le=0.05
    )
    solver_iterations: WholeNumber = parameter(
        25,
        "Iterations of pymunk's solver",
        unit="1",
        source="measured: free flight needs 15; the blows of a capture settle from 25 on",
        ge=10,
        le=500,
    )
    joint_error_time: Number = parameter(
        0.0,
        "Time constant in which a joint's position error is removed; under 1.4 ms pymunk takes one step",
        unit="s",
        source="measured: within one step keeps momentum best, and is stable from 15 iterations on",
        ge=0,
        le=1,
    )
    collision_slop: Number = parameter(
        1e-4,
        "Overlap that pymunk leaves in solid contact",
        unit="m",
        source="measured: its default is two thirds of the target",
        ge=0,
        le=0.01,
    )
    momentum_jump_limit: Number = parameter(
        0.01,
        "Part of all bodies' momenta that total momentum may change by in one control period, else the plant faults",
        unit="1",
        source="chosen: nothing pushes from outside; the worst tick of the published study leaves 3e-5",
        gt=0,
        le=1e6,
    )
    seed: WholeNumber = parameter(
        0, "Seed of every random number of the run", unit="1", source="chosen", ge=0, le=2**63 - 1
    )


class MissionConfig(MethodGroups):
    """Everything that a run depends on; stored with it.

    Beside what stands here it has a group for each method, by the method's name (`sim.method.registry`).
    """

    version: NamesVersion = Field(
        default_factory=config_version, description="Of the parameters' names (`sim.schema_history`)"
    )
    method: MethodName = parameter(
        MethodName("published"), "How the target is captured", unit="1", source="chosen: reproduces the paper"
    )
    robot: RobotConfig = RobotConfig()
    target: TargetConfig = TargetConfig()
    contact: ContactConfig = ContactConfig()
    table: TableConfig = TableConfig()
    perception: PerceptionConfig = PerceptionConfig()
    control: ControlConfig = ControlConfig()
    judging: JudgingConfig = JudgingConfig()
    simulation: SimulationConfig = SimulationConfig()

    @model_validator(mode="after")
    def _steps_divide_the_control_period(self) -> Self:
        period, step = self.control.period, self.simulation.time_step
        steps = round(period / step)
        if steps < 1 or abs(steps * step - period) > 1e-9 * period:
            raise ValueError(
                f"simulation.time_step = {step:g} s does not divide control.period = {period:g} s; "
                f"take a whole fraction of it, such as {period:g} or {period / 2:g}"
            )
        if steps > _MOST_STEPS:
            raise ValueError(
                f"simulation.time_step = {step:g} s makes {steps} steps of control.period = {period:g} s; "
                f"at most {_MOST_STEPS} can be flown in time, so take {period / _MOST_STEPS:g} or more"
            )
        return self

    @model_validator(mode="after")
    def _the_engine_reads_what_was_chosen(self) -> Self:
        if self.simulation.engine is Engine.PYMUNK:
            return self
        for name in _READ_BY_PYMUNK_ONLY:
            value, default = getattr(self.simulation, name), SimulationConfig.model_fields[name].default
            if value != default:
                raise ValueError(
                    f"simulation.{name} = {value:g} is read by simulation.engine = 'pymunk' only, and the engine is "
                    f"'{self.simulation.engine.value}'; leave it at {default:g}, or take the engine that reads it"
                )
        return self

    @model_validator(mode="after")
    def _pictures_arrive_while_they_are_remembered(self) -> Self:
        capture, period = self.perception.capture, self.control.period
        if self.perception.source is not Source.MOTION_CAPTURE:
            return self
        if capture.rate * period > 1.0:
            raise ValueError(
                f"perception.capture.rate = {capture.rate:g} Hz is more than one picture a tick; "
                f"take {1.0 / period:g} or less with control.period = {period:g} s"
            )
        most = min(_PICTURES_UNDER_WAY / capture.rate, _TICKS_REMEMBERED * period)
        if capture.delay > most:
            raise ValueError(
                f"perception.capture.delay = {capture.delay:g} s: at {capture.rate:g} Hz and control.period = "
                f"{period:g} s pictures may be at most {most:g} s late"
            )
        return self


_READ_BY_PYMUNK_ONLY = ("solver_iterations", "joint_error_time", "collision_slop")
"""Parameters of `simulation` that another engine would silently leave aside."""


def parameters_of(model: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Every leaf of a configuration model: its full path and its pydantic field."""
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from parameters_of(field.annotation, f"{prefix}{name}.")
        elif name != VERSION:
            yield prefix + name, field


PARAMETERS: Mapping[str, Any] = dict(parameters_of(MissionConfig))
"""Full path, such as `published.impedance.damping`, to the pydantic field with unit, bounds, default and source."""


def is_live(path: str) -> bool:
    """Whether that parameter may change while a mission flies."""
    return bool(PARAMETERS[path].json_schema_extra[LIVE])


def value_at(config: MissionConfig, path: str) -> Any:
    """The value of the parameter at that full path."""
    value: Any = config
    for name in path.split("."):
        value = getattr(value, name)
    return value


def differences(old: MissionConfig, new: MissionConfig) -> dict[str, tuple[Any, Any]]:
    """Full path to (old value, new value), for every parameter that differs."""
    pairs = {path: (value_at(old, path), value_at(new, path)) for path in PARAMETERS}
    return {path: pair for path, pair in pairs.items() if pair[0] != pair[1]}
