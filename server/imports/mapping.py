"""The map of a foreign log: which of its columns or topics is what, in which unit."""

from __future__ import annotations

import tomllib
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.errors import ConfigError

Source = Annotated[str, Field(min_length=1, max_length=300)]
"""In CSV the name of a column; in MCAP `TOPIC:PATH`, such as `/joints:position[left_1]` or `/base:pose.position.x`."""
Three = Annotated[list[Source], Field(min_length=3, max_length=3)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class TimeMap(_Part):
    """When."""

    source: Source | None = Field(None, description="Of CSV; of MCAP, which has times, only to take a message's stamp")
    unit: Literal["s", "ms", "us", "ns"] = "s"


class JointMap(_Part):
    """Three numbers for each arm, from the shoulder on."""

    left: Three
    right: Three
    unit: Literal["rad", "deg"] | None = Field(None, description="Of the angle, or of it a second; say it if asked")


class PoseMap(_Part):
    """A planar pose in the world."""

    x: Source
    y: Source
    angle: Source | None = None
    quaternion: Source | None = Field(None, description="In place of `angle`: x, y, z, w, about the vertical")
    unit: Literal["m", "mm"] | None = Field(None, description="Of x and y; say it if asked")
    angle_unit: Literal["rad", "deg"] | None = Field(None, description="Say it if asked")

    @model_validator(mode="after")
    def _has_one_angle(self) -> Self:
        if (self.angle is None) == (self.quaternion is None):
            raise ValueError("name either angle or quaternion")
        return self


class WrenchMap(_Part):
    """What a wrist reads."""

    x: Source
    y: Source
    torque: Source
    frame: Literal["hand", "world"] = "hand"
    acts_on: Literal["hand", "target"] = "hand"


class LogMap(_Part):
    """All of a log."""

    configuration: str = Field("testbed", description="Named configuration of robot and target")
    changes: dict[str, Any] = Field(default_factory=dict, description="Nested, to that configuration")
    time: TimeMap = TimeMap()
    joint_angle: JointMap
    commanded_joint_rate: JointMap | None = None
    base_pose: PoseMap
    target_pose: PoseMap
    left_wrench: WrenchMap | None = None
    right_wrench: WrenchMap | None = None

    def config(self) -> MissionConfig:
        """What the log's robot and target are.

        Raises:
            ConfigError: there is no such configuration, or a change of it is invalid.

        """
        return revised(named_configuration(self.configuration), self.changes)


def log_map(text: str) -> LogMap:
    """The map in a TOML text.

    Raises:
        ConfigError: it is no TOML, or something in it is missing, unknown or of another kind; the message names it.

    """
    try:
        return LogMap.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"map: {error}") from None
    except ValidationError as error:
        found = [f"map: {'.'.join(map(str, each['loc']))}: {each['msg']}" for each in error.errors(include_url=False)]
        raise ConfigError("; ".join(found[:6]), tip="docs/fit.md shows a whole map") from None
