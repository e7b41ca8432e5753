"""Where the service is, never what it flies: address, data folder, plant and the configuration it opens with.

Each has one name: `data_dir` in a settings file, `BECALM_DATA_DIR` in the environment, `--data-dir` as an option.
Options win over the environment, which wins over the file, which wins over the defaults.
"""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

from platformdirs import user_data_path
from pydantic import Field, ValidationError, field_validator, model_validator
from pydantic_settings import (
    BaseSettings,
    EnvSettingsSource,
    InitSettingsSource,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
)

from server.edge.authority import LOOPBACK_NAMES, host_name
from server.link.bounds import Bounds, ListedBounds, ListedFrame, WristFrame
from sim.config import MissionConfig
from sim.configurations import DEFAULT_CONFIGURATION, named_configuration, read_config_file, revised
from sim.errors import ConfigError
from sim.schema_history import Read
from sim.stored import in_file
from sim.study.cores import cores

ENVIRONMENT_PREFIX = "BECALM_"
SETTINGS_FILE = "BECALM_SETTINGS"
"""The variable that names a settings file."""

REMOVED: Mapping[str, str] = {
    "contact_threshold": "it is the parameter perception.contact_threshold now, set by --set, --config or [changes]",
}
"""Settings of earlier versions, and what holds instead."""

ROBOT_CONFIGURATION = "testbed_becalm"
"""What a mission with a robot opens with, unless another is chosen."""

LogLevel = Literal["debug", "info", "warning", "error"]

SCHEDULER_ADDRESS = r"^(tcp|tls|ws|wss)://[^\s/]+:\d+$"

TELEMETRY_RATE_LIMITS = (1.0, 60.0)
"""Snapshots a second that a client may ask for; the mission is published no faster than the upper one."""


def default_data_dir() -> Path:
    """The platform's folder for this user's data.

    Raises:
        ConfigError: this user has no home.

    """
    try:
        return user_data_path("becalm", appauthor=False)
    except RuntimeError:
        what = "data_dir: this user has no home, and so no folder for data"
        raise ConfigError(what, tip="name one with BECALM_DATA_DIR or --data-dir") from None


