"""What people type on the command line: numbers, and `PATH=VALUE`.

Numbers are read by the grammar of the console's fields (`web/src/units/numbers.ts`); `numbers.cases.json` beside that
file holds both to it. The decimal sign is a point; where a comma could be one or stand between thousands, nothing is
guessed.
"""

from __future__ import annotations

import math
import re
from enum import StrEnum
from typing import Any

import click

from sim.config import PARAMETERS
from sim.configurations import bracketed_unit, nested, unknown_parameter
from sim.errors import ConfigError
from sim.parameters import Points

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?", re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?[0-9]+")
_NEEDLESS_ZERO = re.compile(r"^([+-]?)0+(?=[0-9])")
_NOT_FINITE = re.compile(r"[+-]?(inf|infinity|nan)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(e[+-]?[0-9]+)?", re.IGNORECASE)
_ONE_GROUP = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")
_ENGLISH_THOUSANDS = re.compile(r"[+-]?[0-9]{1,3}(,[0-9]{3})+(\.[0-9]*)?")
_GERMAN_THOUSANDS = re.compile(r"[+-]?[0-9]{1,3}(\.[0-9]{3})+,[0-9]+")

_MINUS_SIGNS = "\u2010\u2011\u2012\u2013\u2014\u2212\ufe63\uff0d"
_PLAIN = {
    **dict.fromkeys(map(ord, _MINUS_SIGNS), "-"),
    **{0xFF10 + digit: str(digit) for digit in range(10)},
    **{ord(wide): plain for wide, plain in zip("\uff0b\uff0e\uff0c\uff45\uff25", "+.,ee", strict=True)},
}
"""What other keyboards and typesetting make of the characters of a number."""

_POINT = "the decimal sign is a point"
_THOUSANDS = "nothing separates thousands"


def read_number(typed: str) -> float | int:
    """One number; a whole one if it is written without point and exponent.

    Raises:
        ConfigError: it is not a number; the message says what to write instead.

    """
    text = typed.translate(_PLAIN).strip()
    if not text:
        raise ConfigError("a number is missing")
    if _NOT_FINITE.fullmatch(text):
        raise ConfigError(f'"{text}" is not a finite number')
    if not _NUMBER.fullmatch(text):
        raise ConfigError(_about_commas(text) or f'"{text}" is not a number; write it as 5, 0.5 or 5e-1')
    if _NEEDLESS_ZERO.search(text):
        shorter = _NEEDLESS_ZERO.sub(r"\1", text)
        raise ConfigError(f"write {shorter}, without the zero in front")
    if _WHOLE.fullmatch(text):
        return int(text)
    value = float(text)
    if math.isinf(value):
        raise ConfigError(f'"{text}" is too large')
    if value == 0.0 and re.search("[1-9]", text.lower().partition("e")[0]):
        raise ConfigError(f'"{text}" is too close to zero')
    return value


def _about_commas(text: str) -> str | None:
    """What is wrong with commas in a text that is meant as one number; None if nothing is."""
    if _GERMAN_THOUSANDS.fullmatch(text):
        return f"write {text.replace('.', '').replace(',', '.')}: {_POINT}, and {_THOUSANDS}"
    if _ONE_GROUP.fullmatch(text):
        return f"write {text.replace(',', '')} or {text.replace(',', '.')}: {_POINT}, and {_THOUSANDS}"
    if _DECIMAL_COMMA.fullmatch(text):
        pointed = re.sub(r"^([+-]?)[.]", r"\g<1>0.", text.replace(",", "."))
        return f"write {pointed}: {_POINT}"
    if _ENGLISH_THOUSANDS.fullmatch(text):
        return f"write {text.replace(',', '')}: {_THOUSANDS}"
    return None


def read_points(typed: str) -> list[list[float]]:
    """Points, written as `0, 0; 0.2, 0; 0, 0.1`, one a line, or in the brackets of JSON.

    Raises:
        ConfigError: one of them is none; the message names it, counted from 1.

    """
    text = typed.translate(_PLAIN).strip()
    if text.startswith("["):
        text = re.sub(r"[\[\]]", " ", re.sub(r"\]\s*,\s*\[", ";", text))
    written = [point for point in map(str.strip, re.split("[;\n]", text)) if point]
    if not written:
        raise ConfigError("points are missing; write them as 0, 0; 0.2, 0; 0, 0.1")
    return [_read_point(place, point) for place, point in enumerate(written, 1)]


def _read_point(place: int, written: str) -> list[float]:
    parts = re.split(r"\s*,\s*|\s+", written)
    if len(parts) != 2:
        raise ConfigError(f'point {place}, "{written}", is not two numbers; write x and y, such as 0.2, 0.1')
    try:
        return [float(read_number(part)) for part in parts]
    except ConfigError as error:
        raise ConfigError(f"point {place}: {error}") from None


def parse_setting(setting: str) -> dict[str, Any]:
    """`PATH=VALUE`, as `--set` takes it, to the nested mapping of one change.

    Raises:
        ConfigError: no equals sign, an unknown path, or no number where one belongs.

    """
    path, equals, text = setting.partition("=")
    path = path.strip()
    if not equals:
        raise ConfigError(f"--set {setting!r} has no value; write PATH=VALUE, such as published.impedance.damping=3.0")
    if path not in PARAMETERS:
        raise ConfigError(f"--set {unknown_parameter(path)}")
    return nested({path: _value(path, text)})


def _value(path: str, text: str) -> float | int | str | list[list[float]]:
    """The text as that parameter takes it."""
    kind: Any = PARAMETERS[path].annotation
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return text.strip().strip("\"'")
    try:
        if kind == Points:
            return read_points(text)
        value = read_number(text)
    except ConfigError as error:
        raise ConfigError(f"--set {path} = {text!r}: {error}{bracketed_unit(path)}") from None
    return int(value) if kind is int and value == int(value) else value


def number_option(typed: str | float) -> float:
    """The value of an option that is a number, as people type it.

    Raises:
        click.BadParameter: it is not a number; the message says what to write instead.

    """
    try:
        return float(read_number(typed)) if isinstance(typed, str) else typed
    except ConfigError as error:
        raise click.BadParameter(f"{typed!r}: {error}") from None
