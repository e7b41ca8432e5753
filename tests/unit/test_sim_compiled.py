"""Where compiled code is kept: by the user's folder, or where nobody else can put any."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

import platformdirs
import pytest

from server.settings import Settings
from sim import compiled
from sim.errors import ConfigError


def _no_home(*_: object, **__: object) -> str:
    raise RuntimeError("could not determine the home directory")


@pytest.fixture
def homeless(monkeypatch, tmp_path):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(platformdirs, "user_cache_dir", _no_home)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_a_user_without_a_home_has_a_folder_of_their_own(homeless):
    folder = compiled.cache_folder().parent
    assert folder == homeless / f"becalm-compiled-{os.getuid()}" == compiled.cache_folder().parent
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_a_home_that_cannot_be_written_is_none(homeless, monkeypatch):
    (homeless / "file").write_text("")
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda _: str(homeless / "file" / "cache"))
    assert compiled.cache_folder().parent.name.startswith("becalm-compiled-")


@pytest.mark.parametrize("strange", ["open", "link"])
def test_a_folder_into_which_others_may_put_code_is_not_used(homeless, strange):
    there = homeless / f"becalm-compiled-{os.getuid()}"
    if strange == "open":
        there.mkdir()
        there.chmod(0o777)
    else:
        (homeless / "theirs").mkdir()
        there.symlink_to(homeless / "theirs")
    folder = compiled.cache_folder().parent
    assert folder != there
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_without_a_home_a_data_folder_must_be_named(monkeypatch):
    monkeypatch.setattr("server.settings.user_data_path", _no_home)
    with pytest.raises(ConfigError, match="no home") as refused:
        Settings()
    assert "BECALM_DATA_DIR" in refused.value.tip
    assert Settings(data_dir=Path("here")).data_dir == Path("here")
