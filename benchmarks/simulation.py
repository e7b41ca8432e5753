"""How fast the simulation is, and what limits it: `python -m benchmarks.simulation`.

Everything is given as a ratio, so that figures of different machines compare: simulated seconds a second of
one core (mission.md asks for 100 over whole captures), and the share of a tick that each part takes. Times
are the thread's own (`thread_time`), so that a busy neighbour and idle linear-algebra threads count little; the
best of several rounds counts, for a neighbour still empties the caches.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import mujoco
import numpy as np

from sim.capture.caging import cage
from sim.capture.events import Ticks
from sim.capture.mission import Mission, prepare
from sim.capture.monitor import begin_monitoring, watch
from sim.capture.run import run_capture
from sim.capture.tick_loop import FLIGHT, Flight, know, recall, write_tick
from sim.compiled import FloatArray, compiled
from sim.config import Engine, MissionConfig
from sim.configurations import named_configuration, revised
from sim.control.phases import Command, Phase, Sequence, Verdict
from sim.method.method import MethodHandle, begin_sequence, decide, method_of
from sim.model.clearance import shapes_of
from sim.model.reduced_model import set_chain
from sim.model.robot import LINKS, robot_model
from sim.plant.chipmunk import SET_RATE, STEP, call_scalar
from sim.plant.engine import simulated_plant
from sim.plant.plant import PLANT_STATE, PlantHandle, advance_plant, robot_shape
from sim.plant.pymunk_plant import PymunkHandle, PymunkPlant
from sim.record import Record, packed, record_of
from tests.physics.mujoco_reference import Reference

ROUNDS = 5
TICKS = 3000
SWAY = np.outer(np.sin(np.arange(TICKS) / 200.0), [0.3, -0.4, 0.5, -0.3, 0.4, -0.5]).reshape(TICKS, 2, 3)
"""Smooth joint rates that come to nothing over the ticks [rad/s]."""
FIGURE = 100.0
"""Simulated seconds a second, over whole captures (mission.md, "Figures to reach")."""


def best_time(action: Callable[[], Any], rounds: int = ROUNDS) -> float:
    """Shortest thread time of an action over several rounds [s]."""
    times = []
    for _ in range(rounds):
        before = time.thread_time()
        action()
        times.append(time.thread_time() - before)
    return min(times)


def capture_speeds() -> dict[str, float]:
    """Simulated seconds a second of whole captures, to their verdicts."""
    speeds = {}
    for label, name, direct in (
        ("direct caging", "published", True),
        ("published", "published", False),
        ("published_figures", "published_figures", False),
    ):
        for engine in Engine:
            config = revised(named_configuration(name), {"simulation": {"engine": engine.value}})
            simulated = run_capture(config, direct=direct).simulated_time
            speeds[f"{label}, {engine.value}"] = simulated / best_time(partial(run_capture, config, direct=direct))
    return speeds


@compiled
def _bare_steps(handle: PymunkHandle, dt: float, rates: FloatArray) -> None:
    for tick in range(rates.shape[0]):
        for arm in range(2):
            for joint in range(3):
                motor = handle.motors[LINKS * arm + joint]
                call_scalar(handle.functions[SET_RATE], motor, -rates[tick, arm, joint])
        call_scalar(handle.functions[STEP], handle.space, dt)


@compiled
def _plant_ticks(handle: PlantHandle, parameters: Record, state: Record, rates: FloatArray) -> None:
    for tick in range(rates.shape[0]):
        advance_plant(handle, parameters, rates[tick], state)


@compiled
def _shaped_ticks(handle: PlantHandle, flight: Flight, state: Record, flown: Ticks) -> None:
    own = flight[0]
    for row in flown:
        recall(row, state)
        set_chain(state.base_pose, robot_shape(handle, own.robot, state, own.shape), own.links)


@compiled
def _watched_ticks(flight: Flight, state: Record, flown: Ticks) -> None:
    own = flight[0]
    for row in flown:
        recall(row, state)
        watch(own.monitor, own.memory, own.parameters, own.robot, own.shapes, state, own.links)


@compiled
def _controlled_ticks(method: MethodHandle, flight: Flight, state: Record, flown: Ticks) -> None:
    own = flight[0]
    for row in flown:
        recall(row, state)
        know(own.known, own.parameters, own.robot, own.shapes, state, 0)
        shape, links, motion = own.shape, own.links, own.motion
        decide(method, own.memory, own.parameters, own.robot, own.known, shape, links, motion, Verdict.NONE)


@compiled
def _written_ticks(flight: Flight, state: Record, flown: Ticks, rows: Ticks) -> None:
    own = flight[0]
    for place in range(flown.shape[0]):
        recall(flown[place], state)
        write_tick(rows[place], own.memory, own.monitor, state, own.links, own.known)


@compiled
def _recalled_ticks(state: Record, flown: Ticks) -> None:
    for row in flown:
        recall(row, state)


def tick_shares() -> dict[str, float]:
    """Time of each part of a tick, relative to a whole one, over the approach to the first touch, in each engine.

    The parts fly the same motion again: arms at rest would leave pymunk's collision tree nothing to do.
    """
    return {f"{engine.value}: {part}": share for engine in Engine for part, share in engine_shares(engine).items()}


def engine_shares(engine: Engine) -> dict[str, float]:
    """As `tick_shares`, in one engine."""
    config = revised(MissionConfig(), {"simulation": {"engine": engine.value}})
    chosen = method_of(config)
    method = chosen.handle(config, np.zeros(1, chosen.memory))
    flight, state = np.zeros(1, FLIGHT), np.zeros(1, PLANT_STATE)[0]
    flight["robot"], flight["shapes"] = packed(robot_model(config.robot)), shapes_of(config)
    flight["parameters"] = record_of(config)
    plants = iter([simulated_plant(config) for _ in range(2 * ROUNDS + 3)])
    handle, parameters = next(plants).handle, record_of(config)
    flown = _begun(config).advance(TICKS)
    rates, rows = np.ascontiguousarray(flown["commanded_joint_rate"]), flown.copy()

    def fly_plant() -> None:
        plant = next(plants)
        _plant_ticks(plant.handle, parameters, plant.state, rates)

    def steer() -> None:
        begin_sequence(method, flight[0]["memory"], int(Phase.DETUMBLING), int(Sequence.CAPTURE))
        _controlled_ticks(method, flight, state, flown)

    def look() -> None:
        begin_monitoring(flight[0]["monitor"], 0.0, state["momentum"])
        _watched_ticks(flight, state, flown)

    parts = {
        "plant": fly_plant,
        "where the links are": partial(_shaped_ticks, handle, flight, state, flown),
        "perception and controller": steer,
        "monitor": look,
        "rows": partial(_written_ticks, flight, state, flown, rows),
        "recall": partial(_recalled_ticks, state, flown),
    }
    times = {}
    for name, part in parts.items():
        part()  # compiled
        times[name] = best_time(part)
    recalling = times.pop("recall")
    times = {name: taken - (0.0 if name == "plant" else recalling) for name, taken in times.items()}
    missions = iter([_begun(config) for _ in range(ROUNDS)])
    whole = best_time(lambda: next(missions).advance(TICKS))
    times["rest: fresh memory, events"] = whole - sum(times.values())
    return {name: taken / whole for name, taken in times.items()}


def step_share() -> dict[str, float]:
    """Time of pymunk's own step relative to that of its plant."""
    config = MissionConfig()
    plants = iter([PymunkPlant(config) for _ in range(2 * ROUNDS + 2)])
    rates, parameters = np.ascontiguousarray(_begun(config).advance(TICKS)["commanded_joint_rate"]), record_of(config)

    def step() -> None:
        _bare_steps(next(plants).handle, config.simulation.time_step, rates)

    def fly_plant() -> None:
        plant = next(plants)
        _plant_ticks(plant.handle, parameters, plant.state, rates)

    for part in (step, fly_plant):
        part()  # compiled
    return {"pymunk's own step": best_time(step) / best_time(fly_plant)}