class Settings(BaseSettings):
    """Frozen; see the module for which source wins."""

    # Lists are written with commas, not as JSON: the validators below read them.
    model_config = SettingsConfigDict(frozen=True, extra="forbid", env_prefix=ENVIRONMENT_PREFIX, enable_decoding=False)

    @classmethod
    def settings_customise_sources(cls, *_: Any, **sources: Any) -> tuple[PydanticBaseSettingsSource, ...]:
        """What is given, and nothing else; `choose` reads environment and file, too."""
        return (sources["init_settings"],)

    host: str = Field("127.0.0.1", min_length=1, description="Address to listen on")
    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0 takes any free one")
    data_dir: Path = Field(default_factory=default_data_dir, description="Folder of the runs")
    keep_days: float | None = Field(None, ge=0, description="Age from which on runs are removed [days]; none: never")
    keep_gb: float | None = Field(None, ge=0, description="Size of the library from which on the oldest go [GB]")
    min_free_gb: float = Field(
        1.0,
        ge=0,
        description="Free space below which the operator is warned and no further run or study is queued [GB]",
    )
    log_topic_rate: float | None = Field(
        None,
        ge=1,
        le=1e5,
        description="Most messages a second of each topic of a log beside /becalm/tick, which has every tick; none:"
        " joint states and wrenches at every tick, transforms and poses at every 16th",
    )
    plant: Literal["simulation", "zenoh"] = Field(
        "simulation", description="What is flown; zenoh: the robot at the other end of --connect or --link-listen"
    )
    connect: tuple[str, ...] = Field((), description="Endpoints of the robot or its router, tcp/HOST:PORT, tls/...")
    link_listen: tuple[str, ...] = Field((), description="Endpoints to listen on for the robot")
    link_deadline: float = Field(0.1, ge=0.02, le=10, description="Age at which the robot's streams are late [s]")
    link_detect_freeze: bool = Field(True, description="Whether a sensor that repeats itself counts as frozen")
    link_robot: str | None = Field(None, description="Name of the robot that is flown; none: the first that is heard")
    link_world_frame: str = Field("world", description="Frame in which poses and twists must come")
    link_left_wrist: ListedFrame = Field(
        WristFrame(frame="left_hand"),
        description="Frame of the left wrist's sensor, in the hand's: frame=NAME,angle=RAD,x=M,y=M,sign=1 or -1",
    )
    link_right_wrist: ListedFrame = Field(
        WristFrame(frame="right_hand"), description="Frame of the right wrist's sensor, likewise"
    )
    link_bounds: ListedBounds = Field(
        Bounds(), description="What a reading of the robot's may be: force=N,tilt=RAD and others (docs/link.md)"
    )
    link_user: str | None = Field(None, description="Name by which the robot's end knows the console")
    link_password_file: Path | None = Field(None, description="File that holds that user's password")
    link_tls_ca: Path | None = Field(None, description="Authorities that the robot's certificate is checked by")
    link_tls_certificate: Path | None = Field(None, description="The console's certificate for the link")
    link_tls_key: Path | None = Field(None, description="Its private key")
    realtime: bool = Field(False, description="Whether the system runs this process before others (Linux, if it may)")
    configuration: str = Field(
        DEFAULT_CONFIGURATION,
        description="Named configuration that the live mission opens with; with a robot testbed_becalm, unless given",
    )
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
    go_odds: float = Field(
        0.9, ge=0, le=1, description="Part of the futures that must end in a cage, for go before the next request"
    )
    go_peak_force: float | None = Field(
        None, gt=0, description="Force that 95 % of those futures must stay below [N]; none: any"
    )
    prepare_rehearsals: bool = Field(
        True,
        description="Whether the worker of rehearsals starts with the service, not with the first page that opens: it"
        " takes 0.3 GB, for five minutes where nobody asks",
    )
    require_tokens: bool | None = Field(
        None, description="Whether a token is needed; none: beyond loopback it is, on loopback it is not"
    )
    admin_token_file: Path | None = Field(None, description="File that holds an administrator's token")
    allowed_hosts: tuple[str, ...] = Field(
        (), description="Host names that requests may use; empty: loopback's on loopback, any elsewhere"
    )

    trusted_proxies: tuple[str, ...] = Field(
        (),
        description="Addresses or networks of reverse proxies that are believed where a request comes from"
        " (X-Forwarded-For, X-Forwarded-Proto); none: nobody is",
    )

    log_format: Literal["text", "json"] = Field("text", description="Of the service's log, on standard error")
    log_level: LogLevel = Field("warning", description="The least severe lines of the service's log")

    @field_validator("allowed_hosts", "trusted_proxies", "connect", "link_listen", mode="before")
    @classmethod
    def _listed(cls, names: object) -> object:
        """Names separated by commas are a list."""
        return tuple(name.strip() for name in names.split(",") if name.strip()) if isinstance(names, str) else names

    @field_validator("allowed_hosts")
    @classmethod
    def _hosts_are_names(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        """As requests name them: in lower case, without a final dot."""
        hosts = {name: host_name(name) for name in names}
        if strange := [name for name, host in hosts.items() if host is None]:
            raise ValueError(f"{strange[0]!r} is no host name; write it without scheme, port and path")
        return tuple(host for host in hosts.values() if host is not None)

    @field_validator("trusted_proxies")
    @classmethod
    def _proxies_are_addresses(cls, proxies: tuple[str, ...]) -> tuple[str, ...]:
        for proxy in proxies:
            ipaddress.ip_network(proxy)
        return proxies

    @model_validator(mode="before")
    @classmethod
    def _opens_with_what_the_plant_can_fly(cls, values: Any) -> Any:
        if isinstance(values, dict) and values.get("plant") == "zenoh" and not values.get("configuration"):
            return {**values, "configuration": ROBOT_CONFIGURATION}
        return values

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] = os.environ, **flags: Any) -> Settings:
        """The settings that `choose` makes of the same.

        Raises:
            ConfigError: as `choose`.

        """
        return choose(environment, **flags).settings

    def initial_config(self) -> MissionConfig:
        """The configuration that the live mission opens with.

        Raises:
            ConfigError: no configuration has that name, or the changes do not fit it.

        """
        named = named_configuration(self.configuration)
        # As it is, it is known to be possible; to look at it loads compiled code, for which the first page would wait.
        return revised(named, self.changes) if self.changes else named

    @property
    def tokens_required(self) -> bool:
        """Whether a token is needed."""
        return self.host not in LOOPBACK_NAMES if self.require_tokens is None else self.require_tokens

    def own_hosts(self) -> tuple[str, ...]:
        """The host names that a request may be addressed to; empty for any."""
        if self.allowed_hosts:
            return (*self.allowed_hosts, *LOOPBACK_NAMES)
        return LOOPBACK_NAMES if self.host in LOOPBACK_NAMES else ()


