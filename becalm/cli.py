"""The commands that people type.

A bad argument or configuration exits with 2 and names field, value and bound; anything else that fails exits with 1.
"""

from __future__ import annotations

import errno
import json
import os
import sys
from functools import reduce
from pathlib import Path
from typing import Any

import click

from becalm.ending import end_when_asked
from becalm.setting_options import setting_options
from becalm.tokens import token
from becalm.typed import number_option, parse_setting
from server.settings import Settings, choose
from server.versions import becalm_version
from sim.config import MissionConfig
from sim.configurations import (
    DEFAULT_CONFIGURATION,
    merged,
    named_configuration,
    revised,
)
from sim.errors import CaptureError, ConfigError
from sim.schema_history import Read
from sim.stored import read_parameters_file

EXAMPLES = """\b
Examples:
  becalm serve                 start the console and open its page
  becalm run --json            fly one capture headless
  becalm rehearse latest --at 0
                               odds of a capture from a recorded state
  becalm fit latest            which numbers explain a recorded run
  becalm study published --out published.csv
                               fly the paper's parametric study on all cores
  becalm reproduce --out reproduction
                               reproduce the paper and explain the result in a report
  becalm robot --listen tcp/127.0.0.1:7447
                               an emulated robot for becalm serve --plant zenoh
  becalm COMMAND --help        options and more examples
"""

SERVE_EXAMPLES = """\b
Examples:
  becalm serve
  becalm serve --port 8080 --no-open
  becalm serve --configuration published --set published.impedance.damping=3.0
  becalm serve --plant zenoh --connect tcp/127.0.0.1:7447
  becalm serve --settings lab.toml --check

\b
A settings file (TOML or JSON) names settings as the options do, with underscores:
  port = 8080
  data_dir = "/srv/becalm"
  log_format = "json"
\b
  [changes]                    # of parameters, as --config takes them
  published.impedance.damping = 3.0

\b
Every option but --set, --config, --check, --json and --open has a variable, such as
BECALM_DATA_DIR. Options win over variables, which win over the settings file.
"""

RUN_EXAMPLES = """\b
Examples:
  becalm run
  becalm run --direct --json
  becalm run --configuration published_figures --log capture.mcap
  becalm run --set target.initial_spin=0.8 --set published.impedance.mass=0.05 --seed 7
  becalm run --configuration published_figures --cross-check
"""

ROBOT_EXAMPLES = """\b
Examples:
  becalm robot --listen tcp/127.0.0.1:7447 --seed 1
  becalm robot --listen tcp/127.0.0.1:7447 --set target.initial_spin=0.8 --imperfection force_noise=0.05
  becalm robot --listen tcp/127.0.0.1:7447 --fault loss=0.05 --fault joint_stuck=left_joint_2@12
  becalm robot --listen tls/0.0.0.0:7447 --tls-certificate robot.pem --tls-key robot.key --users users.txt

\b
Faults: delay, jitter [s], loss, sensor_freeze (joints, left_wrist, right_wrist, base, target), joint_stuck,
mute (a message: robot/mode, base/pose ...), hang [s], restart [s away]; from the start, or from @SECONDS after it.
"""

REPLAY_EXAMPLES = """\b
Examples:
  becalm replay 20261122T113000123-4f9a2c
  becalm replay latest --json

Ends with 1 if anything differs, by a single bit.
"""

REHEARSE_EXAMPLES = """\b
Examples:
  becalm rehearse latest --at 0
  becalm rehearse 20261122T113000123-4f9a2c --at 2.5 --set published.impedance.damping=6
  becalm rehearse latest --at 0 --request capture --futures 1000 --uncertainty lab.toml --json

\b
An uncertainty file (TOML or JSON) names what differs from the model's defaults (docs/rehearsal.md):
  target_inertia = 0.3         # relative
  friction = 0.1               # either way
"""

FIT_EXAMPLES = """\b
Examples:
  becalm fit latest
  becalm fit 20261122T113000123-4f9a2c --parameters contact.stiffness,contact.damping --out fit.html
  becalm fit RUN RUN --held-out RUN --keep-as "as the robot is" --json

\b
What can be fitted: parameters of contact, servos, base and target by their full paths,
perception.capture.stamp_error, command.delay, table.drag, table.tilt_x, table.tilt_y,
perception.wrist.left.gain, .bias_x, .bias_y, .bias_torque, and those of the right (docs/fit.md).
"""

