"""The options of `becalm serve`: one for each setting, drawn from the settings themselves."""

from __future__ import annotations

import types
from typing import Any, Literal, Union, get_args, get_origin

import click
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from server.settings import Settings


def setting_options(command: Any) -> Any:
    """Give a command an option for every setting; one that is not given is None."""
    for name, field in reversed(Settings.model_fields.items()):
        if name != "changes":
            command = _option(name, field)(command)
    return command


def _option(name: str, field: FieldInfo) -> Any:
    dashed = name.replace("_", "-")
    kinds = _alternatives(field.annotation)
    described = f"{field.description}.{_default(field)}"
    if bool in kinds:
        return click.option(f"--{dashed}/--no-{dashed}", name, default=None, help=described)
    return click.option(f"--{dashed}", name, metavar=_metavar(name, kinds), help=described)


def _metavar(name: str, kinds: tuple[Any, ...]) -> str:
    """What stands for the value in the help: its choices, or what it is."""
    if get_origin(kinds[0]) is Literal:
        return "|".join(get_args(kinds[0]))
    return {int: "N", float: "X"}.get(kinds[0], name.rsplit("_", 1)[-1].upper())


def _alternatives(annotation: Any) -> tuple[Any, ...]:
    """The types that a setting may have, without None."""
    if get_origin(annotation) in (Union, types.UnionType):
        return tuple(each for each in get_args(annotation) if each is not type(None))
    return (annotation,)


def _default(field: FieldInfo) -> str:
    if field.default is PydanticUndefined or field.default in (None, ()):
        return ""
    return f"  [default: {field.default}]"
