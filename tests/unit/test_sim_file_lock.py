"""Claims: one living process at a time, free again however it ends, and on file systems without locks as well."""

from __future__ import annotations

import errno
import fcntl
import os
import subprocess
import sys
from contextlib import contextmanager

import pytest

from sim.file_lock import WITHOUT_LOCKS, ProcessLock, is_locked, supports_locks

HOLD = (
    "import sys, pathlib, sim.file_lock as f;"
    " k = f.ProcessLock(pathlib.Path(sys.argv[1])); print('held', flush=True); input()"
)
WITHOUT = "import fcntl, errno; fcntl.flock = lambda *_: (_ for _ in ()).throw(OSError(errno.ENOLCK, 'No locks'));"


@contextmanager
def held_elsewhere(path, before=""):
    """Another process that holds it; killed at the end."""
    command = [sys.executable, "-c", before + HOLD, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def without_locks(monkeypatch, number=errno.ENOLCK):
    def refuse(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", refuse)


@pytest.mark.parametrize("locks", [True, False])
def test_a_killed_process_holds_nothing(tmp_path, monkeypatch, locks):
    path = tmp_path / "lock"
    if not locks:
        without_locks(monkeypatch)
    with held_elsewhere(path, "" if locks else WITHOUT):
        assert is_locked(path)
        with pytest.raises(BlockingIOError, match="another process holds it"):
            ProcessLock(path)
    assert not is_locked(path)
    ProcessLock(path).release()


@pytest.mark.parametrize("number", sorted(set(WITHOUT_LOCKS)))
def test_without_locks_a_file_names_the_holder(tmp_path, monkeypatch, caplog, number):
    without_locks(monkeypatch, number)
    path = tmp_path / "lock"
    lock = ProcessLock(path)
    assert (tmp_path / "lock.pid").read_text().startswith(f"{os.getpid()}\n")
    assert "has no locks" in caplog.text
    with pytest.raises(BlockingIOError):
        ProcessLock(path)
    lock.release(remove=True)
    assert list(tmp_path.iterdir()) == []


def test_what_fails_for_another_reason_says_so(tmp_path, monkeypatch):
    without_locks(monkeypatch, errno.EIO)
    with pytest.raises(OSError, match="Input/output error"):
        ProcessLock(tmp_path / "lock")
    with pytest.raises(FileNotFoundError):
        ProcessLock(tmp_path / "nowhere" / "lock")
    assert not (tmp_path / "nowhere").exists()


def test_whether_a_folder_has_locks_is_tried_without_leaving_a_name(tmp_path, monkeypatch):
    assert supports_locks(tmp_path)
    without_locks(monkeypatch)
    assert not supports_locks(tmp_path)
    assert list(tmp_path.iterdir()) == []
