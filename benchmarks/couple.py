"""How well the co-moving couple captures: `python -m benchmarks.couple --seeds 200`, by hand.

Flies the sample of docs/benchmarks.md, one case a seed: spins of both signs, any angle, a target that is out of place
and drifts, mass, inertia and friction that the controller does not know, noise on every reading. Prints how many were
caged with Wilson's interval, the largest force of a hand over the whole sequence, when the arms were locked, how far
the base turned and the least manipulability, and one line for each failure. A case takes about 0.05 s on the reduced
plant; `--late`, `--stamp-error`, `--servo`, `--spread`, `--bias`, `--friction` and `--set` change what is flown.
`--ablations` prints a table with each part of the method left out, `--cells` what the 484 cells of the published study
come to with their impedance imposed.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

from becalm.typed import parse_setting
from sim.capture.mission import Mission
from sim.config import MissionConfig, TargetConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command, Phase
from sim.method.co_moving_couple.memory import Dropped, Trouble
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, published_study

SPINS = (0.5, 3.0)
SPREAD = 0.3
FRICTIONS = (0.1, 0.5)
_CHUNK = 10  # ticks between two looks at the base
_LIMIT = 22.0  # of a case, in which a sequence holds or is judged long before [s]


def sample(**changes: Any) -> MissionConfig:
    """The sample's configuration, `becalm` on the reduced plant; changes by full path, with `__` for the dot."""
    paths = {path.replace("__", "."): value for path, value in changes.items()}
    shared = {"simulation.engine": "reduced", "judging.time_limit": 12.0}
    return revised(named_configuration("becalm"), nested({**shared, **paths}))


def case(
    seed: int,
    spins: tuple[float, float] = SPINS,
    spread: float = SPREAD,
    frictions: tuple[float, float] = FRICTIONS,
    target: TargetConfig | None = None,
) -> dict[str, Any]:
    """What that seed draws: of the target, beside what is as assumed (the default one's), and of the sensors' noise."""
    draws, target = np.random.default_rng(seed), target or MissionConfig().target
    spin = draws.uniform(*spins) * draws.choice([-1, 1])
    angle, speed, way = draws.uniform(-math.pi, math.pi), draws.uniform(0, 0.01), draws.uniform(-math.pi, math.pi)
    mass, inertia = draws.uniform(1.0 - spread, 1.0 + spread, 2)
    friction = draws.uniform(*frictions)
    return {
        "simulation": {"seed": seed},
        "target": {
            "initial_spin": float(spin),
            "initial_angle": float(angle),
            "initial_x": float(draws.uniform(-0.02, 0.02)),
            "initial_y": 0.35 + float(draws.uniform(-0.02, 0.02)),
            "initial_velocity_x": float(speed * math.cos(way)),
            "initial_velocity_y": float(speed * math.sin(way)),
            "mass": float(target.mass * mass),
            "inertia": float(target.inertia * inertia),
        },
        "contact": {"friction": float(friction)},
    }


class Capture(NamedTuple):
    """How one case ended."""

    seed: int
    spin: float
    caged: bool
    peak: float
    """Largest resultant of a hand's tips, whole sequence [N]."""
    locked_at: float
    """[s]; not a number if the arms never locked."""
    base: float
    """Largest rotation of the base [deg]."""
    manipulability: float
    """Least of both arms [m2]."""
    inertia: float
    """Believed at last, over the true one."""
    inertia_deviation: float
    """... and how many of its standard deviations it is off."""
    account: str
    """One line on how it went."""


def fly(base: MissionConfig, changes: Mapping[str, Any]) -> Capture:
    """Fly one case to its verdict, or until the arms hold without one."""
    config = revised(base, changes)
    mission, turned = Mission(config), 0.0
    mission.request(Command.CAPTURE)
    last, stages = (-1, -1), []
    while mission.outcome is None and mission.time < _LIMIT:
        rows = mission.advance(_CHUNK)
        turned = max(turned, float(np.abs(rows["base_pose"][:, 2]).max()))
        if (now := (int(rows[-1]["phase"]), int(rows[-1]["activity"]))) != last:
            last = now
            stages.append(
                f"{mission.activity.name.lower() if now[1] else Phase(now[0]).name.lower()} {mission.time:.1f}"
            )
    mark, outcome = mission.mark(), mission.outcome
    own, known, target = mark.own[0], mark.flight[0]["known"], config.target
    trouble = Trouble(int(own["trouble"])).name.lower()
    dropped = {kind.name.lower(): int(count) for kind, count in zip(Dropped, own["dropped"], strict=True) if count}
    wrong = float(known["target_inertia"]) - target.inertia
    return Capture(
        seed=config.simulation.seed,
        spin=target.initial_spin,
        caged=outcome is not None and outcome.caged,
        peak=math.nan if outcome is None else outcome.peak_tip_force,
        locked_at=math.nan if outcome is None or outcome.locked_at is None else outcome.locked_at,
        base=math.degrees(turned),
        manipulability=math.nan if outcome is None else outcome.min_manipulability,
        inertia=1.0 + wrong / target.inertia,
        inertia_deviation=abs(wrong) / float(known["target_inertia_deviation"]),
        account=f"{outcome.outcome.value if outcome else 'no verdict'}, {trouble}, {dropped}: {', '.join(stages)}",
    )


