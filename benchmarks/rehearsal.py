"""How fast futures fly: `python -m benchmarks.rehearsal`, by hand; about a minute.

100 futures of up to 20 s on two cores, of our own method with its noise and of the published one, from the start; how
that compares with headless captures of the same configuration in the same run, one after another on one core, and what
the threads lose. Then an atlas of 11 by 11 cells with 3 futures each. mission.md asks for 1.5 s and 5 s on two cores.
With `--live` in place of that: how many turns of a live mission are later than 5 ms while nothing else is done, and
while one rehearsal after another is flown beside it, in turn; mission.md asks for no more than 0.1 % more of them.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import httpx

from benchmarks.service import Running, command, later_than, service
from sim.capture.mission import Mission, prepare
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.rehearsal.atlas import axis_between, fly_atlas_cells, planned_atlas
from sim.rehearsal.rehearsal import AS_IT_IS, SETTLE, fly_case, planned, prepare_futures
from sim.rehearsal.situation import Situation
from sim.rehearsal.summary import case_result
from sim.rehearsal.uncertainty import UncertaintyModel

FIGURE, ATLAS_FIGURE = 1.5, 5.0
"""Of 100 futures and of an atlas, on two quiet cores [s]."""

ALONE = 10
"""Headless captures that the rate is compared with."""

AXES = {
    "becalm": (("contact.friction", 0.1, 0.5), ("target.inertia", 0.006, 0.013)),
    "published": (("published.impedance.damping", 0.0, 15.0), ("published.impedance.stiffness", 0.0, 100.0)),
}


def headless_rate(config: MissionConfig) -> float:
    """Simulated seconds a second of processor time, headless, one capture after another."""
    prepare(config, recorded=False)
    before, simulated = time.process_time(), 0.0
    for seed in range(ALONE):
        judged = nested({"simulation.seed": seed, "judging.hold_time": SETTLE})
        simulated += run_capture(revised(config, judged)).simulated_time
    return simulated / (time.process_time() - before)


def measured(name: str, futures: int, threads: int) -> dict[str, Any]:
    """Times and rates of that named configuration."""
    config = revised(named_configuration(name), {"simulation": {"engine": "reduced"}})
    rate, situation = headless_rate(config), Situation.of(Mission(config))
    rehearsal = planned(situation, {}, request=Command.CAPTURE, uncertainty=UncertaintyModel(), futures=futures)
    prepare_futures(rehearsal)
    fly_case(rehearsal, AS_IT_IS, range(2), threads=1)
    wall, processor = time.perf_counter(), time.process_time()
    flown = fly_case(rehearsal, AS_IT_IS, range(futures), threads=threads)
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    counting = time.perf_counter()
    result = case_result(flown)
    counting = time.perf_counter() - counting
    simulated = sum(each.outcome.duration for each in flown)
    return {
        "configuration": name,
        "futures": futures,
        "threads": threads,
        "wall time [s]": round(wall, 2),
        "processor time [s]": round(processor, 2),
        "figure [s]": FIGURE,
        "counting [s]": round(counting, 2),
        "mean future [s of mission]": round(simulated / futures, 2),
        "of the headless rate, by processor time": round(simulated / processor / rate, 2),
        "headless rate [s/s]": round(rate),
        "threads kept busy": round(processor / wall / threads, 2),
        "caged": result.caged.futures,
    }


def atlas_time(name: str, size: int, threads: int) -> dict[str, Any]:
    """The time of an atlas of that many values on both axes, three futures a cell."""
    config = revised(named_configuration(name), {"simulation": {"engine": "reduced"}})
    x, y = (axis_between(*bounds, size, axis) for bounds, axis in zip(AXES[name], "xy", strict=True))
    atlas = planned_atlas(
        Situation.of(Mission(config)),
        {},
        x,
        y,
        request=Command.CAPTURE,
        uncertainty=UncertaintyModel(),
        futures=3,
        seed=0,
        horizon=20.0,
    )
    before = time.perf_counter()
    cells = fly_atlas_cells(atlas, atlas.cells(), threads=threads)
    wall = time.perf_counter() - before
    return {"configuration": name, "cells": len(cells), "wall time [s]": round(wall, 2), "figure [s]": ATLAS_FIGURE}


def live(spells: int, duration: float) -> dict[str, Any]:
    """Shares of late turns of a live mission, in spells of that duration [s] without and with rehearsals in turn."""
    shares: dict[bool, list[float]] = {False: [], True: []}
    flown = 0
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as running:
        _rehearse_for(running, 1.0)  # its worker loads what it runs
        for spell in range(2 * spells):
            busy = bool(spell % 2)
            for name in ("reset", "capture"):
                command(running, name)
            before = running.samples()
            if busy:
                flown += _rehearse_for(running, duration)
            else:
                time.sleep(duration)
            shares[busy].append(later_than(before, running.samples(), "0.005"))
    return {
        "turns later than 5 ms, nothing else done": [round(share, 4) for share in shares[False]],
        "... beside rehearsals": [round(share, 4) for share in shares[True]],
        "more of them": round((sum(shares[True]) - sum(shares[False])) / spells, 5),
        "figure": 0.001,
        "futures flown beside it": flown,
    }


def _rehearse_for(running: Running, duration: float) -> int:
    """One rehearsal after another for that long [s]; how many futures."""
    until, flown = time.monotonic() + duration, 0
    while time.monotonic() < until:
        begun = httpx.post(running.api + "/rehearsals", json={"request": None, "horizon": 8.0}, timeout=30)
        if begun.status_code == 409:  # the capture has not begun yet, or is over
            time.sleep(0.05)
            continue
        address = f"{running.api}/rehearsals/{begun.raise_for_status().json()['id']}"
        while (told := httpx.get(address, timeout=30).json())["status"] in ("queued", "running"):
            time.sleep(0.05)
        flown += told["progress"]["done"]
    return flown


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--futures", type=int, default=100)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--size", type=int, default=11, help="values of an axis of the atlas")
    parser.add_argument("--live", action="store_true", help="beside a live mission")
    parser.add_argument("--spells", type=int, default=3, help="with --live: of each kind")
    chosen = parser.parse_args()
    if chosen.live:
        print(json.dumps(live(chosen.spells, 20.0), indent=2))
        return
    for name in AXES:
        print(json.dumps(measured(name, chosen.futures, chosen.threads), indent=2))
        print(json.dumps(atlas_time(name, chosen.size, chosen.threads), indent=2), flush=True)


if __name__ == "__main__":
    main()
