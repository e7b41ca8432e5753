"""Values of requests that mean one thing only."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest
from pydantic import TypeAdapter, ValidationError

from server.edge.values import Changes, Flag, Instant, Integer, Number


def refused(kind, value) -> str:
    with pytest.raises(ValidationError) as error:
        TypeAdapter(kind).validate_python(value)
    return error.value.errors()[0]["msg"]


@pytest.mark.parametrize(
    ("kind", "value"),
    [(Integer, False), (Integer, "7"), (Integer, 7.5), (Integer, None), (Number, True), (Number, "1.5"), (Number, []),
     (Number, float("nan")), (Number, float("inf")), (Flag, 0), (Flag, 1), (Flag, "true"), (Flag, "false")],
)  # fmt: skip
def test_nothing_stands_for_a_value_of_another_kind(kind, value):
    assert refused(kind, value)


def test_a_whole_number_is_a_number():
    assert TypeAdapter(Number).validate_python(3) == 3.0


@pytest.mark.parametrize(
    ("text", "instant"),
    [
        ("2026-11-25T10:30:00Z", datetime(2026, 11, 25, 10, 30, tzinfo=UTC)),
        ("2026-11-25T12:30:00+02:00", datetime(2026, 11, 25, 10, 30, tzinfo=UTC)),
        ("2026-11-25T10:30:00", datetime(2026, 11, 25, 10, 30, tzinfo=UTC)),
        ("2026-11-25", datetime(2026, 11, 25, tzinfo=UTC)),
        ("2026-11-25T10:30:00.123+00:00", datetime(2026, 11, 25, 10, 30, 0, 123_000, tzinfo=UTC)),
    ],
)
def test_instants_in_any_zone(text, instant):
    assert TypeAdapter(Instant).validate_python(text) == instant


@pytest.mark.parametrize(
    "text",
    ["yesterday", "", "1700000000", "2026-13-01T00:00:00Z",
     "2026-11-25T10:30:00 01:00", "0001-01-01T00:00:00+23:00", "9999-12-31T23:59:59-23:00", "x" * 9000, 1700000000],
)  # fmt: skip
def test_what_is_no_instant_says_how_to_write_one(text):
    said = refused(Instant, text)
    assert "2026-11-25T10:30:00Z" in said
    assert len(said) < 300


@pytest.mark.parametrize(
    "changes",
    [{"simulation": {"seed": False}}, {"published": {"impedance": {"mass": True}}}, {"target": {"mass": "2.35"}}],
)
def test_a_parameter_that_is_a_number_is_given_as_one(changes):
    assert "it is a number" in refused(Changes, changes)


def test_what_else_changes_say_is_not_looked_at_here():
    changes = {"nonesuch": True, "published": {"impedance": {"mass": 0.1}}, "robot": "x"}
    assert TypeAdapter(Changes).validate_python(changes) == changes
