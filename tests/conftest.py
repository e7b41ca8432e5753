"""What all tests share: compiled code, and a data folder that is never the user's own."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def _own_data_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("BECALM_DATA_DIR", str(tmp_path / "data"))
