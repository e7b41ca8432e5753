"""How well rehearsals foretell: `python -m benchmarks.calibration --situations 100`, by hand; a quarter of an hour.

A capture is flown with a truth that nobody knows: target, contact and servos drawn as the uncertainty model says, the
target's inertia as unsure as the estimator assumes, any spin up to 3 rad/s, noise on every reading. At a tick drawn at
random before the first touch it is rehearsed from what is believed, with the nominal configuration. Prints how often
the 90 % band held the real peak force and the real time to the cage, and the Brier score of the odds of being caged
beside that of guessing the base rate. Of the published method, whose sensors are perfect, the motion is not drawn, and
its impedance is another one each time, so that its odds are anything between none and all.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.capture.mission import Mission, prepare
from sim.config import Engine, MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.rehearsal.rehearsal import AS_IT_IS, fly_case, planned
from sim.rehearsal.situation import Situation
from sim.rehearsal.summary import CaseResult, case_result
from sim.rehearsal.uncertainty import UncertaintyModel
from sim.snapshot import Outcome
from sim.study.cores import cores

BEFORE_TOUCH = 0.05
"""The last tick that is rehearsed from is so long before the first contact [s]."""

SENSED = {"target_position": 0.0, "target_angle": 0.0, "target_velocity": 0.0, "target_spin": 0.0}
"""What perfect sensors leave of the uncertainty of motion."""


class Foretold(NamedTuple):
    """One rehearsal, and what then happened."""

    number: int
    at: float
    """Of the rehearsal [s]."""
    odds: float
    """Of being caged."""
    caged: bool
    peak: float
    """The real one [N]."""
    peak_band: tuple[float, float]
    closed_at: float | None
    """The real one [s]; None if it was not caged."""
    closed_band: tuple[float, float] | None


def nominal(name: str, stream: np.random.Generator) -> MissionConfig:
    """The configuration that is believed: a start, and of the published method an impedance, drawn."""
    spin = stream.uniform(0.5, 3.0) * stream.choice([-1, 1]) if name == "becalm" else stream.uniform(0.5, 1.5)
    paths: dict[str, Any] = {
        "simulation.engine": "reduced",
        "judging.time_limit": 20.0,
        "target.initial_spin": float(spin),
        "target.initial_angle": float(stream.uniform(-math.pi, math.pi)),
    }
    if name == "published":
        paths |= {
            "published.impedance.damping": float(stream.uniform(0.0, 8.0)),
            "published.impedance.stiffness": float(stream.uniform(0.0, 60.0)),
        }
    return revised(named_configuration(name), nested(paths))


def truth(config: MissionConfig, model: UncertaintyModel, stream: np.random.Generator, engine: Engine) -> MissionConfig:
    """What is true beside that configuration: drawn as the model says, inertia as the estimator assumes."""
    target, perception, contact = config.target, config.perception, config.contact
    if config.perception.estimator.value == "model_based":
        unsure = perception.assumed_mass_uncertainty, perception.assumed_inertia_uncertainty
        mass, inertia = (1.0 / max(0.2, 1.0 + each * stream.standard_normal()) for each in unsure)
    else:
        mass = math.exp(model.target_mass * stream.standard_normal())
        inertia = math.exp(model.target_inertia * stream.standard_normal())
    stiffer, slower = (
        math.exp(each * stream.standard_normal()) for each in (model.contact_stiffness, model.servo_time_constant)
    )
    noisier = math.exp(model.sensor_noise * stream.standard_normal())
    spreads = {name: value for name, value in perception.noise if isinstance(value, float)}
    noise = {f"perception.noise.{name}": noisier * value for name, value in spreads.items()}
    paths = {
        "target.mass": target.mass * mass,
        "target.inertia": target.inertia * inertia,
        "contact.friction": max(0.0, contact.friction + model.friction * float(stream.uniform(-1.0, 1.0))),
        "contact.stiffness": contact.stiffness * stiffer,
        "contact.solid_stiffness": contact.solid_stiffness * stiffer,
        "robot.servo.time_constant": config.robot.servo.time_constant * slower,
        "simulation.engine": engine.value,
        "simulation.seed": int(stream.integers(0, 2**62)),
        **noise,
    }
    changed = config.model_dump()
    for path, value in paths.items():
        *groups, leaf = path.split(".")
        branch = changed
        for group in groups:
            branch = branch[group]
        branch[leaf] = value
    return MissionConfig.model_validate(changed)  # not `revised`: an inertia may be more than its outline allows


def flown(config: MissionConfig, until: float | None = None) -> Mission:
    """A capture to its verdict, or until that time [s]."""
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    if until is not None:
        mission.advance_unrecorded(round(until / config.control.period))
        return mission
    while mission.outcome is None:
        mission.advance_unrecorded(5000)
    return mission


def foretold(name: str, number: int, futures: int, seed: int, engine: Engine) -> Foretold | None:
    """One case; None if the hands never touched the target."""
    stream = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
    model = UncertaintyModel(**(SENSED if name == "published" else {}))
    believed = nominal(name, stream)
    true = truth(believed, model, stream, engine)
    outcome = flown(true).outcome
    assert outcome is not None, "it was flown to its verdict"
    if not outcome.contacts or outcome.contacts[0].start < 2 * BEFORE_TOUCH:
        return None
    at = float(stream.uniform(BEFORE_TOUCH, outcome.contacts[0].start - BEFORE_TOUCH))
    seen = Situation.of(flown(true, at))
    situation = Situation(seen.mark._replace(config=believed))
    rehearsal = planned(situation, {}, request=None, uncertainty=model, futures=futures, seed=number)
    result = case_result(fly_case(rehearsal, AS_IT_IS, range(futures), threads=cores()))
    return _compared(number, situation.time, result, outcome)


def _compared(number: int, at: float, result: CaseResult, outcome: Outcome) -> Foretold:
    bands = {band.measure: (band.low, band.high) for band in result.bands}
    time = bands.get("time_to_cage")
    return Foretold(
        number=number,
        at=at,
        odds=result.caged.share,
        caged=outcome.caged,
        peak=outcome.peak_tip_force,
        peak_band=bands["peak_tip_force"],
        closed_at=outcome.closed_at if outcome.caged else None,
        closed_band=None if time is None else (at + time[0], at + time[1]),
    )


def summary(cases: Sequence[Foretold]) -> dict[str, Any]:
    """How often the bands held, and how good the odds were."""
    timed = [each for each in cases if each.closed_at is not None and each.closed_band is not None]
    caged = np.array([float(each.caged) for each in cases])
    odds = np.array([each.odds for each in cases])
    return {
        "situations": len(cases),
        "peak force within its 90 % band": _share(
            each.peak_band[0] <= each.peak <= each.peak_band[1] for each in cases
        ),
        "above it": _share(each.peak > each.peak_band[1] for each in cases),
        "time to cage within its 90 % band": _share(
            band[0] - 0.0005 <= closed <= band[1] + 0.0005
            for closed, band in ((each.closed_at, each.closed_band) for each in timed)
            if closed is not None and band is not None
        ),
        "caged": round(float(caged.mean()), 3),
        "Brier score": round(float(((odds - caged) ** 2).mean()), 4),
        "... of guessing the base rate": round(float(caged.mean() * (1.0 - caged.mean())), 4),
        "reliability: odds, real share, situations": reliability(odds, caged),
    }


def reliability(odds: np.ndarray, caged: np.ndarray) -> list[tuple[float, float, int]]:
    """The real share of caged in each fifth of the odds: mean odds, share, situations."""
    place = np.minimum((odds * 5).astype(int), 4)
    found = [(odds[place == fifth], caged[place == fifth]) for fifth in range(5)]
    return [(round(float(said.mean()), 2), round(float(was.mean()), 2), len(said)) for said, was in found if len(said)]


def _share(values: Iterable[bool]) -> float:
    found = list(values)
    return round(sum(found) / len(found), 3) if found else math.nan


def calibrated(name: str, situations: int, futures: int, seed: int, engine: Engine = Engine.REDUCED) -> list[Foretold]:
    """That many cases, whose truth that engine flies."""
    for each in (engine, Engine.REDUCED):
        prepare(revised(named_configuration(name), {"simulation": {"engine": each.value}}), recorded=False)
    cases = (foretold(name, number, futures, seed, engine) for number in range(situations))
    return [each for each in cases if each is not None]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--situations", type=int, default=100)
    parser.add_argument("--futures", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--truth", type=Engine, choices=list(Engine), default=Engine.REDUCED, help="what flies it")
    parser.add_argument("--configuration", choices=("becalm", "published"), action="append")
    chosen = parser.parse_args()
    for name in chosen.configuration or ("becalm", "published"):
        cases = calibrated(name, chosen.situations, chosen.futures, chosen.seed, chosen.truth)
        print(json.dumps({"configuration": name, "truth": chosen.truth.value, **summary(cases)}, indent=2), flush=True)


if __name__ == "__main__":
    main()
