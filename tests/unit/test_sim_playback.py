"""Playback: any tick of a recording is published as it was when it was flown, whichever way one comes to it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.playback import BLOCK, Playback
from sim.capture.replay import FlightHistory, Intervention, intervene
from sim.config import MissionConfig
from sim.control.phases import Command

HISTORY = FlightHistory(
    config=MissionConfig(),
    interventions=(
        Intervention(tick=137, command=Command.CAPTURE),
        Intervention(tick=3470, changes={"published.impedance.damping": 3.0}),
        Intervention(tick=3600, command=Command.HOLD),
        Intervention(tick=3900, command=Command.CAGE),
    ),
)
END = 9000
SEEN = (0, 1, 136, 137, 138, 499, 500, 501, 1800, 3469, 3470, 3605, 3900, 4200, 6001, 8500, 8999)


class Recording:
    """Ticks in memory, and how often they were asked for."""

    def __init__(self, ticks):
        self.ticks, self.reads = ticks, 0

    def read(self, since, until):
        self.reads += 1
        yield self.ticks[(self.ticks["time"] >= since) & (self.ticks["time"] <= until)]


@pytest.fixture(scope="module")
def flown():
    """The ticks of that history, and the snapshots at `SEEN` as they were published."""
    mission, rows, seen = Mission(HISTORY.config), [], {}
    left = list(HISTORY.interventions)
    while mission.next_tick < END:
        while left and left[0].tick == mission.next_tick:
            intervene(mission, left.pop(0))
        rows.append(mission.advance(1))
        if mission.next_tick - 1 in SEEN:
            seen[mission.next_tick - 1] = mission.snapshot()
    assert mission.outcome is not None, "the recording must hold a verdict"
    return np.concatenate(rows), seen


@pytest.mark.parametrize("order", [SEEN, SEEN[::-1], (6001, 1800, 6001, 500, 499, 8999, 0, 3605)])
def test_every_moment_is_as_it_was(flown, order):
    ticks, seen = flown
    playback = Playback(HISTORY, Recording(ticks).read)
    for tick in order:
        assert playback.at(tick * 1e-3) == seen[tick]


def test_a_moment_between_two_ticks_shows_the_nearer_one(flown):
    playback = Playback(HISTORY, Recording(flown[0]).read)
    assert playback.at(1.8004).tick == 1800
    assert playback.at(1.7996).tick == 1800


def test_beyond_the_end_stands_the_last_tick(flown):
    playback = Playback(HISTORY, Recording(flown[0]).read)
    assert playback.at(60.0) == flown[1][8999]
    assert playback.at(8.5) == flown[1][8500]


def test_ticks_at_rest_may_be_missing(flown):
    ticks, seen = flown
    kept = np.concatenate([ticks[:1], ticks[137:]])
    playback = Playback(HISTORY, Recording(kept).read)
    assert playback.at(0.1) == seen[0]
    assert playback.at(4.2) == seen[4200]
    assert playback.at(0.0) == seen[0]


def test_the_configuration_is_the_one_in_force_then(flown):
    playback = Playback(HISTORY, Recording(flown[0]).read)
    playback.at(5.0)
    assert playback.config.published.impedance.damping == 3.0
    playback.at(2.0)
    assert playback.config == HISTORY.config


def test_playing_on_reads_each_block_once(flown):
    recording = Recording(flown[0])
    playback = Playback(HISTORY, recording.read)
    for tick in range(0, 3000, 16):
        playback.at(tick * 1e-3)
    assert recording.reads == 3000 // BLOCK