class Chosen(NamedTuple):
    """Settings, and where each comes from."""

    settings: Settings
    sources: dict[str, str]
    """By name: the option, the variable or the file that says so; what no source names is a default."""
    notices: tuple[str, ...] = ()
    """What is ignored of the changes in a settings file of an earlier version, and why."""


def choose(environment: Mapping[str, str], file: Path | None = None, **flags: Any) -> Chosen:
    """Settings of a file, of the `BECALM_*` variables and of the options that are not None; the last of them wins.

    Args:
        environment: read for `BECALM_*`.
        file: TOML or JSON; without one, that of `BECALM_SETTINGS`, if there is any.
        flags: by the name of the setting; `changes` add to those of the file.

    Raises:
        ConfigError: an invalid value, or a setting that was removed; the message names the setting, where it stands
            and what would be right.

    """
    layers, notices = _layers(environment, file, flags)
    sources = {name: layer.where(name) for layer in layers for name in layer.source()}
    _refuse_removed(environment, sources)

    class Layered(Settings):
        @classmethod
        def settings_customise_sources(cls, *_: Any, **__: Any) -> tuple[PydanticBaseSettingsSource, ...]:
            return tuple(layer.source for layer in reversed(layers))

    try:
        return Chosen(Layered(), sources, notices)
    except ValidationError as error:
        raise ConfigError(_explained(error, sources), tip="becalm serve --help lists every setting") from None


class _Layer(NamedTuple):
    """Settings of one kind of source."""

    source: PydanticBaseSettingsSource
    where: Callable[[str], str]
    """What a person calls the place where the setting of that name stands."""


def _layers(
    environment: Mapping[str, str], file: Path | None, flags: Mapping[str, Any]
) -> tuple[list[_Layer], tuple[str, ...]]:
    """What each source says, the weakest first; and what is ignored of the file."""
    variables = EnvSettingsSource(Settings)
    variables.env_vars = {name.lower(): text for name, text in environment.items() if text}
    given = {name: value for name, value in flags.items() if value not in (None, {})}
    layers = [
        _Layer(variables, _variable),
        _Layer(InitSettingsSource(Settings, given), lambda name: "--" + name.replace("_", "-")),
    ]
    named = file or environment.get(SETTINGS_FILE)
    if not named:
        return layers, ()
    read = _settings_file(Path(named))
    return [_Layer(InitSettingsSource(Settings, read.values), lambda _: str(named)), *layers], read.notices


def _settings_file(path: Path) -> Read:
    """The settings in a file, with its changes to parameters under the names of today."""
    settings = read_config_file(path, "settings file")
    if not isinstance(settings.get("changes"), dict):
        return Read(settings, ())
    changes = in_file(path, settings["changes"], "settings file")
    return Read({**settings, "changes": changes.values}, changes.notices)


def _refuse_removed(environment: Mapping[str, str], sources: Mapping[str, str]) -> None:
    """Refuse a setting of an earlier version: to ignore it would change what is flown.

    Raises:
        ConfigError: the message says where it stands, and what holds instead.

    """
    for name, instead in REMOVED.items():
        where = _variable(name) if environment.get(_variable(name)) else sources.get(name)
        if where is not None:
            raise ConfigError(f"{name} is no longer a setting ({where}): {instead}", tip="write it there instead")


def _variable(name: str) -> str:
    return ENVIRONMENT_PREFIX + name.upper()


def _explained(error: ValidationError, sources: Mapping[str, str]) -> str:
    return "; ".join(_finding(each, sources) for each in error.errors(include_url=False))


def _finding(each: Any, sources: Mapping[str, str]) -> str:
    field = ".".join(map(str, each["loc"]))
    return f"{field} = {each['input']!r}: {each['msg']} ({sources[each['loc'][0]]})"
