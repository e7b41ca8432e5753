"""Rehearsals: draws as the model says, futures that do not depend on who flies them, and what they say."""

from __future__ import annotations

import math
import threading
from typing import Any

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, Intervention
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.errors import ConfigError, MissionRefused
from sim.plant.engine import simulated_plant
from sim.plant.plant import PLANT_STATE
from sim.plant.scripted_plant import ScriptedPlant
from sim.rehearsal.futures import Flown, fly_future, rehearsed
from sim.rehearsal.rehearsal import (
    AS_CHANGED,
    AS_IT_IS,
    MOST_FUTURES,
    Rehearsal,
    RehearsalCancelled,
    fly_case,
    planned,
    rehearse,
)
from sim.rehearsal.situation import Situation
from sim.rehearsal.summary import case_result
from sim.rehearsal.uncertainty import CERTAIN, DRAWN, UncertaintyModel, draw, true_config, true_state, uncertainty_of

MODEL = UncertaintyModel()


def configured(name: str = "published", **changes: Any) -> MissionConfig:
    """A named configuration in the reduced engine; `__` stands for the dot."""
    paths = {path.replace("__", "."): value for path, value in changes.items()}
    return revised(named_configuration(name), nested({"simulation.engine": "reduced", **paths}))


def at_start(config: MissionConfig) -> Situation:
    """Before the first tick."""
    return Situation.of(Mission(config))


def under_way(config: MissionConfig, time: float) -> Situation:
    """In a capture, that long after it began [s]."""
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    mission.advance_unrecorded(round(time / config.control.period))
    return Situation.of(mission)


def few(situation: Situation, futures: int = 6, **further: Any) -> Rehearsal:
    """A rehearsal of a capture that is short."""
    chosen = {"request": Command.CAPTURE, "uncertainty": MODEL, "horizon": 4.0, **further}
    return planned(situation, chosen.pop("changes", {}), futures=futures, **chosen)


def summary(flown: list[Flown]) -> str:
    return case_result(flown).model_dump_json()


def test_the_same_seed_gives_the_same_futures_whatever_the_number_of_threads() -> None:
    rehearsal = few(at_start(configured()), futures=8)
    one, three = (fly_case(rehearsal, AS_IT_IS, range(8), threads=threads) for threads in (1, 3))
    assert summary(one) == summary(three)
    assert all(a.trace.tobytes() == b.trace.tobytes() for a, b in zip(one, three, strict=True))
    part = fly_case(rehearsal, AS_IT_IS, [5], threads=1)
    assert part[0].trace.tobytes() == one[5].trace.tobytes()
    other = fly_case(few(at_start(configured()), futures=8, seed=1), AS_IT_IS, [5], threads=1)
    assert other[0].drawn.values != one[5].drawn.values


def test_a_certain_future_from_the_start_is_the_headless_flight_bit_for_bit() -> None:
    config = configured(judging__hold_time=0.5)
    flown = fly_future(at_start(config), config, Command.CAPTURE, CERTAIN, 0, 0, 60.0)
    assert flown.outcome == run_capture(config).outcome


def test_what_goes_on_from_a_state_ends_as_the_flight_itself_would() -> None:
    """Perfect sensors and no spread: a future is the flight that it looks ahead to, but for rounding."""
    config = configured(judging__hold_time=0.5)
    real = run_capture(config).outcome
    flown = fly_future(under_way(config, 1.5), config, None, CERTAIN, 0, 0, 60.0)
    assert flown.outcome.outcome is real.outcome
    assert flown.outcome.peak_tip_force == pytest.approx(real.peak_tip_force, rel=1e-3)
    assert flown.outcome.closed_at == pytest.approx(real.closed_at, abs=2e-3)
    assert flown.outcome.duration == pytest.approx(real.duration, abs=2e-3)


def test_draws_have_the_spread_that_the_model_states() -> None:
    config, situation = configured(), at_start(configured())
    draws = [draw(situation, config, MODEL, 0, future) for future in range(2000)]
    drawn = {each.name: np.array([one.values[each.name] for one in draws]) for each in DRAWN}
    for name, spread in (
        ("target_x", MODEL.target_position),
        ("target_y", MODEL.target_position),
        ("target_angle", MODEL.target_angle),
        ("target_velocity_x", MODEL.target_velocity),
        ("target_spin", MODEL.target_spin),
    ):
        assert np.std(drawn[name]) == pytest.approx(spread, rel=0.06), name
        assert abs(np.mean(drawn[name])) < 0.1 * spread, name
    for name, spread, value in (
        ("target_mass", MODEL.target_mass, config.target.mass),
        ("target_inertia", MODEL.target_inertia, config.target.inertia),
        ("contact_stiffness", MODEL.contact_stiffness, config.contact.stiffness),
        ("servo_time_constant", MODEL.servo_time_constant, config.robot.servo.time_constant),
        ("sensor_noise", MODEL.sensor_noise, 1.0),
    ):
        assert np.std(np.log(drawn[name] / value)) == pytest.approx(spread, rel=0.06), name
    low, high = config.contact.friction - MODEL.friction, config.contact.friction + MODEL.friction
    assert low <= drawn["friction"].min() < low + 0.01
    assert high - 0.01 < drawn["friction"].max() <= high
    assert np.std(drawn["base_x"]) == 0.0, "perfect sensors know the base"
    assert np.std(drawn["delay"]) == 0.0, "nothing is late where every tick is measured"
    assert len({one.seed for one in draws}) == len(draws)


