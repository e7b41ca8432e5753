"""`/mission/config` and `/configurations`: what is flown, what may be changed, and between which bounds."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Annotated, Any, Literal

import annotated_types
from fastapi import APIRouter, Body, Header, Response
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from server.api.mission import answered
from server.api.parameter_titles import group_title, parameter_title
from server.api.services import AskerDep, PatienceDep, Services, ServicesDep
from server.edge.etags import IfNoneMatch, known_or_new, tagged
from server.edge.problem_json import responses
from server.edge.values import Changes
from server.errors import ConfigOutdated
from server.mission.inbox import Request, Revision, arguments_of
from sim.config import PARAMETERS, MissionConfig, differences, is_live, value_at
from sim.configurations import NAMED_CONFIGURATIONS, named_configuration, revised
from sim.method.method import method_named
from sim.method.registry import MethodName
from sim.parameters import FARTHEST, Points

ATTEMPTS = 5
"""How often a change is checked again because others changed parameters meanwhile."""

_one_thread = ThreadPoolExecutor(1, "becalm-parameters")
"""Checks one change at a time: more would only take Python from one another, and from all else."""

METHOD = "method"
"""The parameter that names the method."""

router = APIRouter(tags=["configuration"])

DESCRIPTIONS = {
    "published": "The constants that reproduce the paper's tables; m 0.10, d 1.5, k 10",
    "as_printed": "The constants as the paper's Tables I and II print them",
    "published_figures": "The impedance that fits the paper's figures: five soft touches, m 0.2, d 0.1, k 0.1",
    "testbed": "The air-bearing robot of the experiment: 200 Hz, its PID gains, rigid hands; m 0.1, d 6, k 50",
    "becalm": "Our own method: both hands brake the target as a couple that moves with its faces; noisy sensors",
    "testbed_becalm": "Our own method on the air-bearing robot: 200 Hz, rigid hands, motion capture 10 ms late",
}


class Edit(BaseModel):
    """A parameter that differs from the named configuration."""

    model_config = ConfigDict(populate_by_name=True)

    from_: Any = Field(alias="from", description="Its value in the named configuration")
    to: Any = Field(description="Its value now")


class ConfigBody(BaseModel):
    """The configuration in force."""

    name: str = Field(examples=["published_figures (edited)"])
    config: MissionConfig
    edited: dict[str, Edit] = Field(
        description="By full path", examples=[{"published.impedance.damping": {"from": 0.1, "to": 3.0}}]
    )


class ConfigurationBody(BaseModel):
    """A named configuration."""

    name: str
    description: str
    config: MissionConfig


class Parameter(BaseModel):
    """One number, choice or list of points of the configuration."""

    path: str = Field(examples=["published.impedance.damping"])
    group: str = Field(examples=["published.impedance"])
    name: str = Field(examples=["damping"])
    title: str = Field(description="Of what it is, in a few words", examples=["Virtual damping of the hand"])
    group_title: str = Field(description="Heading of its group", examples=["Impedance of the hands"])
    type: Literal["number", "integer", "choice", "points"]
    description: str
    unit: str = Field(description="SI; 1 if it has none", examples=["N s/m"])
    default: float | int | str | Points
    minimum: float | None = Field(None, description="Of points, that of each coordinate; so are the other two")
    exclusive_minimum: float | None = None
    maximum: float | None = None
    fewest: int | None = Field(None, description="Points that the list has at least")
    most: int | None = Field(None, description="Points that it has at most")
    choices: list[str] | None = None
    choice_titles: dict[str, str] = Field(
        {}, description="Of choices whose name does not say what they are: what each is, in a few words"
    )
    source: str = Field(description="Where the default comes from", examples=["Sec. IV-B, representative case"])
    live: bool = Field(description="May change while a mission flies")


class ParameterSchema(BaseModel):
    """Every parameter, flat for a form and as JSON schema for a validator."""

    parameters: list[Parameter]
    json_schema: dict[str, Any]


@router.get("/mission/config", responses=responses(422))
async def config(services: ServicesDep, response: Response, if_none_match: IfNoneMatch = None) -> ConfigBody:
    """The configuration in force, and how it differs from the named one it began as."""
    return tagged(_body(services), response, if_none_match)


@router.patch("/mission/config", responses=responses(409, 422, 503, 504))
async def change_config(
    services: ServicesDep,
    asker: AskerDep,
    patience: PatienceDep,
    changes: Annotated[
        Changes,
        Body(description="Nested, only what changes", examples=[{"published": {"impedance": {"damping": 3.0}}}]),
    ],
    becalm_arming: Annotated[
        str | None,
        Header(
            max_length=100,
            description="Token of `POST /mission/arming`; changes that take the robot again need one",
        ),
    ] = None,
) -> ConfigBody:
    """Change parameters, all or none: live ones from the next tick on, others only while nothing is under way."""
    await patience.until_ready()
    loop = asyncio.get_running_loop()
    for attempt in range(1, ATTEMPTS + 1):
        before = services.loop.view.config
        # Here, not by the mission thread: what is asked may be anything, and takes its time to be refused.
        after = await loop.run_in_executor(_one_thread, revised, before, changes)
        try:
            revision = Revision(before, after)
            await answered(
                services,
                Request(
                    "configure",
                    who=asker,
                    revision=revision,
                    arguments=arguments_of(changes=changes),
                    arming=becalm_arming,
                ),
            )
            break
        except ConfigOutdated:
            if attempt == ATTEMPTS:
                raise
    return _body(services)


@router.get("/mission/config/schema", response_model=ParameterSchema, responses=responses(422))
async def config_schema(if_none_match: IfNoneMatch = None) -> Response:
    """Every parameter with unit, bounds, default and source."""
    return known_or_new(_schema(), if_none_match)


@cache
def _schema() -> bytes:
    parameters = [_parameter(path) for path in PARAMETERS]
    schema = ParameterSchema(parameters=parameters, json_schema=MissionConfig.model_json_schema())
    return schema.model_dump_json().encode()


@router.get("/configurations", response_model=list[ConfigurationBody], responses=responses(422))
async def configurations(if_none_match: IfNoneMatch = None) -> Response:
    """The named configurations."""
    return known_or_new(_configurations(), if_none_match)


@cache
def _configurations() -> bytes:
    named = [
        ConfigurationBody(name=name, description=DESCRIPTIONS[name], config=config)
        for name, config in NAMED_CONFIGURATIONS.items()
    ]
    return TypeAdapter(list[ConfigurationBody]).dump_json(named)


def _body(services: Services) -> ConfigBody:
    view = services.loop.view
    edited = differences(named_configuration(view.configuration), view.config)
    edits = {path: Edit(from_=old, to=new) for path, (old, new) in edited.items()}
    return ConfigBody(name=view.name, config=view.config, edited=edits)


def _parameter(path: str) -> Parameter:
    field = PARAMETERS[path]
    group, _, name = path.rpartition(".")
    kind: Any = field.annotation
    return Parameter(
        path=path,
        group=group,
        name=name,
        title=parameter_title(path),
        group_title=group_title(group),
        type=_TYPES.get(kind, "choice"),
        description=field.description,
        unit=field.json_schema_extra["unit"],
        default=value_at(MissionConfig(), path),
        choices=None if kind in _TYPES else [each.value for each in kind],
        choice_titles={each.value: method_named(each).title for each in MethodName} if path == METHOD else {},
        source=field.json_schema_extra["source"],
        live=is_live(path),
        **({"minimum": -FARTHEST, "maximum": FARTHEST} if kind == Points else {}),
        **_bounds(field.metadata),
    )


_TYPES: Mapping[Any, Literal["number", "integer", "points"]] = {float: "number", int: "integer", Points: "points"}
"""Of every parameter that is no choice."""


def _bounds(constraints: list[Any]) -> dict[str, Any]:
    bounds: dict[str, Any] = {}
    for constraint in constraints:
        if isinstance(constraint, annotated_types.Ge):
            bounds["minimum"] = float(constraint.ge)  # type: ignore[arg-type]
        elif isinstance(constraint, annotated_types.Gt):
            bounds["exclusive_minimum"] = float(constraint.gt)  # type: ignore[arg-type]
        elif isinstance(constraint, annotated_types.Le):
            bounds["maximum"] = float(constraint.le)  # type: ignore[arg-type]
        elif isinstance(constraint, annotated_types.MinLen):
            bounds["fewest"] = constraint.min_length
        elif isinstance(constraint, annotated_types.MaxLen):
            bounds["most"] = constraint.max_length
    return bounds
