"""Users, passwords and TLS: who may connect, and who may not. test_service.py has whole processes with both."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from pydantic import ValidationError

from server.link import contract
from server.link.session import LinkSession, Transport
from sim.errors import ConfigError

from .ends import PATIENCE, Certificates, free_endpoint

Settings = dict[str, object]
ENOUGH = 10
"""Messages that one end has heard of which those who may not hear have missed all."""


@contextmanager
def _session(**transport: object) -> Iterator[LinkSession]:
    session = LinkSession(Transport.model_validate(transport))
    try:
        yield session
    finally:
        session.close()


class _Ear:
    """Counts what an end hears."""

    def __init__(self, session: LinkSession) -> None:
        self.heard = 0
        self.enough = threading.Event()
        session.subscribe(contract.MODE, self._hear)

    def _hear(self, _: bytes) -> None:
        self.heard += 1
        if self.heard >= ENOUGH:
            self.enough.set()


def _tell(robot: LinkSession, until: threading.Event) -> bool:
    """Publish until that is so."""
    for _ in range(round(PATIENCE / 0.02)):
        robot.publish(contract.MODE, b"mode")
        if until.wait(0.02):
            return True
    return False


def _assert_let_in(listening: Settings, welcome: Settings, strangers: list[Settings]) -> None:
    """Strangers that tried first, and go on trying, hear nothing of what the welcome end hears."""
    with _session(**listening) as robot, ExitStack() as ends:
        others = [ends.enter_context(_session(**stranger)) for stranger in strangers]
        deaf = [_Ear(other) for other in others]
        ear = _Ear(ends.enter_context(_session(**welcome)))
        assert _tell(robot, ear.enough)
        assert [each.heard for each in deaf] == [0] * len(deaf)
        assert not any(other.connected for other in others)


def test_only_the_right_user_and_password_are_let_in(users: dict[str, Path]):
    endpoint = free_endpoint()
    _assert_let_in(
        {"listen": (endpoint,), "users_file": users["users"]},
        {"connect": (endpoint,), "user": "ana", "password_file": users["right"]},
        [
            {"connect": (endpoint,), "user": "ana", "password_file": users["wrong"]},
            {"connect": (endpoint,), "user": "bob", "password_file": users["right"]},
            {"connect": (endpoint,)},
        ],
    )


def test_only_certificates_of_the_same_authority_are_let_in(certificates: Certificates):
    endpoint = free_endpoint("tls").replace("127.0.0.1", "localhost")
    _assert_let_in(
        {"listen": (endpoint,), **certificates.of("robot")},
        {"connect": (endpoint,), **certificates.of("console")},
        [
            {"connect": (endpoint,), **certificates.of("other")},
            {"connect": (endpoint,), **certificates.of("console", authority="other")},
        ],
    )


def test_settings_that_do_not_belong_together_are_named(tmp_path: Path):
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
