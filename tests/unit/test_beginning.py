"""A mission that begins on the way: as the one that it goes on from, and kept in a file that describes itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.capture.beginning import Beginning
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.control.phases import Command
from sim.errors import ConfigError


@pytest.fixture(scope="module")
def config() -> MissionConfig:
    return revised(named_configuration("published"), {"simulation": {"engine": "reduced"}})


@pytest.fixture(scope="module")
def flying(config: MissionConfig) -> tuple[Mission, Beginning]:
    """A mission after a second of a capture, and its beginning there."""
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    mission.advance_unrecorded(1000)
    mark = mission.mark()
    return mission, Beginning.at(mark, mark.state, config, None)


def test_it_goes_on_as_the_mission_that_it_goes_on_from(
    config: MissionConfig, flying: tuple[Mission, Beginning]
) -> None:
    mission, beginning = flying
    again = beginning.mission(config)
    assert (again.next_tick, again.phase, again.activity) == (1000, mission.phase, mission.activity)
    ours, theirs = again.advance(300), mission.advance(300)
    assert ours["tick"].tolist() == theirs["tick"].tolist()
    for name in ("target_pose", "hand_pose", "commanded_joint_rate", "desired_hand_pose", "base_pose"):
        assert ours[name] == pytest.approx(theirs[name], abs=1e-9), name


def test_from_a_file_it_is_the_same_bit_for_bit(
    config: MissionConfig, flying: tuple[Mission, Beginning], tmp_path: Path
) -> None:
    beginning = flying[1]
    beginning.write(tmp_path / "beginning.npz")
    read = Beginning.read(tmp_path / "beginning.npz", config)
    assert read.tick == 1000
    assert read.request is None
    ours, theirs = read.mission(config).advance(200), beginning.mission(config).advance(200)
    assert ours.tobytes() == theirs.tobytes()


def test_a_file_that_cannot_be_read_as_it_was_meant_is_refused(
    config: MissionConfig, flying: tuple[Mission, Beginning], tmp_path: Path
) -> None:
    path = tmp_path / "beginning.npz"
    path.write_bytes(b"PK nothing")
    with pytest.raises(ConfigError, match=r"beginning\.npz is damaged"):
        Beginning.read(path, config)
    other = flying[1]._asdict()
    other["memory"] = np.zeros(1, [("phase", np.int64)])
    np.savez(path, **other)
    with pytest.raises(ConfigError, match="written by another version of Becalm: its memory has other fields"):
        Beginning.read(path, config)


def test_only_the_engine_whose_states_can_be_laid_out_begins_on_the_way(flying: tuple[Mission, Beginning]) -> None:
    with pytest.raises(ConfigError, match=r"simulation\.engine = pymunk: only the reduced engine"):
        flying[1].mission(MissionConfig())
