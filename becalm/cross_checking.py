"""`becalm run --cross-check`: the same capture in both engines, for a person to read."""

from __future__ import annotations

import click

from sim.capture.cross_check import CrossCheck, FirstTouch, cross_check
from sim.capture.mission import prepare
from sim.config import Engine, MissionConfig
from sim.configurations import revised


def checked(config: MissionConfig, *, direct: bool) -> CrossCheck:
    """Fly both engines; nothing is kept in the library.

    Raises:
        ConfigError: the other engine cannot fly this configuration.
        PlantDiverged: the simulated state of one is not finite.

    """
    click.echo("Preparing both engines (the first time compiles for about half a minute)", err=True)
    for engine in Engine:
        prepare(revised(config, {"simulation": {"engine": engine}}))
    return cross_check(config, direct=direct)


def as_text(check: CrossCheck) -> str:
    """What is printed."""
    led, other = check.flights
    lines = [f"The same capture, by each engine's own controller: {_verdict(check)}"]
    for flight in check.flights:
        outcome = flight.outcome
        peaks = f"{outcome.peak_tip_force_to_closure:.3f} N until closed, {outcome.peak_tip_force:.3f} N in all"
        lines.append(f"  {flight.engine:<8}{outcome.at_first_closure.value}, peak {peaks}")
        lines.append(f"          first touch {_touch(flight.first_touch)}")
    lines += [
        "",
        f"{other.engine} under the joint rates that {led.engine}'s controller commanded, {check.compared_time:.3f} s:",
        f"  up to the first touch they are {check.before_touch:.1e} m apart at most",
        f"  first touch {_touch(check.first_touch)}",
    ]
    parted = check.divergence
    if parted is None:
        lines.append(f"  never more than {check.tolerance:.0e} m apart")
    else:
        where = f"{parted.part}, {parted.distance:.1e} m"
        lines.append(f"  more than {check.tolerance:.0e} m apart from {parted.time:.3f} s on: {where}")
    return "\n".join(lines)


def _verdict(check: CrossCheck) -> str:
    if check.same:
        return "the engines agree"
    return "first touches differ" if check.same_outcome else "outcomes differ"


def _touch(touch: FirstTouch | None) -> str:
    if touch is None:
        return "none"
    x, y = touch.place
    return f"at {touch.time:.3f} s, {touch.arm} tip {touch.tip} at ({x:.4f}, {y:.4f}) m"
