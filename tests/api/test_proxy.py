"""The nginx configurations that we ship, with a real nginx in front of a real console; skipped without one."""

from __future__ import annotations

import json
import socket
import ssl
import time
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
import websockets.sync.client
from websockets import Origin

from server.access.roles import Role
from server.access.tokens import TokenStore
from server.settings import Settings
from tests.deploy.nginx import PATIENCE, needs_nginx, site

pytestmark = needs_nginx

SITES = {"becalm.conf": ("becalm.lab.example", ""), "becalm-under-a-path.conf": ("lab.example", "/becalm")}
"""Each configuration's host, and the path at which it shows the console."""


class Proxied:
    """A console with tokens behind nginx, as a browser on its page reaches it."""

    def __init__(self, host: str, path: str, port: int, trust: ssl.SSLContext, token: str) -> None:
        self.path = path
        self.port = port
        self.host = host
        self.trust = trust
        self.token = token
        self.headers = {"Host": f"{host}:{port}", "Origin": f"https://{host}:{port}"}

    def http(self) -> httpx.Client:
        base = f"https://127.0.0.1:{self.port}{self.path}"
        return httpx.Client(base_url=base, verify=self.trust, headers=self.headers, timeout=PATIENCE)

    def websocket(self, path: str, headers: dict[str, str]) -> websockets.sync.client.ClientConnection:
        """By the name of the proxy's host, which no name server knows."""
        return websockets.sync.client.connect(
            f"wss://{self.headers['Host']}{self.path}{path}",
            sock=socket.create_connection(("127.0.0.1", self.port)),
            ssl=self.trust,
            server_hostname=self.host,
            origin=Origin(headers["Origin"]),
            additional_headers={"Cookie": headers["Cookie"]},
            open_timeout=PATIENCE,
            proxy=None,
        )


@pytest.fixture(params=SITES)
def proxied(request, tmp_path, serving) -> Iterator[Proxied]:
    with _proxied(request.param, tmp_path, serving) as behind:
        yield behind


@contextmanager
def _proxied(configuration, folder, serving) -> Iterator[Proxied]:
    host, path = SITES[configuration]
    token = TokenStore(folder / "data" / "access").create("ana", Role.OPERATOR)
    settings = Settings(
        data_dir=folder / "data",
        require_tokens=True,
        configuration="published_figures",
        allowed_hosts=(host, "127.0.0.1"),
        trusted_proxies=("127.0.0.1",),
    )
    with serving(settings) as console, site(folder, configuration, host, console.port) as shown:
        trust = ssl.create_default_context(cafile=shown.certificate)
        yield Proxied(host, path, shown.port, trust, token)


def test_the_console_works_behind_nginx(proxied):
    with proxied.http() as http:
        assert http.get("/").status_code == 200
        assert http.get("/api/v1/mission").status_code == 401
        signed_in = http.post("/api/v1/session", json={"token": proxied.token})
        assert signed_in.status_code == 200
        cookie, *limits = signed_in.headers["set-cookie"].split("; ")
        assert {"Secure", "HttpOnly", f"Path={proxied.path or '/'}"} <= set(limits)
        signed = {**proxied.headers, "Cookie": cookie}
        deadline = time.monotonic() + PATIENCE
        while http.get("/api/v1/health").json()["status"] != "ok":
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert http.post("/api/v1/mission/stop", headers=signed).status_code == 200
        foreign = {**signed, "Origin": "https://elsewhere.example"}
        assert http.post("/api/v1/mission/stop", headers=foreign).status_code == 403
        assert "viser" in http.get("/scene/", headers=signed).text.lower()
        assert http.get("/scene", headers=signed).headers["location"] == f"{proxied.path}/scene/"
        described = http.get("/openapi.json").json()
        assert described.get("servers", [{"url": ""}])[0]["url"] == proxied.path
    with proxied.websocket("/api/v1/telemetry", signed) as telemetry:
        kinds = [json.loads(telemetry.recv(PATIENCE))["type"] for _ in range(3)]
    assert kinds == ["hello", "history", "snapshot"]
