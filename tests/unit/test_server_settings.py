"""Settings: flags over environment over defaults."""

from __future__ import annotations

import pytest

from server.settings import Settings
from sim.errors import ConfigError


def test_defaults_listen_on_loopback_only():
    settings = Settings.from_environment({})
    assert (settings.host, settings.port, settings.configuration) == ("127.0.0.1", 8000, "published_figures")
    assert "localhost" in settings.own_hosts()


def test_flags_win_over_the_environment(tmp_path):
    environment = {"BECALM_PORT": "9000", "BECALM_HOST": "0.0.0.0", "BECALM_DATA_DIR": str(tmp_path)}
    settings = Settings.from_environment(environment, port=9001, host=None)
    assert (settings.port, settings.host, settings.data_dir) == (9001, "0.0.0.0", tmp_path)
    assert settings.own_hosts() == ()


def test_allowed_hosts():
    settings = Settings.from_environment({"BECALM_ALLOWED_HOSTS": "lab.example,console.example"})
    assert set(settings.own_hosts()) >= {"lab.example", "console.example", "localhost"}


@pytest.mark.parametrize(("name", "value"), [("port", "many"), ("port", "70000"), ("plant", "zenoh")])
def test_a_setting_that_cannot_be_is_named(name, value):
    with pytest.raises(ConfigError, match=f"{name} = '{value}'"):
        Settings.from_environment({f"BECALM_{name.upper()}": value})


def test_configuration_is_checked():
    with pytest.raises(ConfigError, match="nonesuch"):
        Settings(configuration="nonesuch").initial_config()
    with pytest.raises(ConfigError, match=r"target\.mass = -1"):
        Settings(changes={"target": {"mass": -1}}).initial_config()
