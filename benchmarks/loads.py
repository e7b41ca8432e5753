"""What strangers and readers do to a service, each in a process of its own: `benchmarks.loads NAME PORT RUN SECONDS`.

Loopback only, and bounded in time: every load ends by itself. `benchmarks.stop` measures and `tests/soak` holds that
STOP is obeyed promptly, and no tick is late, whatever these do.
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import msgspec
import viser

from server.library.record import TickArray
from server.library.runs import RunStore, new_record
from sim.capture.run import run_capture
from sim.configurations import named_configuration

SOCKETS = 3
"""Connections of a flood."""

READERS = 4
"""Requests that are always under way of a load that reads."""

PATIENCE = 30.0
"""How long a request of a load may take [s]."""

READY = "begins\n"
"""What a load says when it has loaded all that it needs."""

_BURST = 64
"""Frames that a flood sends at once."""

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1.0, -2.0, 3],
    "fov": 0.45,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 420,
    "image_width": 900,
    "look_at": [0.0, 0.5, 0.05],
    "up_direction": [0, 0, 1],
}
"""What a browser says when its visitor turns the scene; whole numbers come as such."""


def signed_in() -> dict[str, str]:
    """The header of who has the token in BECALM_TOKEN, if there is one."""
    token = os.environ.get("BECALM_TOKEN")
    return {"Authorization": f"Bearer {token}"} if token else {}


def frame(payload: bytes, opcode: int = 1) -> bytes:
    """A masked WebSocket frame of up to 64 kB."""
    length = len(payload)
    head = (
        struct.pack("!BB", 0x80 | opcode, 0x80 | length)
        if length < 126
        else struct.pack("!BBH", 0x80 | opcode, 0xFE, length)
    )
    return head + b"\0\0\0\0" + payload


def opened(port: int, path: str, subprotocol: str | None = None) -> socket.socket:
    """A WebSocket connection as bare as it can be."""
    link = socket.create_connection(("127.0.0.1", port), PATIENCE)
    lines = [
        f"GET {path} HTTP/1.1",
        f"Host: 127.0.0.1:{port}",
        *(f"{name}: {value}" for name, value in signed_in().items()),
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}",
        *([f"Sec-WebSocket-Protocol: {subprotocol}"] if subprotocol else []),
    ]
    link.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
    head = link.recv(4096)
    if b" 101 " not in head.split(b"\r\n", 1)[0]:
        raise ConnectionError(head[:200])
    return link


def flood(port: int, path: str, frames: bytes, until: float, subprotocol: str | None = None) -> None:
    """Send frames as fast as they are taken, and throw away what comes; start over when let go."""
    while time.monotonic() < until:
        with contextlib.suppress(OSError), opened(port, path, subprotocol) as link:
            link.settimeout(0.2)
            threading.Thread(target=_drained, args=(link, until), daemon=True).start()
            while time.monotonic() < until:
                with contextlib.suppress(TimeoutError):
                    link.sendall(frames)
        time.sleep(0.05)


def _drained(link: socket.socket, until: float) -> None:
    while time.monotonic() < until:
        with contextlib.suppress(TimeoutError):
            try:
                if not link.recv(1 << 18):
                    return
            except TimeoutError:
                continue
            except OSError:
                return


def floods(port: int, path: str, payload: bytes, until: float, opcode: int = 1, subprotocol: str | None = None) -> None:
    """The same on several connections at once."""
    frames = frame(payload, opcode) * _BURST
    _together(SOCKETS, lambda: flood(port, path, frames, until, subprotocol))


def client(port: int) -> httpx.Client:
    """A client of the service, signed in."""
    address = f"http://127.0.0.1:{port}/api/v1"
    return httpx.Client(base_url=address, headers=signed_in(), timeout=PATIENCE, trust_env=False)


def asked(port: int, until: float, ask: Callable[[httpx.Client], None]) -> None:
    """Ask again and again, several at once."""

    def keep_asking() -> None:
        with client(port) as http:
            while time.monotonic() < until:
                with contextlib.suppress(httpx.HTTPError):
                    ask(http)

    _together(READERS, keep_asking)


def _together(count: int, work: Callable[[], None]) -> None:
    threads = [threading.Thread(target=work, daemon=True) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE + 60)


def _viser() -> str:
    return f"viser-v{viser.__version__}"


def _download(http: httpx.Client, address: str) -> None:
    with http.stream("GET", address) as answer:
        for _ in answer.iter_raw():
            pass


def _replay(port: int, run_id: str, until: float) -> None:
    """Drag a replay to and fro."""
    frames = b"".join(frame(json.dumps({"type": "show", "time": 7.0 * (each % 9)}).encode()) for each in range(8))

    def drag() -> None:
        while time.monotonic() < until:
            with contextlib.suppress(OSError), opened(port, f"/api/v1/runs/{run_id}/playback") as link:
                link.settimeout(0.5)
                while time.monotonic() < until:
                    link.sendall(frames)
                    time.sleep(0.1)
                    with contextlib.suppress(TimeoutError):
                        if not link.recv(1 << 18):
                            break
            time.sleep(0.05)

    _together(3, drag)


def _idle(port: int, _: str, until: float) -> None:
    links = []
    for _each in range(1000):
        with contextlib.suppress(OSError):
            links.append(socket.create_connection(("127.0.0.1", port), 1.0))
    time.sleep(max(0.0, until - time.monotonic()))
    for link in links:
        link.close()


MANY_NAMES = {f"stranger_{number}.of.another.house": 1.0 for number in range(2000)}

_STUDY = {
    "name": "huge",
    "configuration": "published",
    "grid": {
        "published.impedance.damping": {"from": 0.0, "to": 15.0, "count": 200},
        "published.impedance.stiffness": {"from": 0.0, "to": 100.0, "count": 200},
    },
}

LOADS: dict[str, Callable[[int, str, float], None]] = {
    "quiet": lambda _port, _run, until: time.sleep(max(0.0, until - time.monotonic())),
    "telemetry": lambda port, _run, until: floods(port, "/api/v1/telemetry?rate=1", b"rubbish" * 8, until),
    "pings": lambda port, _run, until: floods(port, "/api/v1/telemetry?rate=1", b"", until, opcode=9),
    "playback": lambda port, run, until: floods(port, f"/api/v1/runs/{run}/playback", b"rubbish" * 8, until),
    "scene": lambda port, _run, until: floods(
        port, "/scene", msgspec.msgpack.encode(CAMERA), until, opcode=2, subprotocol=_viser()
    ),
    "patches": lambda port, _run, until: asked(port, until, _patch),
    "ticks": lambda port, run, until: asked(
        port, until, lambda http: _download(http, f"/runs/{run}/ticks?points=20000")
    ),
    "exports": lambda port, run, until: asked(port, until, lambda http: _exports(http, run)),
    "lists": lambda port, _run, until: asked(port, until, lambda http: _download(http, "/runs?limit=200")),
    "history": lambda port, _run, until: asked(port, until, lambda http: _download(http, "/mission/history")),
    "replays": _replay,
    "estimates": lambda port, _run, until: asked(
        port, until, lambda http: http.post("/studies", json={"study": _STUDY}) and None
    ),
    "idle": _idle,
}
"""By name: (port of the service, a run of its library, until when by `time.monotonic`)."""


def _everything(port: int, run_id: str, until: float) -> None:
    works = [load for name, load in LOADS.items() if name not in ("quiet", "everything")]
    threads = [threading.Thread(target=load, args=(port, run_id, until), daemon=True) for load in works]
    for thread in threads:
        thread.start()
    time.sleep(max(0.0, until - time.monotonic()))


LOADS["everything"] = _everything


def _patch(http: httpx.Client) -> None:
    http.patch("/mission/config", json=MANY_NAMES)


def _exports(http: httpx.Client, run_id: str) -> None:
    for log_format in ("csv", "parquet", "mcap"):
        _download(http, f"/runs/{run_id}/log?format={log_format}")


def library(folder: Path, seconds: float = 60.0) -> str:
    """A library with one long run in it: its identifier."""
    store = RunStore(folder / "runs").make_root()
    record = new_record("scripted", "published", named_configuration("published"))
    store.create(record)
    pieces: list[TickArray] = []
    run_capture(record.config, on_ticks=lambda ticks: pieces.append(ticks.copy()))
    period = record.config.control.period
    writer = store.write(record)
    tick = 0
    while tick * period < seconds:
        for piece in pieces:
            rows = piece.copy()
            rows["tick"] = tick + (piece["tick"] - piece["tick"][0])
            rows["time"] = rows["tick"] * period
            tick = int(rows["tick"][-1]) + 1
            writer.append(rows)
            writer.flush()
    writer.close(status="finished")
    return record.id


@contextmanager
def under(name: str, port: int, run_id: str, seconds: float) -> Iterator[None]:
    """That load, until the end of the block or so many seconds later."""
    arguments = [sys.executable, "-m", "benchmarks.loads", name, str(port), run_id, str(seconds)]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == READY
            yield
        finally:
            process.kill()


def main() -> int:
    """One load."""
    name, port, run_id, seconds = sys.argv[1:]
    print(READY, end="", flush=True)
    LOADS[name](int(port), run_id, time.monotonic() + float(seconds))
    return 0


if __name__ == "__main__":
    sys.exit(main())
