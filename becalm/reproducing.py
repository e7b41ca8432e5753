"""`becalm reproduce`: flies what the paper shows, and writes a report with its figures and tables."""

from __future__ import annotations

import json
import multiprocessing
import sys
import time
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import click
import pyarrow as pa

from becalm.report.document import ShownExample, ablation_figure, figures, html
from becalm.studying import INTERRUPTED, show_progress
from server.reports.style import Picture
from sim.capture.mission import prepare
from sim.configurations import named_configuration
from sim.errors import ConfigError
from sim.reproduction.experiments import ABLATIONS, ablation_study, fly_row, fly_whole, impedance_of, tables_study
from sim.reproduction.findings import Captures, Reproduction, findings, reproduction
from sim.study.design import Study
from sim.study.executors import local_workers
from sim.study.export import TableFormat, export
from sim.study.flight import StudyFlight
from sim.study.run import Row
from sim.study.table import StudyTable, fingerprint
from sim.tabular import csv_header, csv_rows


class Folder(NamedTuple):
    """Where everything goes."""

    path: Path

    @property
    def report(self) -> Path:
        """The page."""
        return self.path / "report.html"

    def begin(self) -> None:
        """Make the folder and what is in it.

        Raises:
            ConfigError: it is a file.

        """
        if self.path.exists() and not self.path.is_dir():
            raise ConfigError(f"--out {self.path} is a file; give the name of a folder")
        for name in ("figures", "tables", "cells"):
            (self.path / name).mkdir(parents=True, exist_ok=True)

    def cells(self, study: Study) -> Path:
        """Where the rows of a study are kept, so that the next time flies only what is missing."""
        return self.path / "cells" / f"{study.name}-{fingerprint(study)[:12]}.sqlite"


def reproduce(out: Path, workers: int, every: int, *, ablate: bool) -> dict[str, Any]:
    """Fly, draw, write; the document that `--json` prints. Progress goes to standard error.

    Raises:
        ConfigError: it is not a folder.
        TableUnusable: the rows cannot be kept.
        WorkersUnavailable: no worker process can be started.

    """
    began = time.perf_counter()
    folder = Folder(out)
    folder.begin()
    _say("Preparing the simulation (the first time compiles for about half a minute)")
    prepare(named_configuration("published"))
    found = _flown(folder, workers, every, ablate=ablate)
    document = findings(found)
    _say("Flying the typical cells again")
    study = tables_study("published", every)
    shown = [ShownExample(example, fly_row(study, example.row)) for example in found.examples]
    _say("Drawing")
    pictures = figures(found, shown)
    if document["ablations"]:
        kappa = document["overall"]["published"]["success_kappa"]
        pictures["ablations"] = ablation_figure(document["ablations"], kappa)
    _write(folder, found, document, pictures)
    return {**document, "out": str(out), "report": str(folder.report), "wall_time": time.perf_counter() - began}


def _flown(folder: Folder, workers: int, every: int, *, ablate: bool) -> Reproduction:
    """Everything that is flown, in the order in which it can be waited for."""
    _say("Flying the captures that the report shows in full")
    captures = Captures(
        direct=fly_whole(named_configuration("published"), direct=True),
        representative=fly_whole(named_configuration("published")),
        figures=fly_whole(named_configuration("published_figures")),
    )
    published, as_printed = (_rows(folder, tables_study(name, every), workers) for name in ("published", "as_printed"))
    chosen = ABLATIONS if ablate else ()
    ablations = [(ablation, _rows(folder, ablation_study(ablation, every), workers)) for ablation in chosen]
    return reproduction(every, captures, published, as_printed, ablations)


def _rows(folder: Folder, study: Study, workers: int) -> Sequence[Row]:
    """The rows of a study: those that are kept, and the missing ones flown; its table is written."""
    with StudyTable(folder.cells(study), study) as table:
        missing = study.count - len(table)
        _say(f"{study.name}: {missing} of {study.count} cells to fly" if missing else f"{study.name}: all cells kept")
        if missing:
            _fly(table, workers)
        export(table, folder.path / "tables" / f"cells_{study.name}.csv", TableFormat.CSV)
        return list(table.rows())


def _fly(table: StudyTable, workers: int) -> None:
    flight, show = StudyFlight(table), show_progress()
    try:
        flight.fly(local_workers(workers), on_row=lambda _: show(flight.progress))
    except KeyboardInterrupt:
        for worker in multiprocessing.active_children():
            worker.terminate()
        _say("\nStopped. What was flown is kept; the same command resumes it")
        sys.exit(INTERRUPTED)
    if sys.stderr.isatty():
        _say("")


def _write(folder: Folder, found: Reproduction, document: Mapping[str, Any], pictures: Mapping[str, Picture]) -> None:
    for name, one in pictures.items():
        (folder.path / "figures" / f"{name}.svg").write_bytes(one.svg)
        (folder.path / "figures" / f"{name}.png").write_bytes(one.png)
    tables = folder.path / "tables"
    agreements = [
        {"configuration": name, **table}
        for name in ("published", "as_printed")
        for table in document["agreement"][name]
    ]
    write_csv(tables / "agreement.csv", agreements)
    write_csv(tables / "first_touch.csv", [_first_touch_row(cell) for cell in found.cells])
    write_csv(tables / "ablations.csv", document["ablations"])
    (folder.path / "summary.json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    day = datetime.now(UTC).date().isoformat()
    folder.report.write_text(html(found, document, pictures, day), encoding="utf-8")


def _first_touch_row(cell: Any) -> dict[str, Any]:
    """What the first touch of a cell left, and what the models say."""
    place = impedance_of(cell.row)
    return {
        **place._asdict(),
        "success": str(cell.success).lower(),
        "damping_ratio": cell.ratio,
        **{f"{kind}_{name}": getattr(getattr(cell, kind), name)
           for kind in ("measured", "planar", "closed_form") for name in ("spin", "drift")},
    }  # fmt: skip


def write_csv(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Rows of the same names as a table; no file without rows."""
    if not rows:
        path.unlink(missing_ok=True)
        return
    batch = pa.RecordBatch.from_pylist(list(rows))
    with path.open("wb") as file:
        file.writelines([csv_header(batch.schema), *csv_rows(batch)])


def _say(line: str) -> None:
    click.echo(line, err=True)


def as_text(document: Mapping[str, Any]) -> str:
    """What `becalm reproduce` prints."""
    touch = document["first_touch"]
    lines = [f"Reproduction of {document['cells']} cells", ""]
    for name in ("published", "as_printed"):
        for table in document["agreement"][name]:
            lines.append(
                f"  {name:<11} m = {table['mass']:g} kg: {table['agreeing']} of {table['cells']} in the same class "
                f"(kappa {table['kappa']:.2f}), {table['success_agreeing']} by success or failure "
                f"(kappa {table['success_kappa']:.2f})"
            )
    lines += [
        "",
        f"The first touch alone predicts success and failure with kappa {touch['kappa_measured']:.2f} "
        f"(by a collision model without robot or planner: {touch['kappa_planar']:.2f}).",
        "",
        f"Wrote {document['report']}",
    ]
    return "\n".join(lines)
