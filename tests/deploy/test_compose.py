"""docker-compose.yml: what the specification allows, what the commands and settings really are, and nothing exposed."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any

import click
import httpx
import pytest
import yaml
from jsonschema import Draft202012Validator

from becalm.cli import main
from server.settings import Settings, choose
from tests.deploy.ports import free_port

COMPOSE_SPECIFICATION = files("check_jsonschema") / "builtin_schemas" / "vendor" / "compose-spec.json"
"""The schema that the compose specification publishes, as the package check-jsonschema carries it."""

ROOT = Path(__file__).parents[2]
_VARIABLE = re.compile(r"\$\{(\w+)(?::-([^}]*))?\}")


def _interpolated(value: Any, environment: dict[str, str]) -> Any:
    """As compose puts variables and their defaults in."""
    if isinstance(value, dict):
        return {key: _interpolated(each, environment) for key, each in value.items()}
    if isinstance(value, list):
        return [_interpolated(each, environment) for each in value]
    if isinstance(value, str):
        return _VARIABLE.sub(lambda found: environment.get(found[1]) or found[2] or "", value)
    return value


def _project(**environment: str) -> dict:
    return _interpolated(yaml.safe_load((ROOT / "docker-compose.yml").read_text()), environment)


PROJECT = _project()
SERVICES: dict[str, dict] = PROJECT["services"]
PATIENCE = 600.0
UNHURRIED = 5.0
"""Deadline of the link [s] that a busy machine keeps, too."""
CONSOLES = ("console", "simulation")


def _command(service: str) -> list[str]:
    return [str(part) for part in SERVICES[service].get("command", ["becalm", "serve", "--no-open"])]


def test_the_specification_allows_it():
    schema = json.loads(COMPOSE_SPECIFICATION.read_text())
    validator = Draft202012Validator(schema)
    assert list(validator.iter_errors(PROJECT)) == []
    broken = {**PROJECT, "services": {"console": {"imagee": "becalm"}}}
    assert list(validator.iter_errors(broken))


def test_the_services_and_their_profiles():
    profiles = {name: service.get("profiles", []) for name, service in SERVICES.items()}
    assert profiles == {
        "console": [], "router": [], "robot": [],
        "simulation": ["simulation"], "scheduler": ["cluster"], "worker": ["cluster"],
    }  # fmt: skip


@pytest.mark.parametrize("name", SERVICES)
def test_every_service_is_confined(name):
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service["restart"] == "unless-stopped"
    assert service["mem_limit"]
    assert float(service["cpus"]) > 0
    assert service["healthcheck"]
    assert "privileged" not in service


def test_the_image_is_built_once_and_never_looked_for_in_a_registry():
    """Each service that builds it makes an image of a gigabyte of its own, of which all but the last have no name."""
    assert {name for name, service in SERVICES.items() if "build" in service} == set(CONSOLES)
    assert {service["image"] for service in SERVICES.values()} == {"becalm:latest"}
    assert {service["pull_policy"] for service in SERVICES.values()} == {"never"}


@pytest.mark.parametrize("name", SERVICES)
def test_what_flies_comes_first_and_is_not_stopped_by_a_quota(name):
    """A quota that is used up stops a container for the rest of 100 ms, and a health check uses up half a core's."""
    service = SERVICES[name]
    flies = name in (*CONSOLES, "router", "robot")
    assert float(service["cpus"]) >= 1
    assert service["cpu_shares"] > 1024 if flies else service["cpu_shares"] < 1024


def test_ports_are_on_loopback_unless_a_setting_says_otherwise():
    ports = [port for service in SERVICES.values() for port in service.get("ports", [])]
    assert sorted(ports) == ["127.0.0.1:8000:8000", "127.0.0.1:8001:8000"]
    open_ports = _project(BECALM_BIND="0.0.0.0")["services"]["console"]["ports"]
    assert open_ports == ["0.0.0.0:8000:8000"]


def test_what_waits_for_another_s_health_waits_for_one_that_tells_it():
    for name, service in SERVICES.items():
        for other, how in service.get("depends_on", {}).items():
            told = "disable" not in SERVICES[other]["healthcheck"]
            assert how["condition"] == ("service_healthy" if told else "service_started"), (name, other)
            assert set(service["networks"]) & set(SERVICES[other]["networks"])


def test_volumes_networks_and_secrets_are_declared_and_used():
    for kind in ("volumes", "networks", "secrets"):
        used = {str(each).split(":")[0] for service in SERVICES.values() for each in service.get(kind, [])}
        assert used == set(PROJECT[kind])


def test_no_token_stands_in_an_environment():
    for service in SERVICES.values():
        assert not [name for name in service.get("environment", {}) if "TOKEN" in name and not name.endswith("_FILE")]


