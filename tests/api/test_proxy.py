"""The nginx configuration that we ship, with a real nginx in front of a real console; skipped without one."""

from __future__ import annotations

import json
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import websockets.sync.client

from server.access.roles import Role
from server.access.tokens import TokenStore
from server.settings import Settings
from tests.deploy.ports import free_port

CONFIGURATION = Path(__file__).parents[2] / "deploy" / "nginx" / "becalm.conf"
HOST = "becalm.lab.example"
PATIENCE = 60.0

pytestmark = pytest.mark.skipif(
    not (shutil.which("nginx") and shutil.which("openssl")), reason="needs nginx and openssl"
)


@pytest.fixture
def certificate(tmp_path):
    """A certificate for the host of the configuration, and its key."""
    pair = (tmp_path / "becalm.pem", tmp_path / "becalm.key")
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
         "-subj", f"/CN={HOST}", "-addext", f"subjectAltName=DNS:{HOST},IP:127.0.0.1",
         "-out", pair[0], "-keyout", pair[1]], check=True, capture_output=True,
    )  # fmt: skip
    return pair


@pytest.fixture
def proxied(tmp_path, certificate, serving):
    """A console with tokens behind nginx: the port of nginx, and an operator's token."""
    token = TokenStore(tmp_path / "data" / "access").create("ana", Role.OPERATOR)
    settings = Settings(data_dir=tmp_path / "data", require_tokens=True, allowed_hosts=(HOST,))
    port = free_port()
    with serving(settings) as console:
        changes = {
            "listen 443": f"listen 127.0.0.1:{port}",
            "http://127.0.0.1:8000": f"http://127.0.0.1:{console.port}",
            "/etc/ssl/becalm.pem": str(certificate[0]),
            "/etc/ssl/private/becalm.key": str(certificate[1]),
        }
        text = CONFIGURATION.read_text()
        for ours, theirs in changes.items():
            assert text.count(ours) == 1
            text = text.replace(ours, theirs)
        with _nginx(tmp_path, text, port):
            yield port, token


@contextmanager
def _nginx(folder: Path, http: str, port: int) -> Iterator[None]:
    """nginx with this in its `http` block, once it listens."""
    kinds = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    own = " ".join(f"{kind}_temp_path {folder}/{kind};" for kind in kinds)
    configuration = folder / "nginx.conf"
    configuration.write_text(
        f"daemon off; pid {folder}/nginx.pid; events {{}}\nhttp {{ access_log off; {own}\n{http} }}\n"
    )
    with subprocess.Popen(["nginx", "-e", str(folder / "error.log"), "-c", str(configuration)]) as process:
        try:
            deadline = time.monotonic() + PATIENCE
            while not _listens(port):
                assert process.poll() is None, (folder / "error.log").read_text()
                assert time.monotonic() < deadline
                time.sleep(0.05)
            yield
        finally:
            process.terminate()


def _listens(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port)).close()
    except OSError:
        return False
    return True


def test_the_console_works_behind_nginx(proxied, certificate):
    port, token = proxied
    trust = ssl.create_default_context(cafile=certificate[0])
    site = f"{HOST}:{port}"
    own = {"Host": site, "Origin": f"https://{site}"}
    with httpx.Client(base_url=f"https://127.0.0.1:{port}", verify=trust, headers=own) as http:
        assert http.get("/").status_code == 200
        assert http.get("/api/v1/mission").status_code == 401
        signed_in = http.post("/api/v1/session", json={"token": token})
        assert signed_in.status_code == 200
        cookie = signed_in.headers["set-cookie"]
        assert "Secure" in cookie
        assert "HttpOnly" in cookie
        signed = {**own, "Cookie": cookie.partition(";")[0]}
        deadline = time.monotonic() + PATIENCE
        while http.get("/api/v1/health").json()["status"] != "ok":
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert http.post("/api/v1/mission/stop", headers=signed).status_code == 200
        foreign = {**signed, "Origin": "https://elsewhere.example"}
        assert http.post("/api/v1/mission/stop", headers=foreign).status_code == 403
        assert "viser" in http.get("/scene/", headers=signed).text.lower()
    with _connected(port, "/api/v1/telemetry", trust, signed) as telemetry:
        kinds = [json.loads(telemetry.recv(PATIENCE))["type"] for _ in range(3)]
    assert kinds == ["hello", "history", "snapshot"]


def _connected(port: int, path: str, trust: ssl.SSLContext, headers: dict[str, str]):
    """A WebSocket by the name of the proxy's host, which no name server knows."""
    return websockets.sync.client.connect(
        f"wss://{headers['Host']}{path}",
        sock=socket.create_connection(("127.0.0.1", port)),
        ssl=trust,
        server_hostname=HOST,
        origin=headers["Origin"],
        additional_headers={"Cookie": headers["Cookie"]},
        proxy=None,
    )