def _quantiles(values: Sequence[float], *levels: float, digits: int = 3) -> list[float]:
    finite = [value for value in values if math.isfinite(value)]
    return [round(float(np.quantile(finite, level)), digits) if finite else math.nan for level in levels]


def summary(captures: Sequence[Capture]) -> dict[str, Any]:
    """Figures of a sample; times of those that are caged."""
    caged = [each for each in captures if each.caged]
    interval = binomtest(len(caged), len(captures)).proportion_ci(method="wilson")
    learnt = [each for each in captures if each.caged and abs(each.spin) > 0.5]
    return {
        "cases": len(captures),
        "caged": len(caged),
        "Wilson's interval, 95 %": [round(interval.low, 4), round(interval.high, 4)],
        "peak of a hand's force, N, 50 / 95 / 99.9 % / largest": _quantiles(
            [each.peak for each in captures], 0.5, 0.95, 0.999, 1.0
        ),
        "locked at, s, 50 / 95 % / last": _quantiles([each.locked_at for each in caged], 0.5, 0.95, 1.0),
        "rotation of the base, deg, 50 / 95 %": _quantiles([each.base for each in captures], 0.5, 0.95),
        "least manipulability, m2": _quantiles([each.manipulability for each in captures], 0.0, digits=5)[0],
        "inertia within 5 %": round(float(np.mean([abs(each.inertia - 1.0) < 0.05 for each in learnt])), 3),
        "its interval of 95 % covers": round(float(np.mean([each.inertia_deviation < 1.96 for each in learnt])), 3),
    }


class Without(NamedTuple):
    """One part of the method left out."""

    words: str
    changes: Mapping[str, Any]


_COUPLE = "co_moving_couple"
ABLATIONS = (
    Without("nothing", {}),
    Without("hands that move with their faces", {f"{_COUPLE}.without": "following"}),
    Without("a closing that turns with the target", {f"{_COUPLE}.without": "turning"}),
    Without("the lean of the hands' axis", {f"{_COUPLE}.without": "lean"}),
    Without("base rotation and manipulability in plans", {f"{_COUPLE}.without": "prediction"}),
    Without("the model-based estimator", {"perception.estimator": "none"}),
    Without("smoothing of the wrists", {"perception.force_smoothing_time": 0.0}),
    Without("the integral of the force's error", {f"{_COUPLE}.touch.integral_limit": 0.0}),
    Without("waiting for the other hand at first touch", {f"{_COUPLE}.touch.equalising_time": 0.0}),
    Without("tips that slide outwards as planned", {f"{_COUPLE}.touch.slip": 0.0}),
    Without("drift control", {f"{_COUPLE}.touch.drift_part": 0.0}),
    Without("spin that is left on purpose", {f"{_COUPLE}.touch.spin_left": 0.0}),
    Without("the squeeze", {f"{_COUPLE}.closing.squeeze_time": 0.0}),
    Without("damping near singularities", {"control.rates.singularity_handling": "pseudo_inverse"}),
    Without(
        "second tries",
        {f"{_COUPLE}.search.most_failures": 1, f"{_COUPLE}.search.patience": 0.0, f"{_COUPLE}.touch.most_touches": 1},
    ),
)


