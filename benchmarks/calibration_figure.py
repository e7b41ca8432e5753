"""The reliability diagram of `benchmarks.calibration`: `python -m benchmarks.calibration_figure FOUND PICTURE`.

FOUND is what the benchmark has printed, of one configuration after another. On the left the real share of caged over
the odds that were said, each fifth of the odds with Wilson's 95 % interval; on the right how often the bands held.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from server.reports.style import look
from sim.study.outcome_frequencies import share_interval

BANDS = {"peak force": "peak force within its 90 % band", "time to cage": "time to cage within its 90 % band"}
WANTED = (0.85, 0.95)
"""Between which a 90 % band should hold what happens (mission.md)."""
COLOURS = {"becalm": "#0072b2", "published": "#d55e00"}
MARKS = {"reduced": "o", "pymunk": "s"}


def documents(text: str) -> list[dict[str, Any]]:
    """JSON documents that stand one after another."""
    decoder, place, found = json.JSONDecoder(), 0, []
    while place < len(text.rstrip()):
        document, place = decoder.raw_decode(text, place)
        found.append(document)
        place += len(text[place:]) - len(text[place:].lstrip())
    return found


def drawn(found: list[dict[str, Any]]) -> Figure:
    """Both diagrams."""
    figure = Figure(figsize=(8.4, 3.6), layout="constrained")
    reliability, bands = figure.subplots(1, 2)
    _draw_reliability(reliability, found)
    _draw_bands(bands, found)
    return figure


def _draw_reliability(axes: Axes, found: list[dict[str, Any]]) -> None:
    axes.plot([0, 1], [0, 1], color="#999999", linewidth=0.8, linestyle="--")
    for each in found:
        for said, was, count in each["reliability: odds, real share, situations"]:
            low, high = share_interval(round(was * count), count)
            colour = COLOURS[each["configuration"]]
            axes.vlines(said, low, high, color=colour, linewidth=1.0)
            axes.plot(said, was, MARKS[each["truth"]], color=colour, markersize=3.0 + 4.0 * (count / 300.0) ** 0.5)
    axes.set(xlabel="odds of a cage that were said", ylabel="share that was caged", xlim=(0, 1.02), ylim=(0, 1.04))


def _draw_bands(axes: Axes, found: list[dict[str, Any]]) -> None:
    axes.axhspan(*WANTED, color="#e8efe9")
    axes.axhline(0.9, color="#999999", linewidth=0.8, linestyle="--")
    for place, (_words, key) in enumerate(BANDS.items()):
        for beside, each in enumerate(found):
            x = place + 0.16 * (beside - 0.5 * (len(found) - 1))
            low, high = share_interval(round(each[key] * each["situations"]), each["situations"])
            colour, label = COLOURS[each["configuration"]], f"{each['configuration']}, truth by {each['truth']}"
            axes.vlines(x, low, high, color=colour, linewidth=1.0)
            axes.plot(x, each[key], MARKS[each["truth"]], color=colour, label=None if place else label)
    axes.set(ylabel="really within the 90 % band", ylim=(0.75, 1.0), xlim=(-0.5, 1.5))
    axes.set_xticks(range(len(BANDS)), list(BANDS))
    axes.legend(loc="lower center", fontsize=7)


def main() -> None:
    """Draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("found", type=Path)
    parser.add_argument("picture", type=Path)
    chosen = parser.parse_args()
    with look():
        drawn(documents(chosen.found.read_text())).savefig(chosen.picture, dpi=140)


if __name__ == "__main__":
    main()
