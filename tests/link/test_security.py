"""Users, passwords and TLS: who may connect, and who may not."""

from __future__ import annotations

import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from ends import PATIENCE, free_endpoint
from pydantic import ValidationError

from server.link import contract
from server.link.session import LinkSession, Transport
from sim.errors import ConfigError

REFUSED_FOR = 1.0
"""How long a message that must not come is waited for [s]; one that may comes within a tenth of that."""


@contextmanager
def _session(**transport: object) -> Iterator[LinkSession]:
    session = LinkSession(Transport.model_validate(transport))
    try:
        yield session
    finally:
        session.close()


def _heard(robot: LinkSession, console: LinkSession, patience: float) -> bool:
    """Whether what one end publishes arrives at the other."""
    came = threading.Event()
    console.subscribe(contract.MODE, lambda _: came.set())
    for _ in range(round(patience / 0.05)):
        robot.publish(contract.MODE, b"mode")
        if came.wait(0.05):
            return True
    return False


@pytest.fixture
def users(tmp_path: Path) -> dict[str, Path]:
    files = {"users": "ana:secret\n", "right": "secret\n", "wrong": "guess\n"}
    for name, content in files.items():
        tmp_path.joinpath(name).write_text(content)
    return {name: tmp_path / name for name in files}


def test_the_right_password_is_let_in(users):
    endpoint = free_endpoint()
    with (
        _session(listen=(endpoint,), users_file=users["users"]) as robot,
        _session(connect=(endpoint,), user="ana", password_file=users["right"]) as console,
    ):
        assert _heard(robot, console, PATIENCE)


@pytest.mark.parametrize(
    "user", [{"user": "ana", "password_file": "wrong"}, {"user": "bob", "password_file": "right"}, {}]
)
def test_others_are_not(users, user):
    endpoint = free_endpoint()
    if user:
        user = {**user, "password_file": users[user["password_file"]]}
    with (
        _session(listen=(endpoint,), users_file=users["users"]) as robot,
        _session(connect=(endpoint,), **user) as stranger,
    ):
        assert not _heard(robot, stranger, REFUSED_FOR)
        assert not stranger.connected


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An authority of our own, a robot's and a console's certificate by it, and a stranger's by itself."""
    folder = tmp_path_factory.mktemp("certificates")
    _openssl(folder, "req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.pem -days 2 -subj /CN=lab")
    for name in ("robot", "console"):
        (folder / f"{name}.ext").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        _openssl(folder, f"req -newkey rsa:2048 -nodes -keyout {name}.key -out {name}.csr -subj /CN=localhost")
        signed = f"x509 -req -in {name}.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 -extfile {name}.ext"
        _openssl(folder, f"{signed} -out {name}.pem")
    _openssl(folder, "req -x509 -newkey rsa:2048 -nodes -keyout other.key -out other.pem -days 2 -subj /CN=localhost")
    return folder


def _openssl(folder: Path, arguments: str) -> None:
    subprocess.run(["openssl", *arguments.split()], cwd=folder, check=True, capture_output=True)


def _tls(folder: Path, name: str, authority: str = "ca") -> dict[str, Path]:
    return {
        "tls_ca": folder / f"{authority}.pem",
        "tls_certificate": folder / f"{name}.pem",
        "tls_key": folder / f"{name}.key",
    }


def test_certificates_of_the_same_authority_are_let_in(certificates):
    endpoint = free_endpoint("tls").replace("127.0.0.1", "localhost")
    with (
        _session(listen=(endpoint,), **_tls(certificates, "robot")) as robot,
        _session(connect=(endpoint,), **_tls(certificates, "console")) as console,
    ):
        assert _heard(robot, console, PATIENCE)


@pytest.mark.parametrize("stranger", [("other", "ca"), ("console", "other")])
def test_other_certificates_are_not(certificates, stranger):
    endpoint = free_endpoint("tls").replace("127.0.0.1", "localhost")
    with (
        _session(listen=(endpoint,), **_tls(certificates, "robot")) as robot,
        _session(connect=(endpoint,), **_tls(certificates, *stranger)) as console,
    ):
        assert not _heard(robot, console, REFUSED_FOR)


def test_settings_that_do_not_belong_together_are_named(tmp_path):
    with pytest.raises(ValidationError, match="password_file belong together"):
        Transport(user="ana")
    with pytest.raises(ValidationError, match="tls_key belong together"):
        Transport(tls_certificate=tmp_path / "robot.pem")
    with pytest.raises(ConfigError, match="none"):
        LinkSession(Transport(listen=(free_endpoint(),), user="ana", password_file=tmp_path / "none"))


def test_an_endpoint_that_is_taken_is_named():
    endpoint = free_endpoint()
    with _session(listen=(endpoint,)), pytest.raises(ConfigError, match=endpoint):
        LinkSession(Transport(listen=(endpoint,)))
