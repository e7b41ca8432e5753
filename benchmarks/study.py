"""How fast a study flies: `python -m benchmarks.study`, by hand; about a minute on two cores.

Cells and simulated seconds a second of the published study on all cores, and what of the cores' time is flying:
the processor time that cells take in one process over the workers' time. mission.md asks for all 484 cells in under two
minutes on two cores. `--cells N` flies that many, spread over the study.
"""

from __future__ import annotations

import argparse
import json
import sys
import time

import numpy as np

from sim.capture.mission import prepare
from sim.study.cores import cores
from sim.study.executors import fly_cells, local_workers
from sim.study.published import PUBLISHED_STUDY, agreement
from sim.study.run import CellTask, Row, fly_cell

FIGURE = 120.0
"""All 484 cells on two cores [s] (mission.md, "Figures to reach")."""

ALONE = 24
"""Cells flown in this process, to know what a cell costs without workers."""


def tasks(count: int) -> list[CellTask]:
    """That many cells spread evenly over the published study."""
    study = PUBLISHED_STUDY
    places = np.linspace(0, study.count - 1, count).astype(int)
    return [CellTask(study.base, study.direct, study.cell(int(place))) for place in places]


def measured(cells: int, workers: int) -> dict[str, float]:
    """Speeds of a study, and how much of the workers' time its cells take."""
    before = time.process_time()
    alone = [fly_cell(task)["duration"] for task in tasks(ALONE)]
    speed_alone = sum(alone) / (time.process_time() - before)
    rows: list[Row] = []
    before = time.perf_counter()
    fly_cells(tasks(cells), rows.append, local_workers(workers).open_executor, at_once=2 * workers)
    wall_time = time.perf_counter() - before
    simulated = sum(row["duration"] for row in rows)
    whole = PUBLISHED_STUDY.count / cells * wall_time
    return {
        "workers": workers,
        "cells": len(rows),
        "wall time, s": wall_time,
        "cells a second": len(rows) / wall_time,
        "simulated seconds a second": simulated / wall_time,
        "simulated seconds a second of one core without workers": speed_alone,
        "share of the workers' time that the cells need alone": simulated / speed_alone / (workers * wall_time),
        "all 484 cells, s": whole,
        **{f"agreement with the table of m = {table.mass:g} kg": table.share for table in agreement(rows)},
    }


def main() -> int:
    """Measure and print; exit code 1 if the figure of the mission is missed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cells", type=int, default=PUBLISHED_STUDY.count)
    parser.add_argument("--workers", type=int, default=cores())
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    prepare()
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
