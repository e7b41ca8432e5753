"""What the methods refuse before anything moves, and with which numbers."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.tick import TICK
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.errors import ConfigError
from sim.method.method import method_of
from sim.method.published.refusal import REACH
from sim.record import Record

BECALM = named_configuration("becalm")
BRAKING = pytest.mark.parametrize("command", [Command.CAPTURE, Command.DETUMBLE])
CLOSING = pytest.mark.parametrize("command", [Command.CAPTURE, Command.CAGE])


def row(spin: float = 1.0, y: float = 0.35, angle: float = 0.0, inertia: float = 9e-3) -> Record:
    """A tick of a robot at the origin with a target ahead of it."""
    tick = np.zeros(1, TICK)[0]
    tick["target_perceived_pose"], tick["target_perceived_twist"][2] = (0.0, y, angle), spin
    tick["target_perceived_inertia"] = inertia
    return tick


def refused(command: Command, tick: Record, config: MissionConfig = BECALM, *, on_robot: bool = False) -> str:
    return method_of(config).refusal(command, config, tick, on_robot=on_robot)


@pytest.mark.parametrize("command", list(Command))
@pytest.mark.parametrize("spin", [-3.0, 0.0, 3.0])
def test_what_the_sample_asks_for_is_not_refused(command: Command, spin: float) -> None:
    assert not refused(command, row(spin))


class TestTooFast:
    @BRAKING
    @pytest.mark.parametrize("sense", [1.0, -1.0])
    def test_is_refused_with_the_force_that_it_would_take(self, command: Command, sense: float) -> None:
        why = refused(command, row(9.5 * sense))
        assert "spins at 9.50 rad/s" in why
        in_one, cap, touches, most = (float(each) for each in re.findall(r"(?:take|touches of|be|most) ([\d.]+)", why))
        assert cap == BECALM.co_moving_couple.touch.planned_cap
        assert most == BECALM.co_moving_couple.touch.most_touches
        assert touches == math.ceil(in_one / cap) > most

    def test_four_times_the_energy_takes_four_times_the_force(self) -> None:
        def force(spin: float, inertia: float) -> float:
            return float(re.findall(r"take ([\d.]+) N", refused(Command.CAPTURE, row(spin, inertia=inertia)))[0])

        assert force(20.0, 9e-3) == pytest.approx(4.0 * force(10.0, 9e-3), rel=0.01)
        assert force(10.0, 18e-3) == pytest.approx(2.0 * force(10.0, 9e-3), rel=0.01)

    def test_more_force_makes_it_possible(self) -> None:
        strong = {"co_moving_couple.touch.force_cap": 2.0, "co_moving_couple.touch.planned_cap": 1.5}
        assert not refused(Command.CAPTURE, row(9.5), revised(BECALM, nested(strong)))

    def test_closing_alone_does_not_brake(self) -> None:
        assert not refused(Command.CAGE, row(9.5))


class TestTooFar:
    @CLOSING
    def test_away_is_refused_with_both_lengths(self, command: Command) -> None:
        why = refused(command, row(y=0.7))
        reach = BECALM.robot.arm.link_1.length + BECALM.robot.arm.link_2.length
        needed = float(re.findall(r"a wrist (\d+) mm", why)[0])
        assert f"reach {1e3 * reach:.0f} mm" in why
        assert needed > 1e3 * reach

    @CLOSING
    def test_a_target_too_large_to_reach_around_is_refused(self, command: Command) -> None:
        large = revised(BECALM, nested({"target.side": 0.5, "target.initial_y": 0.8, "target.inertia": 0.1}))
        assert "the arms reach" in refused(command, row(y=0.4), large)

    def test_braking_alone_needs_no_such_reach(self) -> None:
        assert not refused(Command.DETUMBLE, row(y=0.7))


class TestShapes:
    """Squares, hexagons, circles; other shapes are refused with what is wrong with them."""

    def shaped(self, **target: Any) -> MissionConfig:
        return revised(BECALM, {"target": {"inertia": 0.006, **target}})

    def why(self, config: MissionConfig, command: Command = Command.CAPTURE) -> str:
        return Mission(config).refusal(command, on_robot=False)

    @pytest.mark.parametrize("side", [0.08, 0.10])
    def test_a_hexagon_is_taken(self, side: float) -> None:
        assert not self.why(self.shaped(shape="regular_polygon", sides=6, side=side))

    def test_an_octagon_leaves_no_lever_to_brake_with(self) -> None:
        why = self.why(self.shaped(shape="regular_polygon", sides=8, side=0.06))
        assert "reach 30 mm to one side" in why
        assert re.search(r"a lever of [67] mm, and 12 mm are needed", why)

    def test_blunt_corners_leave_too_little_margin(self) -> None:
        why = self.why(self.shaped(shape="regular_polygon", sides=8, side=0.08), Command.CAGE)
        assert "the tips, 79 mm apart" in why
        assert float(re.findall(r"margin of ([\d.]+) mm", why)[0]) < 5.0

    def test_an_odd_polygon_has_no_opposite_sides(self) -> None:
        with pytest.raises(ConfigError, match=r"target.sides = 5: method = co_moving_couple .* even number"):
            self.shaped(shape="regular_polygon", sides=5)

    def test_a_circle_is_taken_that_friction_brakes_in_time(self) -> None:
        config = self.shaped(shape="circle", initial_spin=2.0)
        assert not self.why(config)
        assert "ask for the capture as a whole" in self.why(config, Command.DETUMBLE)

    def test_of_a_circle_it_is_said_what_spin_friction_brakes(self) -> None:
        why = self.why(self.shaped(shape="circle", initial_spin=20.0))
        assert "it is round" in why
        most = float(re.findall(r"brake ([\d.]+) rad/s in 10 s", why)[0])
        stiff = {"co_moving_couple": {"touch": {"planned_cap": 0.3}}}
        less = self.why(revised(self.shaped(shape="circle", initial_spin=20.0), stiff))
        left = BECALM.co_moving_couple.touch.spin_left
        ratio = (float(re.findall(r"brake ([\d.]+) rad/s in 10 s", less)[0]) - left) / (most - left)
        assert ratio == pytest.approx(0.3 / 0.45, rel=0.01)

    def test_a_rectangle_has_corners_that_its_hands_do_not_enclose(self) -> None:
        with pytest.raises(ConfigError, match=r"captures only a target of shape square or regular_polygon or circle"):
            self.shaped(shape="rectangle", width=0.2, depth=0.1)


@pytest.mark.parametrize("name", ["force_cap", "planned_cap"])
def test_a_cap_under_the_floor_is_no_configuration(name: str) -> None:
    with pytest.raises(ConfigError, match=rf"co_moving_couple.touch: {name} = 0.1 N is less than force_floor = 0.15 N"):
        revised(BECALM, nested({f"co_moving_couple.touch.{name}": 0.1}))


class TestThePublishedMethod:
    """On a robot it does not close on a target that hardly turns and stands badly."""

    config = named_configuration("testbed")

    def refused(self, degrees: float, *, on_robot: bool = True, **kwargs: Any) -> str:
        tick = row(angle=math.radians(45.0 + degrees), spin=0.0, **kwargs)
        return refused(Command.CAGE, tick, self.config, on_robot=on_robot)

    def test_closes_on_a_square_that_stands_well(self) -> None:
        assert not self.refused(math.degrees(REACH) - 1.0)
        assert not self.refused(90.0 - math.degrees(REACH) + 1.0)

    def test_says_how_far_off_it_stands(self) -> None:
        assert "+20 degrees off" in self.refused(20.0)
        assert "-20 degrees off" in self.refused(-20.0)

    def test_is_flown_in_simulation_nevertheless(self) -> None:
        assert not self.refused(20.0, on_robot=False)


def test_what_is_refused_beforehand_would_not_have_ended_well() -> None:
    mission = Mission(revised(BECALM, nested({"simulation.engine": "reduced", "target.initial_spin": 9.5})))
    assert "rad/s: one touch would take" in refused(Command.CAPTURE, mission.flown().row, mission.config)
    mission.request(Command.CAPTURE)
    while mission.outcome is None and mission.time < 10.0:
        mission.advance(500)
    assert mission.outcome is None or not mission.outcome.caged
