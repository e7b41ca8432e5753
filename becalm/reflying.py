"""`becalm reproduce --experiment`: flies the experiment of the paper, and ours, emulated, and writes a report."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, as_completed
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import click
import numpy as np

from becalm.report.experiment import figures, html
from becalm.reproducing import write_csv
from becalm.studying import INTERRUPTED
from server.link.imperfections import Imperfections
from server.link.virtual_robot import VirtualRobot
from server.reports.style import Picture
from sim.capture.caging import cage
from sim.capture.events import Ticks
from sim.capture.mission import Mission
from sim.compiled import compiling_alone
from sim.control.phases import Command, Phase
from sim.errors import ConfigError, MissionRefused
from sim.reproduction.testbed import FlownTrial, Trial, Truth, measures, summary, trials
from sim.study.executors import LocalProcesses, WorkersUnavailable

_CHUNK = 20
"""Ticks between two looks whether a flight is over."""
_LEEWAY = 2.0
"""After the time limit, by which any verdict has fallen [s]."""


def refly(out: Path, workers: int, seeds: int) -> dict[str, Any]:
    """Fly, draw, write; the document that `--json` prints. Progress goes to standard error.

    Raises:
        ConfigError: `out` is a file.
        MissionRefused: a capture cannot end well, and why.
        WorkersUnavailable: a worker process has died.

    """
    began = time.perf_counter()
    _begin(out)
    flown = trials()
    _say("Preparing the simulation (the first time compiles for a minute or two)")
    _prepare(flown)
    flights = _fly_all(flown, seeds, workers)
    _say("Drawing")
    rows = [measures(flight) for flight in flights]
    document = {
        "seeds": seeds,
        "trials": {trial.name: summary([row for row in rows if row["trial"] == trial.name]) for trial in flown},
        "flights": rows,
    }
    _write(out, document, figures(flown, flights))
    return {**document, "out": str(out), "report": str(_page(out)), "wall_time": time.perf_counter() - began}


def fly(trial: Trial, seed: int) -> FlownTrial:
    """One capture on the emulated testbed, in virtual time."""
    mission, robot = _begun(trial, seed)
    kept: list[Ticks] = []
    limit = trial.config.judging.time_limit + _LEEWAY
    while mission.outcome is None and mission.phase is not Phase.FAULTED and mission.time < limit:
        kept.append(mission.advance(_CHUNK))
    testbed = robot.testbed
    margin = cage(trial.config, testbed.hand_pose(), testbed.state["target_pose"]).margin
    truth = Truth(testbed.peak_force, float(testbed.state["target_twist"][2]), margin)
    ended = "" if mission.outcome is not None else str(mission.fault or "the arms hold without a verdict")
    return FlownTrial(trial.name, seed, trial.config, np.concatenate(kept), mission.outcome, ended, truth)


def _begun(trial: Trial, seed: int) -> tuple[Mission, VirtualRobot]:
    """A mission whose capture is granted.

    Raises:
        MissionRefused: the method says that it cannot end well, and why.

    """
    robot = VirtualRobot(trial.config, Imperfections(), seed)
    mission = Mission(trial.config, robot)
    command = Command.DIRECT_CAGE if trial.direct else Command.CAPTURE
    if speaks_against := mission.refusal(command, on_robot=True):
        raise MissionRefused(f"{trial.title}: {speaks_against}")
    mission.request(command)
    return mission, robot


def _prepare(flown: Sequence[Trial]) -> None:
    """Compile all that is flown: of processes that do so at once, one compiles."""
    with compiling_alone():
        for trial in flown:
            _begun(trial, 0)[0].advance(2)


def _fly_all(flown: Sequence[Trial], seeds: int, workers: int) -> list[FlownTrial]:
    """Every trial with every seed, in their order.

    Raises:
        WorkersUnavailable: a worker process has died.

    """
    pool, count = LocalProcesses(min(workers, seeds * len(flown))), seeds * len(flown)
    try:
        waiting = [pool.submit(fly, trial, seed) for trial in flown for seed in range(seeds)]
        for done, _ in enumerate(as_completed(waiting), 1):
            _show(done, count)
        return [each.result() for each in waiting]
    except KeyboardInterrupt:
        pool.kill()
        _say("\nStopped. Nothing was written")
        sys.exit(INTERRUPTED)
    except BrokenExecutor as error:
        tip = "fewer --workers take less memory; becalm run shows whether the simulation starts at all"
        raise WorkersUnavailable(f"a worker process ended before its capture: {error}", tip=tip) from None
    finally:
        pool.shutdown(cancel_futures=True)


def _show(done: int, count: int) -> None:
    """How many have been flown; a terminal rewrites its line."""
    rewrites = sys.stderr.isatty()
    if rewrites or done == count or done % 10 == 0:
        line = f"Captures: {done} of {count}"
        click.echo(f"\r{line:<40}" if rewrites else line, err=True, nl=not rewrites or done == count)


def _page(out: Path) -> Path:
    return out / "experiment.html"


def _begin(out: Path) -> None:
    if out.exists() and not out.is_dir():
        raise ConfigError(f"--out {out} is a file; give the name of a folder")
    for name in ("figures", "tables"):
        (out / name).mkdir(parents=True, exist_ok=True)


def _write(out: Path, document: dict[str, Any], pictures: dict[str, Picture]) -> None:
    for name, one in pictures.items():
        (out / "figures" / f"experiment_{name}.svg").write_bytes(one.svg)
        (out / "figures" / f"experiment_{name}.png").write_bytes(one.png)
    write_csv(out / "tables" / "experiment.csv", document["flights"])
    (out / "experiment.json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    day = datetime.now(UTC).date().isoformat()
    _page(out).write_text(html(trials(), document, pictures, day), encoding="utf-8")


def _say(line: str) -> None:
    click.echo(line, err=True)


def as_text(document: dict[str, Any]) -> str:
    """What `becalm reproduce --experiment` prints."""
    lines = [f"The experiment on the emulated testbed, {document['seeds']} seeds each", ""]
    for trial in trials():
        found = document["trials"][trial.name]
        peak, low = found["peak_force"], found["least_manipulability"]
        lines.append(
            f"  {trial.title:<22} {found['caged']:>3} of {found['flights']} caged, peak {peak['median']:.2f} N "
            f"({peak['least']:.2f} to {peak['largest']:.2f}), least manipulability {low['median']:.3f} m2 "
            f"({low['least']:.4f} at worst), at a singularity: {found['singular']}"
        )
    return "\n".join([*lines, "", f"Wrote {document['report']}"])