@pytest.mark.parametrize("name", CONSOLES)
def test_the_settings_of_a_console_can_be(name, tmp_path):
    environment = {key: str(value) for key, value in SERVICES[name]["environment"].items()}
    known = {f"BECALM_{field.upper()}" for field in Settings.model_fields}
    assert set(environment) <= known
    token = tmp_path / "admin.token"
    token.write_text("x" * 43)
    settings = choose({**environment, "BECALM_HOST": "0.0.0.0", "BECALM_ADMIN_TOKEN_FILE": str(token)}).settings
    assert settings.tokens_required
    assert (settings.keep_days, settings.scheduler) == (None, None)


@pytest.mark.parametrize("name", SERVICES)
def test_every_command_is_one(name):
    program, *arguments = _command(name)
    if program == "becalm":
        command = main.commands[arguments[0]]
        assert command.make_parser(click.Context(command)).parse_args(arguments[1:])
    elif program == "dask":
        helps = _output(sys.executable, "-m", "distributed.cli.dask_" + arguments[0], "--help")
        for option in (part for part in arguments if part.startswith("--")):
            assert option.replace("--no-", "/--no-") in helps or option in helps
    else:
        assert (ROOT / "deploy" / "container" / program).stat().st_mode & 0o111


def _output(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout


def test_the_example_of_an_environment_names_every_variable_with_its_default():
    example = dict(re.findall(r"^#(\w+)=(.*)$", (ROOT / ".env.example").read_text(), re.M))
    used = dict(_VARIABLE.findall((ROOT / "docker-compose.yml").read_text()))
    assert set(example) == set(used)
    for name in set(example) - {
        "BECALM_ALLOWED_HOSTS",
        "BECALM_SCHEDULER",
        "BECALM_TRUSTED_PROXIES",
    }:  # these show what one looks like
        assert example[name] == used[name]


def test_the_settings_that_the_example_suggests_can_be():
    example = dict(re.findall(r"^#(\w+)=(.*)$", (ROOT / ".env.example").read_text(), re.M))
    project = _project(**example)
    environment = project["services"]["simulation"]["environment"]
    settings = choose({name: str(value) for name, value in environment.items()}).settings
    assert settings.scheduler == "tcp://scheduler:8786"
    assert settings.allowed_hosts == ("becalm.lab.example",)


def test_the_scheduler_is_where_the_workers_and_the_example_look_for_it():
    assert _command("worker")[2] == "tcp://scheduler:8786"
    assert shlex.join(_command("scheduler")).endswith("--port 8786 --no-dashboard")


@contextmanager
def _running(*command: str, **environment: str) -> Iterator[str]:
    """A program of the compose file on this machine; gives its first line."""
    variables = {**os.environ, "PYTHONUNBUFFERED": "1", **environment}
    with subprocess.Popen([sys.executable, *command], stdout=subprocess.PIPE, text=True, env=variables) as process:
        try:
            yield process.stdout.readline()
        finally:
            process.terminate()


def test_console_router_and_robot_find_each_other(tmp_path):
    """The commands and settings of the three services, on loopback's ports in place of their host names."""
    port = str(free_port())

    def here(words: list[str]) -> list[str]:
        return [re.sub(r"tcp/(?:router|0\.0\.0\.0):7447", f"tcp/127.0.0.1:{port}", word) for word in words]

    router = [str(ROOT / "deploy" / "container" / "router"), *here(_command("router")[1:])]
    # The machine may be busy with other tests: who finds whom is the question here, not how punctually.
    robot = ["-m", *here(_command("robot")), "--deadline", str(UNHURRIED)]
    console = {key: here([str(value)])[0] for key, value in SERVICES["console"]["environment"].items()}
    del console["BECALM_ADMIN_TOKEN_FILE"]  # on loopback nobody needs one
    console["BECALM_DATA_DIR"] = str(tmp_path)
    console["BECALM_LINK_DEADLINE"] = str(UNHURRIED)
    with (
        _running(*router),
        _running(*robot),
        _running("-m", "becalm", "serve", "--port", "0", "--no-open", **console) as ready,
    ):
        url = re.search(r"http://\S+/", ready)[0]
        deadline = time.monotonic() + PATIENCE
        while (health := httpx.get(url + "api/v1/health", timeout=PATIENCE).json())["status"] != "ok":
            assert time.monotonic() < deadline, health
            time.sleep(0.1)
        assert health["plant"] == "zenoh"
        assert health["link_age"] < PATIENCE
        assert "becalm_link_age_seconds" in httpx.get(url + "metrics", timeout=PATIENCE).text
