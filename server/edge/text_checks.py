"""What a request may be written in: text that can be stored and shown, JSON that means one thing.

One check in front of every operation, so that no field of any of them has to think of it: of bodies, queries, paths and
headers. It finds what JSON and percent-encoding can say and no text can hold, and names the field.
"""

from __future__ import annotations

import json
import math
from typing import Any, NamedTuple
from urllib.parse import unquote_to_bytes

from starlette.types import Scope

from server.texts import shortened

LONGEST_TEXT = 10_000
"""Characters of any text of a body; its field may allow fewer."""

LONGEST_NAME = 200
"""Characters of a name in a body."""

LONGEST_IN_ADDRESS = 2_000
"""Bytes of a value in a query, and of a path, as they are encoded."""

DEEPEST = 40
"""Levels of a body; a study's definition has six."""

MOST_VALUES = 50_000
"""Values in a body."""

LARGEST_INTEGER = 2**63 - 1

PLAIN_HEADERS = (b"idempotency-key", b"if-match", b"if-none-match")
"""Headers that are compared or kept."""


class Fault(NamedTuple):
    """What cannot be, and where."""

    field: str
    message: str


class _InvalidValue(NamedTuple):
    """Stands for a value that JSON's grammar or its numbers do not allow."""

    message: str


def fault_of_address(scope: Scope) -> Fault | None:
    """What cannot be in the path, the query or the headers of a request."""
    path = scope.get("raw_path") or b""
    if (why := _encoded_fault(path)) is not None:
        return Fault("path", why)
    for part in scope.get("query_string", b"").split(b"&"):
        name, _, value = part.partition(b"=")
        for text in (name, value):
            if (why := _encoded_fault(text)) is not None:
                return Fault(shortened(unquote_to_bytes(name).decode(errors="replace")), why)
    for name, value in scope["headers"]:
        if name in PLAIN_HEADERS and not (value.isascii() and value.decode().isprintable()):
            return Fault(name.decode(), "write it in printable ASCII")
    return None


def fault_of_body(body: bytes) -> Fault | None:
    """What cannot be in a JSON body, the first that is found."""
    try:
        parsed = json.loads(
            body.decode("utf-8-sig"),
            object_pairs_hook=_object,
            parse_constant=lambda name: _InvalidValue(f"{name} is no number of JSON"),
            parse_float=_number,
            parse_int=_integer,
        )
    except UnicodeDecodeError:
        return Fault("", "the body is not UTF-8")
    except RecursionError:
        return Fault("", f"the body is nested more than {DEEPEST} levels deep")
    except ValueError:
        return None  # no JSON at all: the operation says where it ends
    return _fault_within(parsed)


def _fault_within(parsed: Any) -> Fault | None:
    waiting: list[tuple[Any, tuple[Any, ...], int]] = [(parsed, (), 0)]
    seen = 0
    while waiting:
        value, path, depth = waiting.pop()
        seen += 1
        if seen > MOST_VALUES:
            return Fault("", f"the body holds more than {MOST_VALUES} values")
        if depth > DEEPEST:
            return Fault("", f"the body is nested more than {DEEPEST} levels deep")
        if (why := _value_fault(value)) is not None:
            return Fault(_dotted(path), why)
        if isinstance(value, dict):
            for name, each in value.items():
                if (why := _text_fault(name, LONGEST_NAME)) is not None:
                    return Fault(_dotted((path, name)), f"the name of a field: {why}")
                waiting.append((each, (path, name), depth + 1))
        elif isinstance(value, list):
            waiting += [(each, (path, index), depth + 1) for index, each in enumerate(value)]
    return None


def _value_fault(value: Any) -> str | None:
    if isinstance(value, _InvalidValue):
        return value.message
    return _text_fault(value, LONGEST_TEXT) if isinstance(value, str) else None


def _text_fault(text: str, longest: int) -> str | None:
    if len(text) > longest:
        return f"a text of {len(text)} characters; at most {longest} are taken"
    if "\x00" in text:
        return "a text holds no character NUL (\\u0000)"
    if not text.isascii():
        try:
            text.encode()
        except UnicodeEncodeError:
            return "half of a surrogate pair (\\ud800 to \\udfff) is no character"
    return None


def _encoded_fault(text: bytes) -> str | None:
    """Why percent-encoded text is none."""
    if len(text) > LONGEST_IN_ADDRESS:
        return f"{len(text)} bytes; at most {LONGEST_IN_ADDRESS} are taken"
    if b"%" not in text and text.isascii():
        return None
    try:
        decoded = unquote_to_bytes(text).decode()
    except UnicodeDecodeError:
        return "percent-encoded bytes that are not UTF-8"
    return _text_fault(decoded, LONGEST_IN_ADDRESS)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any] | _InvalidValue:
    found = dict(pairs)
    if len(found) == len(pairs):
        return found
    seen: set[str] = set()
    for name, _ in pairs:
        if name in seen:
            break
        seen.add(name)
    return _InvalidValue(f"{shortened(name)!r} is given twice")


def _number(text: str) -> float | _InvalidValue:
    number = float(text)
    return number if math.isfinite(number) else _InvalidValue(f"{shortened(text, 40)} is beyond the range of numbers")


def _integer(text: str) -> int | _InvalidValue:
    if len(text) <= len(str(LARGEST_INTEGER)) + 1 and abs(int(text)) <= LARGEST_INTEGER:
        return int(text)
    return _InvalidValue(f"{shortened(text, 40)} is beyond the integers that are taken, {LARGEST_INTEGER} at most")


def _dotted(path: tuple[Any, ...]) -> str:
    """The name of a field as problems give it, `notes.0.text`, from the links of its path."""
    names: list[str] = []
    while path:
        path, name = path
        names.append(shortened(str(name), 60))
    return ".".join(reversed(names))
