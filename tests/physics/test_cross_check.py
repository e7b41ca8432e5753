"""Both engines on the same commands: where they agree, where they part, and what the command says of it."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

from becalm.cli import main
from sim.capture.cross_check import TOLERANCE, CrossCheck, cross_check
from sim.config import Engine, MissionConfig
from sim.configurations import named_configuration, nested, revised

FINE: dict[str, object] = {"simulation.time_step": 1.25e-4}


def published(changes: dict[str, object]) -> MissionConfig:
    return revised(named_configuration("published"), nested({"judging.time_limit": 3.6, **changes}))


@pytest.fixture(scope="module")
def checks() -> tuple[CrossCheck, CrossCheck]:
    """At the step of a millisecond and at an eighth of it, to just after the first touch."""
    return cross_check(published({})), cross_check(published(FINE))


def test_names_the_engine_that_was_configured_first(checks: tuple[CrossCheck, CrossCheck]) -> None:
    assert [flight.engine for flight in checks[0].flights] == ["pymunk", "reduced"]
    other = cross_check(published({"simulation.engine": Engine.REDUCED.value, "judging.time_limit": 0.1}))
    assert [flight.engine for flight in other.flights] == ["reduced", "pymunk"]


def test_the_engines_touch_first_in_the_same_place(checks: tuple[CrossCheck, CrossCheck]) -> None:
    touches = [flight.first_touch for flight in checks[0].flights] + [checks[0].first_touch]
    for touch in touches:
        assert touch is not None
        assert (touch.arm, touch.tip) == ("right", 1)
        assert touch.time == pytest.approx(3.456, abs=2e-3)
        assert touch.place == pytest.approx((0.103, 0.3243), abs=2e-4)
    assert checks[0].same


def test_what_parts_the_plants_shrinks_with_the_step(checks: tuple[CrossCheck, CrossCheck]) -> None:
    coarse, fine = checks
    assert coarse.divergence is not None
    assert coarse.divergence.distance > TOLERANCE
    assert coarse.before_touch < 1e-4
    assert fine.before_touch == pytest.approx(coarse.before_touch / 8.0, rel=0.3)


PUBLISHED = ("--configuration", "published")


def test_of_other_outcomes_is_said() -> None:
    """A cell without damping or stiffness, which rounding decides: the first touch is the same, the end is not."""
    impedance = {f"published.impedance.{name}": value for name, value in (("mass", 0.01), ("stiffness", 10.0))}
    words = [f"--set={path}={value}" for path, value in {**impedance, "published.impedance.damping": 0.0}.items()]
    result = CliRunner().invoke(main, ["run", *PUBLISHED, "--cross-check", "--json", *words])
    document = json.loads(result.stdout)
    assert document["same_first_touch"]
    assert result.exit_code == (0 if document["same_outcome"] else 1)
    classes = {flight["outcome"]["at_first_closure"] for flight in document["flights"]}
    assert document["same_outcome"] == (len(classes) == 1)
    told = CliRunner().invoke(main, ["run", *PUBLISHED, "--cross-check", *words])
    assert told.exit_code == result.exit_code
    assert ("the engines agree" in told.stdout) == document["same_outcome"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--log", "capture.mcap"), "--log does not go with it"),
        (("--set", "simulation.solver_iterations=80"), "simulation.solver_iterations = 80 is read by"),
        (("--set", "simulation.engine=bullet"), "pymunk"),
        (("--set", "simulation.engine=reduced", "--set", "contact.stiffness=1e6"), "too long"),
    ],
)
def test_of_what_cannot_be_flown_exits_2(arguments: tuple[str, ...], words: str) -> None:
    result = CliRunner().invoke(main, ["run", *PUBLISHED, "--cross-check", *arguments])
    assert result.exit_code == 2
    assert words in result.stderr
    assert result.stdout == ""
