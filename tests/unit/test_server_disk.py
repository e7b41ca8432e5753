"""The disk guard: how much is free, and what is refused when it is little."""

from __future__ import annotations

import os
import shutil

import pytest

from server.errors import DataFolderLost, DiskFull
from server.process.disk import DiskGuard


def test_there_is_room(tmp_path):
    guard = DiskGuard(tmp_path / "not" / "made" / "yet", 0.0)
    guard.look()
    assert guard.free == pytest.approx(shutil.disk_usage(tmp_path).free, rel=0.05)
    assert guard.warning is None
    guard.require_room()


def test_little_room_is_told_and_refused(tmp_path):
    guard = DiskGuard(tmp_path, 1e18)
    guard.require_room()  # nobody has looked yet
    guard.look()
    assert "less than the 1e+09 GB of min_free_gb" in (guard.warning or "")
    with pytest.raises(DiskFull, match="GB are free"):
        guard.require_room()


def test_a_folder_that_is_gone_or_not_to_be_written_is_told_and_refused(tmp_path, monkeypatch):
    runs = tmp_path / "runs"
    guard = DiskGuard(tmp_path, 0.0, (runs,))
    guard.look()
    assert guard.fault == f"the folder {runs} is gone"
    for require in (guard.require_room, guard.require_folder):
        with pytest.raises(DataFolderLost, match="is gone"):
            require()
    runs.mkdir()
    guard.require_room()
    guard.require_folder()
    guard.look()
    assert guard.fault is None
    monkeypatch.setattr(os, "access", lambda *_: False)  # a disk that has become read-only
    guard.look()
    assert guard.fault == f"the folder {runs} cannot be written"


def test_a_disk_that_does_not_say_warns_of_nothing(tmp_path, monkeypatch):
    guard = DiskGuard(tmp_path, 1e18)
    guard.look()

    def silent(_: object) -> None:
        raise OSError("stale file handle")

    monkeypatch.setattr(shutil, "disk_usage", silent)
    guard.look()
    assert guard.free is None
    assert guard.warning is None