def ablations(base: MissionConfig, seeds: range) -> None:
    """Print a row of a Markdown table for each part left out, on the same cases."""
    print(
        "| without | caged | peak N, 50 / 95 % | locked at s, 50 / 95 % | base deg, 50 / 95 % |\n|---|---|---|---|---|"
    )
    for without in ABLATIONS:
        config = revised(base, nested(dict(without.changes)))
        flown = [fly(config, case(seed)) for seed in seeds]
        caged = [each for each in flown if each.caged]
        columns = (
            _quantiles([each.peak for each in flown], 0.5, 0.95, digits=2),
            _quantiles([each.locked_at for each in caged], 0.5, 0.95, digits=1),
            _quantiles([each.base for each in flown], 0.5, 0.95, digits=0),
        )
        texts = [" / ".join(f"{value:g}" for value in column) if caged else "none" for column in columns]
        print(f"| {without.words} | {len(caged)} of {len(flown)} | {' | '.join(texts)} |", flush=True)


def cells(base: MissionConfig) -> None:
    """Print how the 484 cells of the published study go with their m, d and k imposed about the moving face."""
    imposed, flown = f"{_COUPLE}.touch.imposed", []
    for mass, damping, stiffness in product(
        *(published_study().grid[path].listed() for path in (MASS, DAMPING, STIFFNESS))
    ):
        values = {f"{imposed}_mass": mass, f"{imposed}_damping": damping, f"{imposed}_stiffness": stiffness}
        flown.append(fly(base, nested(values)))
        if not flown[-1].caged:
            print(f"m {mass:g}, d {damping:g}, k {stiffness:g}: {flown[-1].account}", file=sys.stderr, flush=True)
    for label, value in summary(flown).items():
        print(f"  {label}: {value if not isinstance(value, list) else ' / '.join(map(str, value))}")


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=200, help="how many cases")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--engine", default="reduced", help="reduced or pymunk")
    parser.add_argument(
        "--spin", type=float, nargs=2, default=SPINS, metavar=("LO", "HI"), help="sizes of spins, rad/s"
    )
    parser.add_argument("--spread", type=float, default=SPREAD, help="of mass and inertia, each way")
    parser.add_argument("--friction", type=float, nargs=2, default=FRICTIONS, metavar=("LO", "HI"))
    parser.add_argument("--bias", type=float, help="standard deviation of the wrists' bias, N")
    parser.add_argument("--servo", type=float, help="time constant of the joints' servos, s")
    parser.add_argument("--late", type=float, help="motion capture that is so late, s, in place of every tick's poses")
    parser.add_argument("--stamp-error", type=float, default=0.0, help="... and whose stamps are so wrong, s")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="any other parameter")
    parser.add_argument("--ablations", action="store_true", help="the same cases with each part left out, as a table")
    parser.add_argument("--cells", action="store_true", help="the 484 cells of the published study, m, d, k imposed")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    return parser


def _configuration(arguments: argparse.Namespace) -> MissionConfig:
    changes: dict[str, Any] = {"simulation.engine": arguments.engine}
    if arguments.bias is not None:
        changes["perception.imperfections.force_bias"] = arguments.bias
    if arguments.servo is not None:
        changes["robot.servo.time_constant"] = arguments.servo
    if arguments.late is not None:
        changes["perception.source"] = "motion_capture"
        changes["perception.capture.delay"] = arguments.late
        changes["perception.capture.stamp_error"] = arguments.stamp_error
    config = revised(sample(), nested(changes))
    for setting in arguments.set:
        config = revised(config, parse_setting(setting))
    return config


def main() -> int:
    """Fly and print; exit code 1 if fewer than 99.5 % are caged."""
    parser = _arguments()
    arguments = parser.parse_args()
    if arguments.stamp_error and arguments.late is None:
        parser.error("--stamp-error is of motion capture: give --late, too")
    base, begun, captures = _configuration(arguments), time.perf_counter(), []
    if arguments.cells or arguments.ablations:
        if arguments.cells:
            cells(base)
        if arguments.ablations:
            ablations(base, range(arguments.first, arguments.first + arguments.seeds))
        return 0
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        captured = fly(
            base, case(seed, tuple(arguments.spin), arguments.spread, tuple(arguments.friction), base.target)
        )
        captures.append(captured)
        if not captured.caged:
            text = f"seed {seed}, {captured.spin:.2f} rad/s, {captured.peak:.2f} N: {captured.account}"
            print(text, file=sys.stderr, flush=True)
    figures = summary(captures)
    if arguments.json:
        print(json.dumps(figures, indent=2))
    else:
        for label, value in figures.items():
            print(f"  {label}: {value if not isinstance(value, list) else ' / '.join(map(str, value))}")
        print(f"  a case takes {(time.perf_counter() - begun) / len(captures):.2f} s")
    return 0 if figures["caged"] >= 0.995 * len(captures) else 1


if __name__ == "__main__":
    sys.exit(main())
