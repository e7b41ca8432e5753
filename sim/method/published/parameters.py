"""The numbers of the published method, which a person may choose; sources as in `sim.config`."""

from __future__ import annotations

import math
from typing import ClassVar

from sim.parameters import ConfigModel, MethodConfig, Number, parameter


class ImpedanceConfig(ConfigModel):
    """Virtual impedance of a hand in admittance control, times identity on (x, y, angle) (eq. 3)."""

    mass: Number = parameter(
        0.10, "Virtual mass m", unit="kg", source="Sec. IV-B, representative case", gt=1e-4, le=100, live=True
    )
    damping: Number = parameter(
        1.5, "Damping d", unit="N s/m", source="Sec. IV-B, representative case", ge=0, le=1e4, live=True
    )
    stiffness: Number = parameter(
        10.0, "Stiffness k", unit="N/m", source="Sec. IV-B, representative case", ge=0, le=1e5, live=True
    )


class TouchConfig(ConfigModel):
    """Where, how and when a hand touches the target to slow it (eq. 4, 5)."""

    contact_position: Number = parameter(
        0.75,
        "alpha: contact point on the face, 0 at its middle, 1 at its corner",
        unit="1",
        source="authors; Table II prints 0.8",
        ge=0,
        le=1,
        live=True,
    )
    hand_tilt: Number = parameter(
        math.radians(5),
        "beta: tilt of the hand beyond the target's at contact",
        unit="rad",
        source="authors; Table II prints 0.175",
        ge=0,
        le=0.7,
        live=True,
    )
    target_tilt: Number = parameter(
        math.radians(18),
        "gamma: tilt of the target's face at contact",
        unit="rad",
        source="authors; Table II prints 0.175",
        ge=0,
        le=0.7,
        live=True,
    )
    minimum_approach_time: Number = parameter(
        1.0, "Shortest time to the waiting point", unit="s", source="authors", gt=0, le=60, live=True
    )
    wait_margin: Number = parameter(
        1.03, "Waiting point: factor on the corner circle's radius", unit="1", source="authors", ge=1, le=2, live=True
    )
    contact_time_factor: Number = parameter(
        0.8,
        "Hand at the contact point after this part of the target's own time",
        unit="1",
        source="authors",
        gt=0,
        le=1,
        live=True,
    )
    absorb_time: Number = parameter(
        0.35,
        "D: from the last contact to the next plan",
        unit="s",
        source="authors: impedance duration",
        gt=0,
        le=10,
        live=True,
    )
    admittance_fraction: Number = parameter(
        0.8,
        "Part of D under admittance; joints are held for the rest",
        unit="1",
        source="authors",
        gt=0,
        le=1,
        live=True,
    )
    idle_arm_distance_factor: Number = parameter(
        1.2,
        "Idle arm shares the motion while its tips are farther than this times half the diagonal",
        unit="1",
        source="authors",
        ge=0,
        le=10,
        live=True,
    )
    idle_arm_joint_limit: Number = parameter(
        math.radians(30),
        "... and every elbow and wrist is bent by more than this",
        unit="rad",
        source="authors",
        ge=0,
        le=3.2,
        live=True,
    )


class CagingConfig(ConfigModel):
    """When and how both hands enclose the target."""

    spin_threshold: Number = parameter(
        0.5, "Detumbling ends below this spin", unit="rad/s", source="Sec. IV-A", gt=0, le=20, live=True
    )
    switching_delay: Number = parameter(
        0.5, "From spin below threshold to the caging plan", unit="s", source="authors", ge=0, le=60, live=True
    )
    slow_spin: Number = parameter(
        0.3,
        "Below it the hands turn to the target at once; above it they wait for its corner",
        unit="rad/s",
        source="authors",
        ge=0,
        le=20,
        live=True,
    )
    minimum_approach_time: Number = parameter(
        1.0, "Shortest time to the closing point", unit="s", source="authors", gt=0, le=60, live=True
    )
    close_margin: Number = parameter(
        1.03,
        "Closing point: factor on clearing the corner circle",
        unit="1",
        source="authors: wait margin",
        ge=1,
        le=2,
        live=True,
    )
    capture_margin: Number = parameter(
        1.05, "Final point: factor on touching the faces", unit="1", source="authors", ge=1, le=2, live=True
    )
    capture_time: Number = parameter(
        0.6, "From the closing to the final point", unit="s", source="authors", gt=0, le=60, live=True
    )
    direct_capture_time: Number = parameter(
        0.5, "The same in direct caging", unit="s", source="authors", gt=0, le=60, live=True
    )
    release_distance: Number = parameter(
        0.20,
        "Hand centres from the target's centre after a release",
        unit="m",
        source="chosen: the hands' distance at the start",
        gt=0,
        le=2,
        live=True,
    )
    release_time: Number = parameter(
        2.0, "Time of a release", unit="s", source="chosen: 0.05 m/s, slower than any approach", gt=0, le=60, live=True
    )


class PublishedConfig(MethodConfig):
    """Detumbling by absorbed touches, then caging (Uchida, Uno, Yoshida 2024)."""

    target_shapes: ClassVar = ("square",)
    why_these_shapes: ClassVar = "its plans wait for a square's corner to pass, every quarter turn"

    impedance: ImpedanceConfig = ImpedanceConfig()
    touch: TouchConfig = TouchConfig()
    caging: CagingConfig = CagingConfig()
