"""What a reading of the robot's may be, and the frame of a wrist's sensor: chosen by the lab, with units."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator

from sim.compiled import FloatArray


def _listed(value: object) -> object:
    """NAME=VALUE, separated by commas, is a table."""
    if not isinstance(value, str):
        return value
    return {name.strip(): number.strip() for name, _, number in (each.partition("=") for each in value.split(","))}


def _bound(default: float, words: str, *, le: float) -> Any:
    return Field(default, gt=0, le=le, allow_inf_nan=False, description=words)


class Bounds(BaseModel):
    """Beyond them a reading is refused; a jump of a wrist ends the mission."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    force: float = _bound(50.0, "Range of a wrist's sensor, each axis [N]", le=1e5)
    torque: float = _bound(5.0, "Range of a wrist's sensor, each axis [N m]", le=1e5)
    force_jump: float = _bound(10.0, "Change of a wrist's force from one reading to the next [N]", le=1e5)
    torque_jump: float = _bound(0.2, "Change of a wrist's torque from one reading to the next [N m]", le=1e5)
    joint_angle: float = _bound(2.0 * math.pi, "Of a joint, either way [rad]", le=1e3)
    joint_rate: float = _bound(20.0, "Of a joint, either way [rad/s]", le=1e3)
    position: float = _bound(5.0, "Of a body from the world's origin, each axis [m]", le=1e4)
    speed: float = _bound(3.0, "Of a body [m/s]", le=1e3)
    spin: float = _bound(30.0, "Of a body [rad/s]", le=1e3)
    height: float = _bound(0.05, "Of a body over or under the plane [m]", le=1e3)
    tilt: float = _bound(0.05, "Of a body against the plane [rad]", le=math.pi)
    vertical_speed: float = _bound(0.2, "Of a body out of the plane [m/s]", le=1e3)
    tumble: float = _bound(0.5, "Spin of a body about an axis in the plane [rad/s]", le=1e3)
    ahead: float = _bound(0.02, "How far a stamp may be in the future by the robot's clock [s]", le=10)


class WristFrame(BaseModel):
    """In which axes a wrist's wrench comes, and how they lie in the hand's."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    frame: str = Field(min_length=1, max_length=200, description="Name in header.frame_id")
    angle: float = Field(0.0, ge=-7, le=7, allow_inf_nan=False, description="Of its axes in the hand's [rad]")
    x: float = Field(0.0, ge=-1, le=1, allow_inf_nan=False, description="Its origin, hand's axes, from its centre [m]")
    y: float = Field(0.0, ge=-1, le=1, allow_inf_nan=False, description="Likewise [m]")
    sign: Literal[1, -1] = Field(1, description="1: the wrench of target on hand; -1: of hand on target")

    @field_validator("sign", mode="before")
    @classmethod
    def _whole(cls, sign: object) -> object:
        """A text of an option or a variable is a number."""
        return {"1": 1, "+1": 1, "-1": -1}.get(sign, sign) if isinstance(sign, str) else sign

    def __str__(self) -> str:
        """As an option says it."""
        return f"frame={self.frame}"

    def in_hand(self, wrench: FloatArray) -> FloatArray:
        """A measured wrench, as target on hand about the hand's centre in the hand's axes, shape (3,)."""
        fx, fy, torque = self.sign * wrench
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        x, y = cosine * fx - sine * fy, sine * fx + cosine * fy
        return np.array([x, y, torque + self.x * y - self.y * x])


ListedBounds = Annotated[Bounds, BeforeValidator(_listed)]
"""A table, or a text: force=100,tilt=0.1."""
ListedFrame = Annotated[WristFrame, BeforeValidator(_listed)]
"""A table, or a text: frame=left_sensor,angle=3.1416,x=0,y=0.02,sign=-1."""
