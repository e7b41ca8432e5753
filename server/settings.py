"""Where the service is, never what it flies: address, data folder, plant and the configuration it opens with."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, Self

from platformdirs import user_data_path
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.errors import ConfigError
from sim.study.cores import cores

ENVIRONMENT_PREFIX = "BECALM_"
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")

SCHEDULER_ADDRESS = r"^(tcp|tls|ws|wss)://[^\s/]+:\d+$"

TELEMETRY_RATE_LIMITS = (1.0, 60.0)
"""Snapshots a second that a client may ask for; the mission is published no faster than the upper one."""


def default_data_dir() -> Path:
    """The platform's folder for this user's data."""
    return user_data_path("becalm", appauthor=False)


class Settings(BaseModel):
    """Frozen; flags win over `BECALM_*` variables, which win over the defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    host: str = Field("127.0.0.1", min_length=1, description="Address to listen on")
    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0 takes any free one")
    data_dir: Path = Field(default_factory=default_data_dir, description="Folder of the runs")
    keep_days: float | None = Field(None, ge=0, description="Age from which on runs are removed [days]; none: never")
    keep_gb: float | None = Field(None, ge=0, description="Size of the library from which on the oldest go [GB]")
    plant: Literal["simulation"] = Field("simulation", description="What is flown")
    configuration: str = Field("published_figures", description="Named configuration that the live mission opens with")
    changes: dict[str, Any] = Field(default_factory=dict, description="Nested changes to that configuration")
    study_workers: int = Field(
        default_factory=lambda: max(1, cores() - 1),
        ge=1,
        le=1024,
        description="Processes that fly studies; one core is left to the live mission",
    )
    scheduler: str | None = Field(
        None,
        pattern=SCHEDULER_ADDRESS,
        description="Dask scheduler whose workers fly studies, tcp://HOST:8786; none: processes on this machine",
    )
    require_tokens: bool | None = Field(
        None, description="Whether a token is needed; none: beyond loopback it is, on loopback it is not"
    )
    admin_token_file: Path | None = Field(None, description="File that holds an administrator's token")
    allowed_hosts: tuple[str, ...] = Field(
        (), description="Host names that requests may use; empty: loopback's on loopback, any elsewhere"
    )

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] = os.environ, **flags: Any) -> Self:
        """Settings of the `BECALM_*` variables, and of the flags that are not None.

        Raises:
            ConfigError: a value that cannot be; the message names the setting and what would be right.

        """
        chosen: dict[str, Any] = {name: value for name, value in flags.items() if value is not None}
        for name in cls.model_fields.keys() - {"changes"}:
            text = environment.get(ENVIRONMENT_PREFIX + name.upper())
            if text and name not in chosen:
                chosen[name] = tuple(text.split(",")) if name == "allowed_hosts" else text
        try:
            return cls(**chosen)
        except ValidationError as error:
            raise ConfigError(_explained(error), tip="becalm serve --help lists every setting") from None

    def initial_config(self) -> MissionConfig:
        """The configuration that the live mission opens with.

        Raises:
            ConfigError: no configuration has that name, or the changes do not fit it.

        """
        return revised(named_configuration(self.configuration), self.changes)

    @property
    def tokens_required(self) -> bool:
        """Whether a token is needed."""
        return self.host not in LOOPBACK_NAMES if self.require_tokens is None else self.require_tokens

    def own_hosts(self) -> tuple[str, ...]:
        """The host names that a request may be addressed to; empty for any."""
        if self.allowed_hosts:
            return (*self.allowed_hosts, *LOOPBACK_NAMES)
        return LOOPBACK_NAMES if self.host in LOOPBACK_NAMES else ()


def _explained(error: ValidationError) -> str:
    findings = error.errors(include_url=False)
    return "; ".join(f"{'.'.join(map(str, each['loc']))} = {each['input']!r}: {each['msg']}" for each in findings)
