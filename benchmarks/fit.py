"""How well fits find what is hidden: runs of an emulated testbed, whose truth only the benchmark knows.

    python -m benchmarks.fit [--seeds 20] [--first 0] [--flown-by emulator] [--engine pymunk] [--json FILE]

Each seed draws a truth (contact, servos, target, table, clock), flies captures, gives the fit what a log would hold,
and compares. Nothing that only the simulation knows reaches the fit: the true fields of its ticks are erased.

A run is flown by the `simulation`, with the imperfections of the emulated testbed, or by the `emulator`: the robot's
end and the console's in virtual time (`server.link.virtual_robot`), with the bytes of the wire between them.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from server.link.imperfections import Imperfections
from server.link.virtual_robot import VirtualRobot
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.identification.fit import fit, planned
from sim.identification.parameters import COMMAND_DELAY, STAMP_ERROR
from sim.identification.prediction import touches_of
from sim.identification.recording import Recording, recording
from sim.identification.result import FittedParameter
from sim.identification.shooting import Weights
from sim.plant.engine import simulated_plant

NAMES = (
    "contact.stiffness",
    "contact.damping",
    "contact.friction",
    "robot.servo.time_constant",
    "perception.capture.stamp_error",
    "command.delay",
    "target.mass",
    "target.inertia",
    "table.drag",
    "table.tilt_x",
    "table.tilt_y",
)
LENGTH = 30.0
"""Of a run [s]."""
_OF_THE_LINK = (STAMP_ERROR, COMMAND_DELAY)
"""Pictures have their true stamps there, and joint rates come into force with the next period."""
RUNS = 1
"""Fitted together; one more is held out."""


def console_config(engine: str) -> MissionConfig:
    """The testbed, as a console is configured for it."""
    return revised(named_configuration("testbed"), {"simulation": {"engine": engine}})


def simulated_config(engine: str) -> MissionConfig:
    """The testbed with the emulator's sensors, as they are known to be."""
    some = Imperfections()
    return revised(
        console_config(engine),
        {
            "perception": {
                "source": "motion_capture",
                "noise": {
                    "position": some.position_noise,
                    "angle": some.angle_noise,
                    "force": some.force_noise,
                    "torque": some.torque_noise,
                },
                "imperfections": {
                    "force_bias": some.force_noise / np.sqrt(40.0),  # what taring leaves
                    "torque_bias": some.torque_noise / np.sqrt(40.0),
                    "encoder_resolution": some.encoder_resolution,
                    "outliers": some.outliers,
                },
                "capture": {"delay": some.motion_capture_delay, "dropouts": some.dropouts},
            },
        },
    )


def truth(config: MissionConfig, seed: int, *, stamped: bool = True) -> dict[str, float]:
    """What is hidden, drawn by the seed; stamps of pictures are wrong if they are `stamped` by another clock, which
    those of the link are not."""
    drawn = np.random.default_rng(seed)

    def factor(spread: float) -> float:
        return float(np.exp(drawn.uniform(-spread, spread)))

    drawn_truth = {
        "contact.stiffness": config.contact.stiffness * factor(0.5),
        "contact.damping": config.contact.damping * factor(0.5),
        "contact.friction": float(drawn.uniform(0.15, 0.5)),
        "robot.servo.time_constant": float(drawn.uniform(1e-3, 8e-3)),
        "perception.capture.stamp_error": float(drawn.choice([-1, 1]) * drawn.uniform(4e-3, 10e-3)),
        "target.mass": config.target.mass * factor(0.25),
        "target.inertia": config.target.inertia * factor(0.25),
        "table.drag": float(drawn.uniform(0.01, 0.05)),
        "table.tilt_x": float(drawn.choice([-1, 1]) * drawn.uniform(5e-5, 2e-4)),
        "table.tilt_y": float(drawn.choice([-1, 1]) * drawn.uniform(5e-5, 2e-4)),
    }
    return {**drawn_truth, COMMAND_DELAY: 0.0} if stamped else {**drawn_truth, STAMP_ERROR: 0.0, COMMAND_DELAY: 0.005}


def flown(config: MissionConfig, hidden: dict[str, float], seed: int, spin: float) -> Recording:
    """A run of the simulation with that truth, as a log would hold it."""
    start = {"target": {"initial_spin": spin}}
    mission_config = revised(config, nested({name: value for name, value in hidden.items() if name != COMMAND_DELAY}))
    mission_config = revised(mission_config, start)
    mission_config = revised(mission_config, {"simulation": {"seed": seed}})
    return logged(f"seed-{seed}", revised(config, start), Mission(mission_config, simulated_plant(mission_config)))


def emulated(config: MissionConfig, hidden: dict[str, float], seed: int, spin: float) -> Recording:
    """A run of the emulated robot with that truth, as the console's log would hold it."""
    console = revised(config, {"target": {"initial_spin": spin}})
    true = revised(console, nested({name: value for name, value in hidden.items() if name not in _OF_THE_LINK}))
    given = {name: hidden[f"table.{name}"] for name in ("drag", "tilt_x", "tilt_y")}
    plant = VirtualRobot(console, Imperfections(**given), seed, true)
    return logged(f"seed-{seed}", console, Mission(console, plant))