IMPORT_EXAMPLES = """\b
Examples:
  becalm import monday.csv --map lab.toml
  becalm import bag.mcap --map lab.toml --json

\b
A map (TOML) says which column, or in MCAP which TOPIC:PATH, is what (docs/fit.md):
  configuration = "testbed"
  time = { source = "t", unit = "s" }
  [joint_angle]
  left = ["q1", "q2", "q3"]
  right = ["q4", "q5", "q6"]
  unit = "rad"
  [base_pose]
  x = "base_x"
  y = "base_y"
  angle = "base_yaw"
"""

STUDY_EXAMPLES = """\b
Examples:
  becalm study published --out published.csv
  becalm study published --out finer.parquet --set simulation.time_step=0.0005
  becalm study spins.toml --out spins.json --seed 7 --workers 4 --json
  becalm study spins.toml --out spins.csv --scheduler tcp://127.0.0.1:8786

\b
A study file (TOML or JSON) names a configuration and what varies over it:
  configuration = "published"
  seed = 1
\b
  [changes]
  contact.friction = 0.25
\b
  [grid]
  published.impedance.damping = { from = 0.0, to = 6.0, step = 1.5 }
  published.impedance.mass = [0.05, 0.1]
\b
  [samples]
  count = 64
  method = "sobol"             # or latin_hypercube, random
  [samples.over]
  target.initial_spin = { from = 0.5, to = 2.0 }
  target.mass = { mean = 2.35, deviation = 0.1 }

Ctrl-C stops a study; the same command resumes it.
"""


REPORT_EXAMPLES = """\b
Examples:
  becalm report latest --out run.pdf
  becalm report 20261122T113000123-4f9a2c --out appendix.html
"""

REPRODUCE_EXAMPLES = """\b
Examples:
  becalm reproduce
  becalm reproduce --out reproduction --ablations --json
  becalm reproduce --every 5   a coarse study, within half a minute
  becalm reproduce --experiment --seeds 20
                               the paper's experiment, on the emulated robot

\b
In the folder:
  report.html                  one page that needs nothing else; prints well
  figures/                     its figures, PNG and SVG
  tables/                      every cell, agreement, first touches, ablations, CSV
  summary.json                 every number of the report
  experiment.html, .json       likewise, of --experiment

What was flown is kept in the folder: the same command resumes it.
"""


