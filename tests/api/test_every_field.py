"""Every text, number and truth value of every operation, as the API's own document lists them, given what it is not."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import pytest

DOCUMENT = json.loads((Path(__file__).parents[2] / "web" / "openapi.json").read_text())

NOT_A_TEXT = "\ud800"
UNLIKE = {"integer": (False, "7", 1e400), "number": (True, "1.5"), "boolean": (0, "true")}
"""What is no value of a kind, though Python would take it for one."""


class Place(NamedTuple):
    """A field in the body of an operation."""

    method: str
    path: str
    names: tuple[str | int, ...]
    kind: str

    def __str__(self) -> str:
        return f"{self.method} {self.path} {'.'.join(map(str, self.names))}"


def resolved(schema: dict[str, Any]) -> dict[str, Any]:
    while "$ref" in schema:
        schema = DOCUMENT["components"]["schemas"][schema["$ref"].rpartition("/")[2]]
    return schema


def fields(schema: dict[str, Any], names: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Name and kind of every value that a schema has a name for."""
    schema = resolved(schema)
    for one in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
        yield from fields(one, names)
    for name, each in schema.get("properties", {}).items():
        yield from fields(each, (*names, name))
    if "items" in schema:
        yield from fields(schema["items"], (*names, 0))
    if isinstance(schema.get("additionalProperties"), dict):
        yield from fields(schema["additionalProperties"], (*names, "frames"))
    if schema.get("type") in (*UNLIKE, "string"):
        yield names, schema["type"]


def operations() -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, of in DOCUMENT["paths"].items():
        yield from ((path, method, operation) for method, operation in of.items())


PLACES = [
    Place(method, path, names, kind)
    for path, method, operation in operations()
    if "application/json" in operation.get("requestBody", {}).get("content", {})  # a log that is imported is no JSON
    for names, kind in fields(operation["requestBody"]["content"]["application/json"]["schema"])
]


def put(names: tuple[str | int, ...], value: Any) -> Any:
    """A body that has this value there, and nothing else."""
    for name in reversed(names):
        value = [value] if name == 0 else {name: value}
    return value


def addressed(path: str) -> str:
    return path.removeprefix("/api/v1").replace("{index}", "0").replace("{name}", "x").replace("{run_id}", RUN).replace(
        "{study_id}", RUN
    )  # fmt: skip


RUN = "20261122T113000123-4f9a2c"


async def asked(console, place: Place, value: Any):
    body = json.dumps(copy.deepcopy(put(place.names, value)))
    headers = {"Content-Type": "application/json"}
    return await console.http.request(place.method, addressed(place.path), content=body, headers=headers)


async def test_what_no_text_can_hold_is_named_wherever_it_stands(console):
    """As a value of any field, and as a name of one: refused before anything is made of it."""
    assert len(PLACES) > 20
    for place in PLACES:
        answer = await asked(console, place, NOT_A_TEXT)
        dotted = ".".join(map(str, place.names))
        assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, dotted), place
        answer = await asked(console, place, {NOT_A_TEXT: 1})
        assert (answer.status_code, "surrogate" in answer.text) == (422, True), place
    assert list((console.services.settings.data_dir / "studies").glob("*")) == []
    assert (await console.http.get("/presets")).json() == []


async def test_no_value_stands_for_one_of_another_kind(console):
    wrong = [(place, value) for place in PLACES for value in UNLIKE.get(place.kind, ())]
    assert {place.kind for place, _ in wrong} == set(UNLIKE)
    for place, value in wrong:
        answer = await asked(console, place, value)
        named = [error["field"] for error in answer.json().get("errors", [])]
        assert answer.status_code == 422, (place, value, answer.text)
        assert any(field.endswith(".".join(map(str, place.names[-1:]))) for field in named), (place, value, named)


@pytest.mark.parametrize("value", ["%ed%a0%80", "%00", "%ff"])
async def test_queries_and_paths_are_text(console, value):
    places = set()
    for path, method, operation in operations():
        texts = [each for each in operation.get("parameters", ()) if "string" in json.dumps(each["schema"])]
        for each in texts:
            if each["in"] == "query":
                address = f"{addressed(path)}?{each['name']}={value}"
            elif each["in"] == "path":
                address = path.removeprefix("/api/v1").replace("{" + each["name"] + "}", value).replace("{index}", "0")
            else:
                continue
            answer = await console.http.request(method, address)
            assert 400 <= answer.status_code < 500, (method, address, answer.text)
            places.add(each["in"])
    assert places == {"query", "path"}


@pytest.mark.parametrize("method", ["POST", "PATCH"])
async def test_parameters_are_given_as_what_they_are(console, method):
    path, wrap = ("/runs", lambda changes: {"changes": changes}) if method == "POST" else ("/mission/config", dict)
    for changes in ({"simulation": {"seed": False}}, {"published": {"impedance": {"damping": "3"}}}):
        answer = await console.http.request(method, path, json=wrap(changes))
        assert (answer.status_code, "it is a number" in answer.text) == (422, True)
    deep: dict[str, Any] = {}
    for _ in range(900):
        deep = {"a": deep}
    answer = await console.http.request(method, path, json=wrap(deep))
    assert (answer.status_code, "levels deep" in answer.json()["detail"]) == (422, True)


async def test_instants_are_compared_as_instants(console):
    run = (await console.http.post("/runs", json={"configuration": "published", "direct": True})).json()
    started = run["started"]
    for zone in ("+00:00", "+05:00", "-11:30"):
        # The same moment, said in another zone: later or earlier as a text.
        said = _in_zone(started, zone)
        found = (await console.http.get("/runs", params={"started_from": said, "started_to": said})).json()["runs"]
        assert [each["id"] for each in found] == [run["id"]], said
    refused = await console.http.get("/runs", params={"started_from": "yesterday"})
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "started_from")


def _in_zone(text: str, zone: str) -> str:

    return (
        datetime.fromisoformat(text).astimezone(datetime.fromisoformat(f"2026-01-01T00:00:00{zone}").tzinfo).isoformat()
    )
