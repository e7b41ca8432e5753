"""A real nginx with a configuration that we ship, in front of a console."""

from __future__ import annotations

import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.deploy.ports import free_port

CONFIGURATIONS = Path(__file__).parents[2] / "deploy" / "nginx"
PATIENCE = 180.0

needs_nginx = pytest.mark.skipif(
    not (shutil.which("nginx") and shutil.which("openssl")), reason="needs nginx and openssl"
)


class Site(NamedTuple):
    """What nginx serves."""

    port: int
    certificate: Path


@contextmanager
def site(folder: Path, configuration: str, host: str, console_port: int) -> Iterator[Site]:
    """nginx with that file of ours in its `http` block, and a certificate for that host, once it listens."""
    certificate, key = _certificate(folder, host)
    port = free_port()
    changes = {
        "listen 443": f"listen 127.0.0.1:{port}",
        "http://127.0.0.1:8000": f"http://127.0.0.1:{console_port}",
        "/etc/ssl/becalm.pem": str(certificate),
        "/etc/ssl/private/becalm.key": str(key),
    }
    text = (CONFIGURATIONS / configuration).read_text()
    for ours, theirs in changes.items():
        assert text.count(ours) == 1
        text = text.replace(ours, theirs)
    with _running(folder, text, port):
        yield Site(port, certificate)


def _certificate(folder: Path, host: str) -> tuple[Path, Path]:
    pair = (folder / "becalm.pem", folder / "becalm.key")
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
         "-subj", f"/CN={host}", "-addext", f"subjectAltName=DNS:{host},IP:127.0.0.1",
         "-out", pair[0], "-keyout", pair[1]], check=True, capture_output=True, timeout=PATIENCE,
    )  # fmt: skip
    return pair


@contextmanager
def _running(folder: Path, http: str, port: int) -> Iterator[None]:
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
