"""How fast a study flies: `python -m benchmarks.study`, by hand; about two minutes on two cores.

Cells and simulated seconds a second of the published study on all cores, how much faster that is than one worker,
and what the workers' time goes into: physics, control, the rest of a tick (`benchmarks.simulation` tells these
apart), and what is not flying at all: starting processes, the caging test, rows on their way. mission.md asks for
all 484 cells in under two minutes on two cores. `--cells N` flies that many, spread over the study.
"""

from __future__ import annotations

import argparse
import json
import sys
import time

import numpy as np

from benchmarks.simulation import engine_shares
from sim.capture.mission import prepare
from sim.reproduction.published import agreement, published_study
from sim.study.cores import cores
from sim.study.executors import fly_cells, local_workers
from sim.study.run import CellTask, Row, fly_cell

FIGURE = 120.0
"""All 484 cells on two cores [s] (mission.md, "Figures to reach")."""

ALONE = 24
"""Cells flown in this process, to know what a cell costs without workers."""


def tasks(count: int) -> list[CellTask]:
    """That many cells spread evenly over the published study."""
    study = published_study()
    places = np.linspace(0, study.count - 1, count).astype(int)
    return [CellTask(study.base, study.direct, study.cell(int(place))) for place in places]


def flown(cells: int, workers: int) -> tuple[list[Row], float]:
    """The rows of so many cells, and the wall time they took [s]."""
    rows: list[Row] = []
    before = time.perf_counter()
    fly_cells(tasks(cells), rows.append, local_workers(workers).open_executor, at_once=2 * workers)
    return rows, time.perf_counter() - before


def measured(cells: int, workers: int) -> dict[str, float]:
    """Speeds of a study, and how much of the workers' time its cells take."""
    before = time.process_time()
    alone = [fly_cell(task)["duration"] for task in tasks(ALONE)]
    speed_alone = sum(alone) / (time.process_time() - before)
    rows, wall_time = flown(cells, workers)
    _, time_of_one = flown(cells, 1)
    simulated = sum(row["duration"] for row in rows)
    flying = simulated / speed_alone / (workers * wall_time)
    tick = engine_shares(published_study().base.simulation.engine)
    physics, control = tick["plant"], tick["perception and controller"]
    return {
        "workers": workers,
        "cells": len(rows),
        "wall time, s": wall_time,
        "cells a second": len(rows) / wall_time,
        "simulated seconds a second": simulated / wall_time,
        "simulated seconds a second of one core without workers": speed_alone,
        "times as fast as one worker": time_of_one / wall_time,
        "share of the workers' time: physics": flying * physics,
        "share of the workers' time: control": flying * control,
        "share of the workers' time: judge, rows and events of a tick": flying * (1.0 - physics - control),
        "share of the workers' time: not flying": 1.0 - flying,
        "all 484 cells, s": published_study().count / cells * wall_time,
        **{f"agreement with the table of m = {table.mass:g} kg": table.share for table in agreement(rows)},
    }


def main() -> int:
    """Measure and print; exit code 1 if the figure of the mission is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cells", type=int, default=published_study().count)
    parser.add_argument("--workers", type=int, default=cores())
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    prepare(published_study().base)
    figures = measured(arguments.cells, arguments.workers)
    if arguments.json:
        print(json.dumps(figures, indent=2))
    else:
        for label, value in figures.items():
            print(f"  {value:10.3g}  {label}")
        print(f"\nAll cells: {figures['all 484 cells, s']:.0f} s; figure to reach: {FIGURE:.0f} s on two cores")
    return 0 if figures["all 484 cells, s"] <= FIGURE else 1


if __name__ == "__main__":
    sys.exit(main())
