"""A run's log opens in Rerun, by its own reader of MCAP."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from server.library.runs import RunStore, new_record
from server.library.scripted import fly
from sim.configurations import named_configuration

PATIENCE = 180.0

OPENS = """
import sys
import rerun
rerun.init("becalm_log")
rerun.save(sys.argv[2])
rerun.log_file_from_path(sys.argv[1])
"""


def test_rerun_finds_what_a_log_shows(tmp_path):
    store = RunStore(tmp_path / "runs").make_root()
    record = new_record("scripted", "published", named_configuration("published"), direct=True)
    store.create(record)
    fly(store, record)
    recording = tmp_path / "log.rrd"
    log = store.read(record.id).log_path
    subprocess.run([sys.executable, "-c", OPENS, log, recording], check=True, timeout=PATIENCE)
    rerun = Path(sys.executable).with_name("rerun")
    printed = subprocess.run(
        [rerun, "rrd", "print", recording], capture_output=True, text=True, check=True, timeout=PATIENCE
    ).stdout
    shown = set(re.findall(r"/[a-z_]+(?:/[a-z_]+)?", printed))
    assert {"/tf", "/becalm/tick", "/becalm/event", "/joint_states", "/target/pose", "/left_hand/wrench"} <= shown