def _begun(config: MissionConfig) -> Mission:
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    return mission


def ratios_to_mujoco() -> dict[str, float]:
    """Simulated seconds a second as multiples of what MuJoCo's bare `mj_step` of the same robot flies, just before.

    Bare: neither controller nor contact nor judge, the arms moving at a constant torque of zero.
    """
    reference = Reference(MissionConfig().robot)
    reference.model.opt.timestep = MissionConfig().simulation.time_step
    reference.data.qvel[3:] = 0.1
    bare = best_time(partial(mujoco.mj_step, reference.model, reference.data, TICKS)) / TICKS
    ratios = {}
    for engine in Engine:
        config = revised(named_configuration("published_figures"), {"simulation": {"engine": engine.value}})
        plant = simulated_plant(revised(config, {"target": {"initial_y": 4.0}}))
        fly_plant = partial(_plant_ticks, plant.handle, record_of(config), plant.state, SWAY)
        fly_plant()  # compiled
        ratios[f"{engine.value}: plant alone, free flight"] = bare * TICKS / best_time(fly_plant)
        ticks = run_capture(config).ticks
        for kept, fly_it in {
            "no rows kept": partial(run_capture, config),
            "every row kept in memory": partial(_keep_rows, config),
        }.items():
            ratios[f"{engine.value}: whole capture, with controller and judge, {kept}"] = (
                bare * ticks / best_time(fly_it)
            )
        ratios[f"{engine.value}: ticks of an approach alone, no rows kept"] = bare * TICKS / _ticks_alone(config)
    return ratios


