"""Settings: flags over environment over file over defaults."""

from __future__ import annotations

import pytest

from server.settings import Settings, choose
from sim.errors import ConfigError
from sim.schema_history import removed, renamed


def test_defaults_listen_on_loopback_only():
    settings = Settings.from_environment({})
    assert (settings.host, settings.port, settings.configuration) == ("127.0.0.1", 8000, "becalm")
    assert "localhost" in settings.own_hosts()


def test_flags_win_over_the_environment(tmp_path):
    environment = {"BECALM_PORT": "9000", "BECALM_HOST": "0.0.0.0", "BECALM_DATA_DIR": str(tmp_path)}
    settings = Settings.from_environment(environment, port=9001, host=None)
    assert (settings.port, settings.host, settings.data_dir) == (9001, "0.0.0.0", tmp_path)
    assert settings.own_hosts() == ()


def test_a_robot_is_flown_with_the_testbed_unless_told_otherwise():
    settings = Settings.from_environment({"BECALM_PLANT": "zenoh", "BECALM_CONNECT": "tcp/a:1,tls/b:2"})
    assert settings.configuration == "testbed_becalm"
    assert settings.connect == ("tcp/a:1", "tls/b:2")
    assert Settings.from_environment({}, plant="zenoh", configuration="as_printed").configuration == "as_printed"


def test_allowed_hosts():
    settings = Settings.from_environment({"BECALM_ALLOWED_HOSTS": "lab.example,console.example"})
    assert set(settings.own_hosts()) >= {"lab.example", "console.example", "localhost"}


@pytest.mark.parametrize(
    ("name", "value"), [("port", "many"), ("port", "70000"), ("plant", "robot"), ("log_topic_rate", "0")]
)
def test_a_setting_that_cannot_be_is_named(name, value):
    with pytest.raises(ConfigError, match=f"{name} = '{value}'"):
        Settings.from_environment({f"BECALM_{name.upper()}": value})


def test_configuration_is_checked():
    with pytest.raises(ConfigError, match="nonesuch"):
        Settings(configuration="nonesuch").initial_config()
    with pytest.raises(ConfigError, match=r"target\.mass = -1"):
        Settings(changes={"target": {"mass": -1}}).initial_config()


def test_each_source_wins_over_those_before_it(tmp_path):
    file = tmp_path / "lab.toml"
    file.write_text('host = "10.0.0.1"\nport = 1\nkeep_days = 3\nallowed_hosts = ["lab.example"]\n')
    environment = {"BECALM_SETTINGS": str(file), "BECALM_PORT": "2", "BECALM_KEEP_DAYS": "4"}
    settings, sources, _ = choose(environment, keep_days="5")
    assert (settings.host, settings.port, settings.keep_days) == ("10.0.0.1", 2, 5.0)
    assert settings.allowed_hosts == ("lab.example",)
    assert sources == {
        "host": str(file), "allowed_hosts": str(file), "port": "BECALM_PORT", "keep_days": "--keep-days"
    }  # fmt: skip
    other = tmp_path / "other.json"
    other.write_text('{"port": 3}')
    assert choose(environment | {"BECALM_PORT": ""}, other).settings.port == 3


def test_changes_of_a_file_and_of_the_command_line_add_up(tmp_path):
    file = tmp_path / "lab.toml"
    file.write_text("[changes.target]\ninitial_spin = 0.5\nmass = 2.0\n")
    changes = choose({}, file, changes={"target": {"mass": 3.0}}).settings.changes
    assert changes == {"target": {"initial_spin": 0.5, "mass": 3.0}}


def test_changes_written_for_an_earlier_version_are_found_and_what_is_ignored_is_said(tmp_path, monkeypatch):
    changes = (renamed("control.softness", "published.impedance"), removed("target.colour", "nobody sees it"))
    monkeypatch.setattr("sim.stored.PARAMETER_CHANGES", changes)
    file = tmp_path / "lab.toml"
    file.write_text("[changes]\nversion = 1\ncontrol.softness.damping = 3.0\ntarget.colour = 1\n")
    chosen = choose({}, file)
    assert chosen.settings.changes == {"published": {"impedance": {"damping": 3.0}}}
    assert chosen.notices == (f"settings file {str(file)!r}: target.colour is ignored: nobody sees it",)
    assert chosen.settings.initial_config().published.impedance.damping == 3.0


def test_a_setting_that_has_become_a_parameter_is_refused_with_where_it_belongs(tmp_path):
    file = tmp_path / "lab.toml"
    file.write_text("contact_threshold = 0.2\n")
    with pytest.raises(ConfigError, match=r"contact_threshold .*lab\.toml.*parameter perception\.contact_threshold"):
        choose({}, file)
    with pytest.raises(ConfigError, match=r"contact_threshold .*BECALM_CONTACT_THRESHOLD.*perception"):
        choose({"BECALM_CONTACT_THRESHOLD": "0.2"})


def test_what_is_given_to_the_class_itself_is_all_there_is(monkeypatch):
    monkeypatch.setenv("BECALM_PORT", "9000")
    assert Settings().port == 8000
    assert Settings.from_environment().port == 9000


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('prot = 8080\n', "prot = 8080: Extra inputs are not permitted .*lab.toml"),
        ('min_free_gb = -1\n', "min_free_gb = -1: .*greater than or equal to 0 .*lab.toml"),
        ('port = \n', "settings file .*lab.toml.* does not parse"),
    ],
)  # fmt: skip
def test_a_settings_file_that_cannot_be_is_named(tmp_path, content, words):
    file = tmp_path / "lab.toml"
    file.write_text(content)
    with pytest.raises(ConfigError, match=words):
        choose({}, file)
    with pytest.raises(ConfigError, match=r"none\.toml.*No such file"):
        choose({"BECALM_SETTINGS": str(tmp_path / "none.toml")})