def test_where_an_estimator_says_how_sure_it_is_that_is_drawn() -> None:
    config = configured("becalm")
    situation = under_way(config, 0.5)
    motion = situation.estimate
    assert motion is not None
    draws = [draw(situation, config, MODEL, 0, future) for future in range(2000)]
    for axis, name in enumerate(("target_velocity_x", "target_velocity_y", "target_spin")):
        sure = math.sqrt(motion["target"]["p"][axis, 1, 1])
        assert np.std([one.values[name] for one in draws]) == pytest.approx(sure, rel=0.06), name
    inverse, sure = motion["target"]["x"][2, 2], math.sqrt(motion["target"]["p"][2, 2, 2])
    drawn = np.array([1.0 / one.values["target_inertia"] for one in draws])
    assert np.mean(drawn) == pytest.approx(inverse, rel=0.03)
    assert np.std(drawn) == pytest.approx(sure, rel=0.06)


def test_a_draw_changes_what_is_true_and_nothing_that_the_method_takes_for_granted() -> None:
    config, situation = configured("becalm"), at_start(configured("becalm"))
    one = draw(situation, config, MODEL, 3, 7)
    true = true_config(config, one)
    assert true.target.mass == one.values["target_mass"]
    assert true.contact.solid_stiffness / true.contact.stiffness == pytest.approx(
        config.contact.solid_stiffness / config.contact.stiffness
    )
    assert true.perception.noise.force == pytest.approx(config.perception.noise.force * one.values["sensor_noise"])
    assert true.perception.assumed_inertia == config.perception.assumed_inertia
    assert true.co_moving_couple == config.co_moving_couple
    assert MissionConfig.model_validate(true.model_dump()) == true, "within the bounds of every parameter"
    state = true_state(situation, one)
    assert state["target_pose"][0] == situation.state["target_pose"][0] + one.values["target_x"]
    assert state["joint_angle"].tolist() == situation.state["joint_angle"].tolist()


def test_the_situation_of_a_mission_with_noise_is_what_is_believed_not_the_truth() -> None:
    config = configured("becalm")
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    rows = mission.advance(300)
    situation = Situation.of(mission)
    period = config.control.period
    believed = rows[-1]["target_perceived_pose"] + period * rows[-1]["target_perceived_twist"]
    assert situation.state["target_pose"] == pytest.approx(believed, abs=1e-12)
    assert not np.allclose(situation.state["target_pose"], rows[-1]["target_pose"] + 0.0, atol=1e-6)
    assert situation.tick == 300
    assert situation.time == pytest.approx(0.3)


def test_a_recorded_situation_is_the_one_that_the_mission_was_in() -> None:
    config = configured("becalm")
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    rows = mission.advance(500)
    live = Situation.of(mission)
    history = FlightHistory(config=config, interventions=(Intervention(tick=0, command=Command.CAPTURE),))
    again = Situation.recorded(history, [rows[:300], rows[300:], mission.advance(200)], rows[-1]["time"])
    assert again.tick == live.tick
    assert again.state.tobytes() == live.state.tobytes()
    for field in ("memory", "known", "monitor"):
        assert again.mark.flight[0][field].tobytes() == live.mark.flight[0][field].tobytes(), field
    with pytest.raises(MissionRefused, match="no tick is recorded until then"):
        Situation.recorded(history, [], 1.0)


def test_a_slower_servo_is_worse_and_is_said_to_be() -> None:
    rehearsal = few(
        at_start(configured()), futures=24, horizon=12.0, changes=nested({"robot.servo.time_constant": 0.02})
    )
    result = rehearse(rehearsal, threads=2)
    assert result.as_changed is not None
    assert result.as_changed.caged.share < result.as_it_is.caged.share
    assert next(each for each in result.compared if each.measure == "caged").verdict == "worse"
    assert result.changes == {"robot.servo.time_constant": 0.02}
    assert [each.draw.values["target_mass"] for each in result.as_it_is.each] == [
        each.draw.values["target_mass"] for each in result.as_changed.each
    ], "both fly the same futures"


