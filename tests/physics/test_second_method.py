"""A method is a value: one more flies live, headless, in a study and in a replay, for its folder and one line.

The line and the folder go into a copy of the code, which a process of its own flies; nothing else changes there.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow
"""The copy has sources of its own, so that everything is compiled anew: two to three minutes of a processor."""

ROOT = Path(__file__).parents[2]
METHOD = Path(__file__).with_name("reach_and_hold")
PATIENCE = 400.0
"""To compile everything and fly it [s]."""

FLY_ALL = """
import json, os, re, subprocess, sys, time

import httpx
import numpy as np

from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, Intervention, first_difference, Follower, rerun
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.errors import MissionRefused
from sim.study.design import study_of
from sim.study.run import CellTask, fly_cell

CHANGES = {"method": "reach_and_hold", "reach_and_hold.stillness": 0.3}
config = revised(MissionConfig(), nested(CHANGES))
found = {}

pieces = []
result = run_capture(config, on_ticks=lambda ticks: pieces.append(ticks.copy()))
ticks = np.concatenate(pieces)
found["headless"] = {
    "outcome": result.outcome.outcome.value,
    "locked_at": result.outcome.locked_at,
    "events": [event.message for event in result.events],
    "way": np.hypot(*(ticks["hand_pose"][-1, :, :2] - ticks["hand_pose"][0, :, :2]).T).tolist(),
}

history = FlightHistory(config=config, interventions=(Intervention(tick=0, command=Command.CAPTURE),))
again = np.concatenate(list(rerun(history, len(ticks))))
followed = Follower(history).follow(ticks)
found["replay"] = [first_difference(ticks, again) is None, first_difference(ticks, followed) is None]

mission = Mission(config)
try:
    mission.request(Command.DIRECT_CAGE)
except MissionRefused as refusal:
    found["refused"] = str(refusal)
mission.request(Command.CAPTURE)
mission.advance(100)
snapshot = mission.snapshot()
found["snapshot"] = [
    snapshot.method, snapshot.activity, snapshot.description, snapshot.plan.kind, snapshot.spin_threshold
]

study = study_of({"changes": CHANGES, "grid": {"reach_and_hold.distance": [0.01, 0.02]}})
found["study"] = [fly_cell(CellTask(study.base, study.direct, study.cell(index)))["locked_at"] for index in range(2)]

changes = [word for path, value in CHANGES.items() for word in ("--set", f"{path}={value}")]
serve = [sys.executable, "-m", "becalm", "serve", "--port", "0", "--no-open", *changes]
with subprocess.Popen(serve, stdout=subprocess.PIPE, text=True) as process:
    port = re.search(r":(\\d+)/", process.stdout.readline())[1]
    with httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=30, trust_env=False) as http:
        until = time.monotonic() + 120
        while http.post("/mission/commands", json={"command": "capture"}).status_code != 200:
            assert time.monotonic() < until
            time.sleep(0.1)
        while (live := http.get("/mission").json())["outcome"] is None:
            assert time.monotonic() < until
            time.sleep(0.05)
        found["live"] = [live["method"], live["outcome"]["outcome"], live["outcome"]["locked_at"]]
        found["live_config"] = http.get("/mission/config").json()["config"]["reach_and_hold"]
    process.terminate()
    process.wait(30)

print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What flying it everywhere gave."""
    tree = tmp_path_factory.mktemp("second_method")
    for room in ("sim", "server", "becalm"):
        shutil.copytree(ROOT / room, tree / room, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(METHOD, tree / "sim" / "method" / METHOD.name, ignore=shutil.ignore_patterns("__pycache__"))
    registry = tree / "sim" / "method" / "registry.py"
    line = "    published: PublishedConfig = PublishedConfig()\n"
    own = "    reach_and_hold: ReachAndHoldConfig = ReachAndHoldConfig()\n"
    imported = "from sim.method.reach_and_hold.parameters import ReachAndHoldConfig\n"
    text = registry.read_text().replace(line, line + own)
    registry.write_text(text.replace("from sim.parameters", imported + "from sim.parameters"))
    script = tree / "fly_all.py"
    script.write_text(FLY_ALL)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tree / "compiled"), "BECALM_DATA_DIR": str(tree / "data")}
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=tree, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_headless_it_does_what_it_is_for(found: Any) -> None:
    headless = found["headless"]
    assert headless["way"] == pytest.approx([0.03, 0.03], rel=0.05)
    assert headless["locked_at"] == pytest.approx(0.5 + 0.3, abs=3e-3)
    assert headless["outcome"] == "unresolved"
    assert {"The hands move", "A reach is planned"} <= set(headless["events"])


def test_a_replay_gives_the_same_to_the_last_bit(found: Any) -> None:
    assert found["replay"] == [True, True]


def test_a_snapshot_has_its_words_and_plan(found: Any) -> None:
    assert found["snapshot"] == ["reach_and_hold", "reaching", "Both hands reach back.", "reach", None]


def test_a_command_that_it_has_not_is_refused(found: Any) -> None:
    assert "direct_cage is refused" in found["refused"]


def test_a_study_varies_its_parameters(found: Any) -> None:
    assert found["study"] == pytest.approx([0.8, 0.8], abs=3e-3)


def test_live_it_flies_to_its_verdict(found: Any) -> None:
    method, outcome, locked_at = found["live"]
    assert (method, outcome) == ("reach_and_hold", "unresolved")
    assert locked_at > 0.8  # the mission had been idle before
    assert found["live_config"]["stillness"] == 0.3