def _keep_rows(config: MissionConfig) -> None:
    rows: list[Ticks] = []
    run_capture(config, on_ticks=rows.append)


def _ticks_alone(config: MissionConfig) -> float:
    """Thread time of so many ticks of a capture, without its beginning and the caging test at its end [s]."""
    missions = iter([_begun(config) for _ in range(ROUNDS)])
    return best_time(lambda: next(missions).advance_unrecorded(TICKS))


def iteration_shares() -> dict[str, float]:
    """Time of pymunk's step at several solver iterations, relative to the default's."""
    default = MissionConfig()
    times = {}
    for iterations in (10, 20, default.simulation.solver_iterations, 80):
        simulation = default.simulation.model_copy(update={"solver_iterations": iterations})
        plant = PymunkPlant(default.model_copy(update={"simulation": simulation}))
        times[iterations] = best_time(partial(_bare_steps, plant.handle, 1e-3, SWAY))
    of_default = times[default.simulation.solver_iterations]
    return {f"{iterations} iterations": taken / of_default for iterations, taken in sorted(times.items())}


def cage_times() -> dict[str, float]:
    """Time of the caging test relative to its bound of 100 ms (issue: a verdict within 0.1 s)."""
    config = MissionConfig()
    times = {}
    for label, distance, angle in (
        ("caged", 0.0939, np.pi / 4),
        ("flat", 0.0939, 0.0),
        ("open hands", 0.13, np.pi / 4),
    ):
        hands = np.array([[-distance, 0.0, -np.pi / 2], [distance, 0.0, np.pi / 2]])
        target = np.array([0.0, 0.0, angle])
        cage(config, hands, target)
        times[label] = best_time(partial(cage, config, hands, target)) / 0.1
    return times


SECTIONS: dict[str, tuple[Callable[[], dict[str, float]], str]] = {
    "Simulated seconds a second of one core, whole captures": (capture_speeds, "{:8.0f}"),
    "Share of a tick, over the approach to the first touch": (tick_shares, "{:8.0%}"),
    "Share of the time of its plant": (step_share, "{:8.0%}"),
    "Multiples of MuJoCo's bare step of the same robot": (ratios_to_mujoco, "{:8.2f}"),
    "Pymunk's step, relative to the default's iterations": (iteration_shares, "{:8.2f}"),
    "Caging test, relative to 100 ms": (cage_times, "{:8.0%}"),
}


def main() -> int:
    """Measure and print; exit code 1 if the figure of the mission is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    as_json = parser.parse_args().json
    prepare(MissionConfig())
    measured = {title: measure() for title, (measure, _) in SECTIONS.items()}
    speeds = next(iter(measured.values()))
    if as_json:
        print(json.dumps(measured, indent=2))
    else:
        for title, (_, form) in SECTIONS.items():
            print(f"\n{title}")
            for label, value in measured[title].items():
                print(f"  {form.format(value)}  {label}")
        print(f"\nSlowest capture: {min(speeds.values()):.0f}; figure to reach: {FIGURE:.0f}")
    return 0 if min(speeds.values()) >= FIGURE else 1


if __name__ == "__main__":
    sys.exit(main())
