"""One end of a zenoh link: the only module that imports zenoh.

Scouting is off: an end talks to the endpoints that it was given and to nobody else. It keeps trying to connect, so
either side may start first and come back later. Streams are dropped rather than blocked on: a peer that hangs costs
its own data, nothing else.
"""

from __future__ import annotations

import json
import logging
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import zenoh
from pydantic import BaseModel, ConfigDict, Field, model_validator

from server.link.contract import Channel, Urgency
from server.link.refusals import ThrottledLog
from sim.errors import ConfigError

Endpoint = Annotated[str, Field(pattern=r"^(tcp|tls|quic)/\S+:\d+$", description="tcp/HOST:PORT or tls/HOST:PORT")]
QUEUED = {"data_high": 16, "interactive_high": 16, "data": 4}
"""Batches that may wait while zenoh's sending thread or the receiver is held up for a moment, a batch or two a control
period: for about as long as a deadline. What does not fit is dropped; what waited is judged by its stamp."""
LEASE = 1000
"""After which zenoh gives up a silent transport [ms]."""
CLOSING_TIME = 2.0
"""What an end waits for its session to close [s]: a host name that nobody answers for any more holds zenoh for ten."""

_PRIORITY = {
    Urgency.STOP: zenoh.Priority.REAL_TIME,
    Urgency.CONTROL: zenoh.Priority.INTERACTIVE_HIGH,
    Urgency.STREAM: zenoh.Priority.DATA_HIGH,
    Urgency.REPORT: zenoh.Priority.DATA,
}

log = logging.getLogger(__name__)


class Transport(BaseModel):
    """Where and how an end of the link is reached."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    connect: tuple[Endpoint, ...] = Field((), description="Endpoints to connect to, tcp/HOST:PORT or tls/HOST:PORT")
    listen: tuple[Endpoint, ...] = Field((), description="Endpoints to listen on")
    user: str | None = Field(None, description="Name by which this end is known to the other")
    password_file: Path | None = Field(None, description="File that holds that user's password")
    users_file: Path | None = Field(None, description="Who may connect to this end: lines of user:password")
    tls_ca: Path | None = Field(None, description="Certificates of the authorities that the other end is checked by")
    tls_certificate: Path | None = Field(None, description="This end's certificate")
    tls_key: Path | None = Field(None, description="Its private key")

    @model_validator(mode="after")
    def _belong_together(self) -> Transport:
        if (self.user is None) != (self.password_file is None):
            raise ValueError("user and password_file belong together: give both or neither")
        if (self.tls_certificate is None) != (self.tls_key is None):
            raise ValueError("tls_certificate and tls_key belong together: give both or neither")
        return self


class LinkSession:
    """An open end of the link. Callbacks come on zenoh's threads and must not wait for anything."""

    def __init__(self, transport: Transport) -> None:
        """Open it; whether the other end is there shows later.

        Raises:
            ConfigError: an endpoint that cannot be had, or a file that cannot be read.

        """
        try:
            self._session = zenoh.open(_config(transport))
        except zenoh.ZError as error:
            where = ", ".join((*transport.listen, *transport.connect))
            raise ConfigError(f"the link cannot be opened at {where}: {error}", tip=_TIP) from None
        self._throttled_log = ThrottledLog(log)
        self._publishers: dict[str, Any] = {}
        self._subscribers: list[Any] = []

    def publish(self, channel: Channel, payload: bytes) -> None:
        """Send a message, or drop it if the way is blocked; for any thread."""
        publisher = self._publishers.get(channel.key)
        if publisher is None:
            publisher = self._publishers[channel.key] = self._session.declare_publisher(
                channel.key,
                congestion_control=zenoh.CongestionControl.DROP,
                priority=_PRIORITY[channel.urgency],
                express=channel.express,
                encoding=zenoh.Encoding.APPLICATION_CDR,
            )
        publisher.put(payload)

    def subscribe(self, channel: Channel, take: Callable[[bytes], None]) -> None:
        """Give every message of this channel to `take`, which is called on zenoh's thread."""

        def received(sample: Any) -> None:
            try:
                take(sample.payload.to_bytes())
            except Exception as error:  # zenoh would print it and go on; the log is where it is looked for
                what = f"{type(error).__name__}: {error}"
                self._throttled_log.warning(
                    channel.key, f"a message on {channel.key} could not be taken: {what[:200]}", time.monotonic()
                )
                log.debug("a message on %s", channel.key, exc_info=error)

        self._subscribers.append(self._session.declare_subscriber(channel.key, received))

    @property
    def connected(self) -> bool:
        """Whether any other end is there."""
        return bool(self._session.info.peers_zid() or self._session.info.routers_zid())

    def close(self) -> bool:
        """End it; False if it is left to the system after `CLOSING_TIME`. Nothing is sent or taken afterwards."""
        closing = threading.Thread(target=self._session.close, name="link-closing", daemon=True)
        closing.start()
        closing.join(CLOSING_TIME)
        if closing.is_alive():
            log.warning("the link did not close within %.0f s and is left to the system", CLOSING_TIME)
            return False
        return True


_TIP = "endpoints are written tcp/HOST:PORT or tls/HOST:PORT; docs/link.md shows TLS, users and passwords"


def _config(transport: Transport) -> zenoh.Config:
    config = zenoh.Config()
    for key, value in {
        "mode": "router",  # routes, so that a router in between is one more endpoint; and keeps trying as a peer does
        "listen/endpoints": list(transport.listen),
        "connect/endpoints": list(transport.connect),
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "scouting/delay": 0,  # nobody is looked for, so nobody need be waited for
        "transport/link/tx/lease": LEASE,
        **{f"transport/link/tx/queue/size/{priority}": batches for priority, batches in QUEUED.items()},
        **_users(transport),
        **_tls(transport),
    }.items():
        config.insert_json5(key, json.dumps(value))
    return config


def _users(transport: Transport) -> dict[str, Any]:
    given: dict[str, Any] = {}
    if transport.user is not None and transport.password_file is not None:
        given["user"] = transport.user
        given["password"] = _read(transport.password_file).strip()
    if transport.users_file is not None:
        _read(transport.users_file)
        given["dictionary_file"] = str(transport.users_file)
        given.setdefault("user", "robot")
        given.setdefault("password", "")
    return {"transport/auth/usrpwd": given} if given else {}


def _tls(transport: Transport) -> dict[str, Any]:
    given: dict[str, Any] = {}
    if transport.tls_ca is not None:
        given["root_ca_certificate"] = str(transport.tls_ca)
    if transport.tls_certificate is not None:
        given |= {
            "listen_certificate": str(transport.tls_certificate),
            "listen_private_key": str(transport.tls_key),
            "connect_certificate": str(transport.tls_certificate),
            "connect_private_key": str(transport.tls_key),
        }
    if transport.tls_ca is not None and transport.tls_certificate is not None:
        given["enable_mtls"] = True
    return {"transport/link/tls": given} if given else {}


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
