"""How good the control over the link is with the testbed's imperfections, apart from how busy this machine is.

    python -m benchmarks.link_control                                  20 seeds with the defaults
    python -m benchmarks.link_control --configuration testbed_becalm   our own method
    python -m benchmarks.link_control --set published.impedance.damping=1.5 --set published.impedance.stiffness=10
    python -m benchmarks.link_control --ideal                          perfect sensors, no drag, no tilt, no delay

Both ends in one process and in virtual time (`server.link.virtual_robot`): the plant on its air table, its sensors, the
bytes of the wire, motion capture's delay, joint rates that hold from the next period on, and the console's perception
and mission. Same seed, same numbers. What the clocks of two processes add is measured by benchmarks.link.
"""

from __future__ import annotations

import argparse
from functools import reduce

import numpy as np

from becalm.typed import parse_setting
from server.link.imperfections import Imperfections
from server.link.virtual_robot import VirtualRobot
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import merged, named_configuration, revised
from sim.control.phases import Command, Phase
from sim.snapshot import Outcome

IDEAL = Imperfections(**dict.fromkeys(Imperfections.model_fields, 0.0))
LONGEST = 45.0
"""Of a capture that has no verdict: the method holds [s]."""


def capture(config: MissionConfig, some: Imperfections, seed: int) -> tuple[Outcome | None, VirtualRobot, list[str]]:
    """One capture, and what its method said of trouble; no outcome if it held without one."""
    plant = VirtualRobot(config, some, seed)
    mission, events = Mission(config, plant), []
    mission.request(Command.CAPTURE)
    while mission.outcome is None and mission.time < LONGEST and mission.phase is not Phase.FAULTED:
        mission.advance(20)
        events += [f"{event.time:.2f} {event.message}" for event in mission.take_events()]
    return mission.outcome, plant, events


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--configuration", default="testbed")
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument("--imperfection", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--ideal", action="store_true")
    parser.add_argument("--events", action="store_true", help="tell what happened in captures that were not caged")
    chosen = parser.parse_args()
    config = revised(named_configuration(chosen.configuration), reduce(merged, map(parse_setting, chosen.settings), {}))
    given = dict(each.split("=") for each in chosen.imperfection)
    some = Imperfections(**{**(IDEAL.model_dump() if chosen.ideal else {}), **given})
    rows = []
    for seed in range(chosen.first, chosen.first + chosen.seeds):
        outcome, plant, events = capture(config, some, seed)
        caged, peak = outcome is not None and outcome.caged, plant.testbed.peak_force
        spin = float(plant.testbed.state["target_twist"][2])
        if outcome is not None and outcome.caged:
            rows.append((peak, outcome.peak_tip_force_to_closure, outcome.duration, abs(spin)))
        name = "no verdict" if outcome is None else outcome.outcome.value
        print(f"{seed:3} {name:26} caged {caged!s:5} peak {peak:5.2f} N  spin {spin:+.3f} rad/s", flush=True)
        if chosen.events and not caged:
            print("\n".join(events), flush=True)
    print(f"{len(rows)} of {chosen.seeds} caged")
    for name, values in zip(("peak", "peak to closure", "duration", "final spin"), np.array(rows).T, strict=False):
        print(f"{name}: median {np.median(values):.3g}, from {values.min():.3g} to {values.max():.3g}")


if __name__ == "__main__":
    main()