def test_odds_bands_and_paths_are_those_of_the_futures() -> None:
    rehearsal = few(at_start(configured()), futures=12, horizon=10.0)
    flown = fly_case(rehearsal, AS_IT_IS, range(12), threads=2)
    result = case_result(flown)
    assert sum(each.futures for each in result.odds) == result.futures == 12
    for each in result.odds:
        assert each.low < each.share < each.high or each.share in (0.0, 1.0)
    peaks = [each.outcome.peak_tip_force for each in flown]
    band = next(each for each in result.bands if each.measure == "peak_tip_force")
    expected = np.quantile(peaks, (0.05, 0.5, 0.95), method="weibull")
    assert (band.low, band.median, band.high) == pytest.approx(tuple(expected))
    shown = {path.future for path in result.paths}
    assert {result.worst, result.most_likely} <= shown
    path = result.paths[0]
    assert np.diff(path.times) == pytest.approx(0.05)
    assert len(path.base) == len(path.target) == len(path.left) == len(path.right) == len(path.times)
    uncaged = [each.drawn.future for each in flown if not each.outcome.caged]
    assert not uncaged or result.worst in uncaged
    assert {fan.quantity for fan in result.fans} >= {"target.twist.angle", "left.force"}
    for fan in result.fans:
        assert (np.array(fan.low) <= fan.median).all()
        assert (np.array(fan.median) <= fan.high).all()


def test_what_is_cancelled_ends_before_the_next_future() -> None:
    cancelled, flown = threading.Event(), []
    rehearsal = few(at_start(configured()), futures=50)

    def note(done: int) -> None:
        flown.append(done)
        cancelled.set()

    with pytest.raises(RehearsalCancelled):
        rehearse(rehearsal, threads=1, on_progress=note, cancelled=cancelled)
    assert flown == [1]


def test_what_cannot_be_rehearsed_is_refused_in_words() -> None:
    situation = at_start(configured())
    with pytest.raises(ConfigError, match=rf"futures = 10000000: from 1 to {MOST_FUTURES} .* about \d+ min"):
        few(situation, futures=10_000_000)
    with pytest.raises(ConfigError, match="seed = -1"):
        few(situation, seed=-1)
    with pytest.raises(ConfigError, match="horizon = 0 s"):
        few(situation, horizon=0.0)
    with pytest.raises(ConfigError, match=r"uncertainty.target_spin = -0.1 rad/s: .*greater than or equal to 0"):
        uncertainty_of({"target_spin": -0.1})
    with pytest.raises(ConfigError, match=r"uncertainty.spin is not a field"):
        uncertainty_of({"spin": 0.1})
    with pytest.raises(MissionRefused, match="no capture is under way in phase idle"):
        few(situation, request=None)
    with pytest.raises(MissionRefused, match="request = detumble: no verdict follows it"):
        few(situation, request=Command.DETUMBLE)
    with pytest.raises(MissionRefused, match="capture is refused in phase detumbling"):
        few(under_way(configured(), 0.5))
    with pytest.raises(ConfigError, match=r"published.impedance.damping = -1"):
        few(situation, changes=nested({"published.impedance.damping": -1.0}))


def test_a_sequence_does_not_begin_where_a_hand_touches() -> None:
    config = configured()
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    while not mission.advance(1)[-1]["tip_contact"].any():
        pass
    mission.request(Command.HOLD)
    touching = Situation.of(mission)
    assert touching.touching
    with pytest.raises(MissionRefused, match="a hand touches the target"):
        few(touching)


def test_in_touch_no_pose_is_drawn_and_it_is_said() -> None:
    config = configured()
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    while not mission.advance(1)[-1]["tip_contact"].any():
        pass
    rehearsal = few(Situation.of(mission), futures=1, request=None)
    flown = fly_case(rehearsal, AS_IT_IS, [0], threads=1)
    assert flown[0].drawn.values["target_x"] == 0.0
    assert flown[0].drawn.values["target_velocity_x"] != 0.0
    assert any("a hand touches the target" in notice for notice in rehearsal.notices)


def test_futures_fly_in_the_reduced_engine_whatever_the_mission_does() -> None:
    config = revised(named_configuration("published"), nested({"simulation.solver_iterations": 40}))
    assert rehearsed(config).simulation.engine.value == "reduced"
    rehearsal = few(Situation.of(Mission(config)), futures=1, changes=nested({"target.initial_spin": 2.0}))
    assert {each.simulation.engine.value for each in rehearsal.cases.values()} == {"reduced"}
    assert AS_CHANGED in rehearsal.cases
    assert any("target.initial_spin" in notice for notice in rehearsal.notices)


def test_a_robots_state_begins_at_the_tick_nearest_to_its_own_clock() -> None:
    """Its ticks are those that came, its time is that of its clock: after losses they differ."""
    config = configured("testbed")
    states = np.zeros(3, PLANT_STATE)
    states[:] = simulated_plant(config).state
    states["tick"], states["time"] = [0, 1, 2], [0.0, 0.0051, 0.0349]
    states["target_twist"][:, 2] = 1.0
    states["target_pose"][:, 2] = states["time"]
    plant = ScriptedPlant(states)
    mission = Mission(config, plant)
    mission.advance(3)
    situation = Situation.of(mission)
    assert situation.time == pytest.approx(situation.tick * config.control.period)
    assert abs(situation.time - 0.0349) <= 1.5 * config.control.period
    assert situation.state["target_pose"][2] == pytest.approx(situation.time, abs=1e-9)
    flown = fly_case(few(situation, futures=1, horizon=0.5), AS_IT_IS, [0], threads=1)
    assert flown[0].error is None
    assert flown[0].trace["time"][0] >= situation.time