def logged(name: str, config: MissionConfig, mission: Mission) -> Recording:
    """A capture by that mission, as its log would hold it."""
    mission.request(Command.CAPTURE)
    rows = []
    while mission.time < LENGTH - 1e-9 and mission.fault is None:
        rows.append(mission.advance(200))
    ticks = np.concatenate(rows)
    for field in ("base_pose", "base_twist", "target_pose", "target_twist", "hand_wrench", "tip_force", "momentum"):
        ticks[field] = np.nan
    return recording(name, config, [ticks])


def one(seed: int, flown_by: str, engine: str) -> dict[str, Any]:
    """What the fit of one seed found."""
    config = console_config(engine) if flown_by == "emulator" else simulated_config(engine)
    hidden = truth(config, seed, stamped=flown_by != "emulator")
    spins = np.random.default_rng(seed + 1000).uniform(0.6, 1.4, RUNS + 1)
    fly = emulated if flown_by == "emulator" else flown
    runs = [fly(config, hidden, 10 * seed + place, float(spin)) for place, spin in enumerate(spins)]
    result = fit(planned(runs[:-1], NAMES, held_out=runs[-1:]))
    held = result.held_out_predictions
    hardest = max(held, key=lambda each: each.measured, default=None)
    return {
        "seed": seed,
        "parameters": {each.name: compared(each, hidden[each.name]) for each in result.parameters},
        "touches": result.touches,
        "held_out": None if hardest is None else [hardest.measured, hardest.nominal, hardest.fitted],
        "held_out_by_the_truth": None if hardest is None else by_the_truth(runs[-1], hidden, hardest.time),
        "rows": result.rows,
        "notices": result.notices,
        "wall_time": result.wall_time,
    }


def compared(found: FittedParameter, true: float) -> dict[str, Any]:
    """A parameter beside the truth. Identifiable is what has an interval of less than a tenth of it either way."""
    sharp = found.low is not None and found.high is not None and 0.5 * (found.high - found.low) < 0.1 * abs(true)
    return {
        "true": true,
        "value": found.value,
        "error": found.standard_error,
        "low": found.low,
        "high": found.high,
        "told": found.told,
        "identifiable": found.told and sharp,
    }


def by_the_truth(run: Recording, hidden: dict[str, float], time: float) -> float:
    """What the true values foretell of that touch [N]: as well as anything can, from what sensors saw before it."""
    touch = next(each for each in touches_of(run) if each.time == time)
    return touch.peak(hidden, Weights(3e-4, 1.5e-3, 3e-4, 1.5e-3, 2e-5, 0.02, 1e-3))


def timed() -> dict[str, float]:
    """Wall and processor time of one run of 30 s fitted for six parameters [s], and the ticks that were flown."""
    config = simulated_config("reduced")
    run = flown(config, truth(config, 0), 0, 1.0)
    plan = planned([run], (*NAMES[:5], "target.inertia"))
    fit(plan)
    began, worked = time.perf_counter(), time.process_time()
    rows = fit(plan).rows
    return {"wall": time.perf_counter() - began, "processor": time.process_time() - worked, "ticks": rows}


def summary(seeds: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Over all seeds."""
    parameters = {}
    covered_all, told_all = 0, 0
    for name in NAMES:
        all_of = [each["parameters"][name] for each in seeds]
        told = [each for each in all_of if each["told"]]
        able = [each for each in told if each["identifiable"]]
        covered = sum(each["low"] <= each["true"] <= each["high"] for each in told)
        covered_all, told_all = covered_all + covered, told_all + len(told)
        relative = [abs(each["value"] / each["true"] - 1.0) for each in able]
        parameters[name] = {
            "told": len(told),
            "identifiable": len(able),
            "within_10_percent": sum(each <= 0.1 for each in relative),
            "median_error": float(np.median(relative)) if relative else None,
            "worst_error": max(relative, default=None),
            "covered": covered,
        }
    peaks = [each["held_out"] for each in seeds if each["held_out"] is not None]
    return {
        "seeds": len(seeds),
        "parameters": parameters,
        "coverage": covered_all / max(1, told_all),
        "intervals": told_all,
        "held_out_within_15_percent": sum(abs(fitted / measured - 1.0) <= 0.15 for measured, _, fitted in peaks),
        "held_out_nominal_within_15_percent": sum(abs(usual / measured - 1.0) <= 0.15 for measured, usual, _ in peaks),
        "held_out_by_the_truth_within_15_percent": sum(
            abs(each["held_out_by_the_truth"] / each["held_out"][0] - 1.0) <= 0.15 for each in seeds if each["held_out"]
        ),
        "held_out": len(peaks),
    }


def main() -> None:
    """Run it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--flown-by", choices=("simulation", "emulator"), default="simulation")
    parser.add_argument("--engine", choices=("reduced", "pymunk"), default="reduced", help="of what flies the runs")
    parser.add_argument("--json", type=Path, help="write every seed's numbers there")
    options = parser.parse_args()
    seeds = []
    for seed in range(options.first, options.first + options.seeds):
        seeds.append(one(seed, options.flown_by, options.engine))
        print(json.dumps(seeds[-1]), flush=True)
    result = {**summary(seeds), "30_s_and_6_parameters": timed()}
    print(json.dumps(result, indent=1))
    if options.json is not None:
        options.json.write_text(json.dumps({"summary": result, "seeds": seeds}, indent=1))


if __name__ == "__main__":
    main()
