"""A data folder has one owner; whoever comes second is told which process has it."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import subprocess
import sys

import pytest
from click.testing import CliRunner

from becalm import cli
from becalm.cli import main
from server.errors import DataFolderInUse
from server.process.data_folder import owned

OWN = (
    "import sys, pathlib, server.process.data_folder as d\n"
    "with d.owned(pathlib.Path(sys.argv[1]), 'http://127.0.0.1:8160/'):\n"
    "    print('owned', flush=True); input()"
)


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "data"


def test_a_second_service_does_not_start_and_says_who_has_the_folder(folder):
    command = [sys.executable, "-c", OWN, str(folder)]
    arguments = ["serve", "--port", "0", "--no-open", "--data-dir", str(folder)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "owned\n"
        before = {path: path.read_bytes() for path in folder.iterdir()}
        for extra in ([], ["--check"]):
            second = CliRunner().invoke(main, [*arguments, *extra])
            assert second.exit_code == 1
            assert f"process {process.pid} on {os.uname().nodename}, since 20" in second.output
            assert "http://127.0.0.1:8160/" in second.output
            assert "--data-dir or BECALM_DATA_DIR" in second.output
        assert {path: path.read_bytes() for path in folder.iterdir()} == before
        process.kill()
    with owned(folder, "http://127.0.0.1:8161/"):
        assert json.loads((folder / "service.json").read_text())["pid"] == os.getpid()
    assert not (folder / "service.json").exists()


def test_an_owner_that_has_not_said_who_it_is_is_found_all_the_same(folder):
    with owned(folder, "here"):
        (folder / "service.json").write_text("{")
        with pytest.raises(DataFolderInUse, match="has not said which"), owned(folder, "there"):
            pass


def test_a_check_tells_of_a_file_system_without_locks(folder, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", refuse)
    folder.mkdir()
    checked = CliRunner().invoke(main, ["serve", "--check", "--port", "0", "--data-dir", str(folder)])
    assert checked.exit_code == 0, checked.output
    assert "no locks on its file system" in checked.output
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("error", "said"),
    [(OSError("it broke"), "Error: it broke\n"), (OSError(errno.EIO, "I/O error", "x"), "Error: x: I/O error\n"),
     (OSError(), "Error: OSError\n")],
)  # fmt: skip
def test_what_the_system_refuses_is_never_none(monkeypatch, error, said):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(cli, "choose", fail)
    assert CliRunner().invoke(main, ["serve", "--check"]).output == said