class _Commands(click.Group):
    """Turns what Becalm refuses into messages and exit codes, in one place."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except ConfigError as error:
            raise click.UsageError(_formatted(error)) from None
        except CaptureError as error:
            raise click.ClickException(_formatted(error)) from None
        except OSError as error:
            if error.errno == errno.EPIPE:
                raise  # the reader of our output has gone; click ends quietly
            raise click.ClickException(_file_error(error)) from None


def _formatted(error: CaptureError) -> str:
    return f"{error}\nTip: {error.tip}" if error.tip else str(error)


def _file_error(error: OSError) -> str:
    """What the system refused, with the name of the file where it has said one."""
    reason = error.strerror or str(error) or type(error).__name__
    return f"{error.filename}: {reason}" if error.filename is not None else reason


@click.group(
    "becalm",
    cls=_Commands,
    epilog=EXAMPLES,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(becalm_version(), prog_name="becalm")
def main() -> None:
    """Calm a spinning piece of debris with a dual-arm free-flying robot, then cage it."""


def _configured(command: Any) -> Any:
    """The options by which a command takes a configuration."""
    for option in (
        click.option("--set", "settings", metavar="PATH=VALUE", multiple=True, help="Set one parameter; repeatable."),
        click.option("--config", "file", type=click.Path(path_type=Path), help="TOML or JSON file of parameters."),
    ):
        command = option(command)
    return command


def _changes(file: Path | None, settings: tuple[str, ...]) -> dict[str, Any]:
    """The nested changes that a file and then the single settings make; what is ignored of the file is reported."""
    read = read_parameters_file(file) if file else Read({}, ())
    _say(read.notices)
    return reduce(merged, map(parse_setting, settings), read.values)


def _say(notices: tuple[str, ...]) -> None:
    for notice in notices:
        click.echo(notice, err=True)


main.add_command(token)


@main.command(epilog=SERVE_EXAMPLES)
@setting_options
@_configured
@click.option(
    "--settings", "settings_file", type=click.Path(path_type=Path), help="TOML or JSON file.  [BECALM_SETTINGS]"
)
@click.option("--check", is_flag=True, help="Start nothing: check every setting, and say what would be started.")
@click.option("--json", "as_json", is_flag=True, help="With --check: print one JSON document.")
@click.option(
    "--open/--no-open", "open_page", default=None, help="Open the page in the browser.  [default: on a terminal]"
)
def serve(
    *,
    file: Path | None,
    settings: tuple[str, ...],
    settings_file: Path | None,
    check: bool,
    as_json: bool,
    open_page: bool | None,
    **flags: Any,
) -> None:
    """Start the service: console, scene, REST and telemetry on one port."""
    if as_json and not check:
        raise click.UsageError("--json goes with --check")
    chosen = choose(os.environ, settings_file, changes=_changes(file, settings), **flags)
    _say(chosen.notices)
    if check:
        from becalm import checking  # noqa: PLC0415 - web and scene take a second to load

        found = checking.checked(chosen)
        click.echo(json.dumps(found) if as_json else checking.as_text(found))
        return
    end_when_asked()  # what is loaded next takes seconds
    from becalm.serving import serve as serve_until_ended  # noqa: PLC0415 - as above

    serve_until_ended(chosen.settings, open_page=sys.stdout.isatty() if open_page is None else open_page)


@main.command(epilog=RUN_EXAMPLES, short_help="Fly one capture headless, as fast as it goes.")
@click.option("--direct", is_flag=True, help="Direct caging, without detumbling.")
@click.option(
    "--configuration", metavar="NAME", default=DEFAULT_CONFIGURATION, show_default=True, help="Configuration."
)
@_configured
@click.option("--seed", type=click.IntRange(min=0), help="Seed of the run's random numbers.")
@click.option("--log", type=click.Path(path_type=Path), help="Write every tick to this .mcap, .parquet or .csv file.")
@click.option("--json", "as_json", is_flag=True, help="Print the outcome as one JSON document.")
@click.option(
    "--cross-check",
    "checks",
    is_flag=True,
    help="Fly it in both engines, keep nothing, and say where they part; exit code 1 if they do not agree.",
)
def run(
    *,
    direct: bool,
    configuration: str,
    file: Path | None,
    settings: tuple[str, ...],
    seed: int | None,
    log: Path | None,
    as_json: bool,
    checks: bool,
) -> None:
    """Fly one capture headless, as fast as it goes, and keep it in the library of runs."""
    if checks and log is not None:
        raise click.UsageError("--cross-check keeps no ticks: --log does not go with it")
    changes = _changes(file, settings)
    if seed is not None:
        changes = merged(changes, {"simulation": {"seed": seed}})
    config = revised(named_configuration(configuration), changes)
    if checks:
        _cross_check(config, direct=direct, as_json=as_json)
        return
    from becalm import running, summary  # noqa: PLC0415 - the simulation takes a second to load
    from server.library.runs import RunStore  # noqa: PLC0415

    chosen = Settings.from_environment()
    store = RunStore(chosen.data_dir / "runs", chosen.log_topic_rate).make_root()
    record = running.run(store, configuration, config, direct=direct, log=running.log_file(log) if log else None)
    assert record.outcome is not None, "a run without an outcome has raised"
    if as_json:
        click.echo(json.dumps(summary.as_document(record, record.outcome)))
    else:
        click.echo(summary.as_text(record, record.outcome))


def _cross_check(config: MissionConfig, *, direct: bool, as_json: bool) -> None:
    from becalm import cross_checking  # noqa: PLC0415 - the simulation takes a second to load

    found = cross_checking.checked(config, direct=direct)
    click.echo(found.model_dump_json() if as_json else cross_checking.as_text(found))
    if not found.same:
        sys.exit(1)


@main.command(epilog=REPLAY_EXAMPLES, short_help="Fly a recorded run again and compare every tick.")
@click.argument("run_id", metavar="RUN")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as one JSON document.")
def replay(*, run_id: str, as_json: bool) -> None:
    """Drive the recorded states of RUN (an identifier, or `latest`) through the current controller, and fly it again.

    Both are compared with the log tick by tick; the first difference is named.
    """
    from becalm import replaying  # noqa: PLC0415 - the simulation takes a second to load
    from server.library.runs import RunStore  # noqa: PLC0415

    store = RunStore(Settings.from_environment().data_dir / "runs")
    report = replaying.replay(store.latest() if run_id == "latest" else store.read(run_id))
    click.echo(json.dumps(report) if as_json else replaying.as_text(report))
    if not replaying.same(report):
        sys.exit(1)


@main.command(epilog=REHEARSE_EXAMPLES, short_help="Show with odds what a command or an edit would do from a state.")
@click.argument("run_id", metavar="RUN")
@click.option("--at", type=number_option, help="Mission time of the state [s].  [default: the run's last tick]")
@click.option(
    "--request",
    type=click.Choice(["capture", "cage", "direct_cage", "continue"]),
    help="What each future begins with.  [default: goes on with what is under way, else capture]",
)
@_configured
@click.option("--futures", type=int, default=100, show_default=True, help="Futures, of each configuration.")
@click.option("--seed", type=int, default=0, show_default=True, help="The same seed gives the same futures.")
@click.option("--horizon", type=number_option, default=20.0, show_default=True, help="Of mission time, at most [s].")
@click.option("--uncertainty", type=click.Path(path_type=Path), help="TOML or JSON file of what is how unsure.")
@click.option("--threads", type=click.IntRange(min=1), help="That fly the futures.  [default: one a core]")
@click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON document.")
def rehearse(
    *,
    run_id: str,
    at: float | None,
    request: str | None,
    file: Path | None,
    settings: tuple[str, ...],
    futures: int,
    seed: int,
    horizon: float,
    uncertainty: Path | None,
    threads: int | None,
    as_json: bool,
) -> None:
    """Fly many futures from a recorded state of RUN (an identifier, or `latest`), as it is and with --set as changed.

    Each future draws what is not known for sure: motion, inertia, friction, servos, noise. Nothing is kept.
    """
    changes = _changes(file, settings)
    from becalm import rehearsing  # noqa: PLC0415 - the simulation takes a second to load
    from server.library.runs import RunStore  # noqa: PLC0415

    store = RunStore(Settings.from_environment().data_dir / "runs")
    result = rehearsing.rehearsed(
        store.latest() if run_id == "latest" else store.read(run_id),
        at,
        changes,
        request=request,
        futures=futures,
        seed=seed,
        horizon=horizon,
        uncertainty=rehearsing.uncertainty_in(uncertainty),
        threads=threads,
    )
    click.echo(result.model_dump_json() if as_json else rehearsing.as_text(result))


@main.command(epilog=FIT_EXAMPLES, short_help="Find which numbers explain recorded runs, and how surely.")
@click.argument("run_ids", metavar="RUN...", nargs=-1, required=True)
@click.option("--parameters", metavar="NAMES", multiple=True, help="What is fitted: names, with commas; repeatable.")
@click.option("--held-out", metavar="RUN", multiple=True, help="A run whose peak forces are only foretold; repeatable.")
@click.option("--out", type=click.Path(path_type=Path), help="Write a report to this file: .html, .pdf or .json.")
@click.option("--keep-as", metavar="PRESET", help="Keep the configuration with the fitted values by this name.")
@click.option("--threads", type=click.IntRange(min=1), help="That fly rollouts.  [default: one a core]")
@click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON document.")
def fit(
    *,
    run_ids: tuple[str, ...],
    parameters: tuple[str, ...],
    held_out: tuple[str, ...],
    out: Path | None,
    keep_as: str | None,
    threads: int | None,
    as_json: bool,
) -> None:
    """Find the values of contact, servos, target, table and sensors that explain each RUN (or `latest`), all together.

    Rollouts under the recorded commands, by least squares. What the runs do not tell stays as configured, and is said.
    """
    from becalm import fitting  # noqa: PLC0415 - the simulation takes a second to load
    from server.library.runs import RunStore  # noqa: PLC0415

    fitting.require_writable(out)
    fitting.require_name(keep_as)
    data = Settings.from_environment().data_dir
    store = RunStore(data / "runs")
    runs, kept = (
        [store.latest() if each == "latest" else store.read(each) for each in ids] for ids in (run_ids, held_out)
    )
    names = [name.strip() for each in parameters for name in each.split(",")] or None
    result = fitting.fitted(runs, names, kept, threads)
    if out is not None:
        out.write_bytes(fitting.WRITERS[out.suffix](result))
    if keep_as is not None:
        fitting.keep(data, keep_as, runs[0], result)
    click.echo(result.model_dump_json() if as_json else fitting.as_text(result))


@main.command(epilog=REPORT_EXAMPLES, short_help="Write the report of a recorded run, or of a study of the service.")
@click.argument("identifier", metavar="RUN|STUDY")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Write to this file: .html or .pdf.")
def report(*, identifier: str, out: Path) -> None:
    """Write one page for an appendix on RUN (an identifier, or `latest`) or STUDY: what was flown, and what came of it.

    A run: configuration, changes, verdict, figures, drawings, plots, touches, events. A study: what varied, how often
    each class came, maps, measures.
    """
    from becalm import reporting  # noqa: PLC0415 - what draws takes a second to load

    out.write_bytes(reporting.report(Settings.from_environment().data_dir, identifier, reporting.format_of(out)))


@main.command("import", epilog=IMPORT_EXAMPLES, short_help="Make a run of a log from elsewhere, CSV or MCAP.")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--map", "map_file", type=click.Path(path_type=Path), required=True, help="TOML: which column is what.")
@click.option("--json", "as_json", is_flag=True, help="Print what became of it as one JSON document.")
def import_log(*, file: Path, map_file: Path, as_json: bool) -> None:
    """Import FILE as a run of the library: plots, replay, comparison and fit work on it.

    Gaps, clock steps and values that are not numbers are reported; units that cannot be right are asked about.
    """
    from becalm import importing  # noqa: PLC0415 - what reads logs takes a second to load

    done = importing.import_log(Settings.from_environment().data_dir, file, map_file)
    click.echo(done.model_dump_json() if as_json else importing.as_text(done))


@main.command(epilog=STUDY_EXAMPLES, short_help="Fly many captures that differ in chosen parameters, on all cores.")
@click.argument("name_or_file")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Write the table to this file.")
@click.option(
    "--format",
    "table_format",
    type=click.Choice(["csv", "parquet", "json"]),
    help="Of the table.  [default: by the file's suffix]",
)
@_configured
@click.option("--workers", type=click.IntRange(min=1), help="Workers, threads or processes.  [default: one a core]")
@click.option(
    "--scheduler",
    envvar="BECALM_SCHEDULER",
    metavar="ADDRESS",
    help="Fly it on the Dask cluster of this scheduler instead, tcp://HOST:8786.",
)
@click.option("--force", is_flag=True, help="Start over where --out holds a table, or rows, already.")
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), help="Seed of the samples and of every cell.")
@click.option("--yes", is_flag=True, help="Do not ask before more than 10 000 cells.")
@click.option("--json", "as_json", is_flag=True, help="Print the report as one JSON document.")
def study(
    *,
    name_or_file: str,
    out: Path,
    table_format: str | None,
    file: Path | None,
    settings: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    force: bool,
    seed: int | None,
    yes: bool,
    as_json: bool,
) -> None:
    """Fly a study, a named one (published) or one in a file, and write one table with a row for every cell.

    The table has a column for each varied parameter under its full path, the outcome and what was measured.
    """
    changes = _changes(file, settings)
    from becalm import studying  # noqa: PLC0415 - the simulation takes a second to load

    output = studying.output_file(out, table_format)
    chosen = studying.chosen_study(name_or_file, changes, seed)
    flown_by = studying.chosen_workers(chosen, workers, scheduler)
    report = studying.fly(chosen, output, flown_by, confirmed=yes, replace=force)
    if as_json:
        click.echo(json.dumps(studying.as_document(report)))
    else:
        click.echo(studying.as_text(report))


@main.command(epilog=REPRODUCE_EXAMPLES, short_help="Reproduce the paper, and explain the result in a report.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("reproduction"),
    show_default=True,
    help="Write to this folder.",
)
@click.option("--workers", type=click.IntRange(min=1), help="Worker processes.  [default: one a core]")
@click.option(
    "--every",
    type=click.IntRange(1, 10),
    default=1,
    show_default=True,
    help="Fly only every N-th damping and stiffness: 484 cells at 1, 36 at 5.",
)
@click.option("--ablations", "ablate", is_flag=True, help="Also fly one constant changed at a time (13 half studies).")
@click.option("--experiment", is_flag=True, help="Fly the paper's experiment and our own method on the emulated robot.")
@click.option("--seeds", type=click.IntRange(1, 1000), help="Captures of each kind, of the experiment.  [default: 20]")
@click.option("--json", "as_json", is_flag=True, help="Print every number as one JSON document.")
def reproduce(
    *, out: Path, workers: int | None, every: int, ablate: bool, experiment: bool, seeds: int | None, as_json: bool
) -> None:
    """Fly the paper's captures and its parametric study, and write a report with figures and tables.

    With the authors' constants (published) and with those that the paper prints (as_printed). Or, with --experiment,
    its experiment on the air-bearing robot, emulated, beside direct caging and our own method.
    """
    from sim.study.cores import cores  # noqa: PLC0415 - the simulation and the drawing take a second to load

    _require_fitting(experiment, every, seeds, ablate=ablate)
    if experiment:
        from becalm import reflying  # noqa: PLC0415

        flown = reflying.refly(out, workers or cores(), seeds or 20)
        click.echo(json.dumps(flown) if as_json else reflying.as_text(flown))
        return
    from becalm import reproducing  # noqa: PLC0415

    document = reproducing.reproduce(out, workers or cores(), every, ablate=ablate)
    click.echo(json.dumps(document) if as_json else reproducing.as_text(document))


def _require_fitting(experiment: bool, every: int, seeds: int | None, *, ablate: bool) -> None:
    """Refuse an option of the study beside the experiment, and one of the experiment without it."""
    if experiment and (every != 1 or ablate):
        name = "--ablations" if ablate else "--every"
        raise click.UsageError(f"{name} is of the parametric study, which --experiment does not fly; leave one away")
    if seeds is not None and not experiment:
        raise click.UsageError(f"--seeds {seeds} is of the experiment: add --experiment")


@main.command(epilog=ROBOT_EXAMPLES, short_help="Emulate the air-bearing robot at the other end of the link.")
@click.option("--listen", metavar="ENDPOINT", multiple=True, help="Listen there: tcp/HOST:PORT or tls/HOST:PORT.")
@click.option("--connect", metavar="ENDPOINT", multiple=True, help="Connect to this router or console.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all noise and faults.")
@click.option("--name", default="emulator", show_default=True, help="Of the robot, by which a console knows it.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port of the faults' REST.  [default: free]")
@click.option("--configuration", metavar="NAME", default="testbed", show_default=True, help="Robot and target.")
@_configured
@click.option("--imperfection", "imperfect", metavar="NAME=VALUE", multiple=True, help="Of sensors or table.")
@click.option("--fault", "faults", metavar="NAME=VALUE[@S]", multiple=True, help="What goes wrong, and when.")
@click.option(
    "--deadline", type=number_option, default=0.1, show_default=True, help="Of heartbeat and joint commands [s]."
)
@click.option("--clock-offset", type=number_option, default=0.0, help="How far its clock is ahead [s].  [default: 0]")
@click.option("--realtime", is_flag=True, help="Let the system run it before other processes (Linux, if it may).")
@click.option("--users", type=click.Path(path_type=Path), help="Who may connect: a file of lines user:password.")
@click.option("--user", help="Name by which it connects to a router.")
@click.option("--password-file", type=click.Path(path_type=Path), help="File of that user's password.")
@click.option("--tls-ca", type=click.Path(path_type=Path), help="Authorities that the other end is checked by.")
@click.option("--tls-certificate", type=click.Path(path_type=Path), help="Certificate of this end.")
@click.option("--tls-key", type=click.Path(path_type=Path), help="Its private key.")
def robot(
    *,
    listen: tuple[str, ...],
    connect: tuple[str, ...],
    seed: int,
    name: str,
    port: int,
    configuration: str,
    file: Path | None,
    settings: tuple[str, ...],
    imperfect: tuple[str, ...],
    faults: tuple[str, ...],
    deadline: float,
    clock_offset: float,
    realtime: bool,
    users: Path | None,
    user: str | None,
    password_file: Path | None,
    tls_ca: Path | None,
    tls_certificate: Path | None,
    tls_key: Path | None,
) -> None:
    """Emulate the air-bearing testbed in real time, with its noise, delays, drag and faults."""
    if not listen and not connect:
        raise ConfigError("--listen or --connect is needed", tip="for example --listen tcp/127.0.0.1:7447")
    end_when_asked()
    from becalm import robot as emulated  # noqa: PLC0415 - the simulation takes a second to load

    transport = {
        "listen": listen,
        "connect": connect,
        "users_file": users,
        "user": user,
        "password_file": password_file,
        "tls_ca": tls_ca,
        "tls_certificate": tls_certificate,
        "tls_key": tls_key,
    }
    chosen = emulated.robot_settings(
        transport=transport,
        config=revised(named_configuration(configuration), _changes(file, settings)),
        name=name,
        seed=seed,
        deadline=deadline,
        clock_offset=clock_offset,
        imperfections=emulated.imperfections(imperfect),
    )
    emulated.run_robot(chosen, port, tuple(map(emulated.parse_fault, faults)), realtime=realtime)
