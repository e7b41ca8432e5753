"""The audit log: nobody washes it out, and nobody else reads it."""

from __future__ import annotations

import json
import logging
import logging.handlers
import os
import stat

import pytest

from server.access import audit
from server.access.audit import OFTEN, AuditLog
from server.access.roles import Role
from server.access.tokens import Holder

ANA, WALL = Holder("ana", Role.OPERATOR), Holder("wall", Role.VIEWER)


class Kept:
    """An audit log with a clock of its own."""

    def __init__(self, folder) -> None:
        self.folder = folder
        self.now = 100.0
        self.log = AuditLog(folder / "audit.log", clock=lambda: self.now)
        self.log.start()

    def ask(self, holder=None, status=401, path="/api/v1/mission", address="10.0.0.1", method="GET") -> None:
        who, role = (holder.name, holder.role.value) if holder else (None, None)
        self.log.write(holder, who=who, role=role, address=address, method=method, path=path, status=status)

    def lines(self, name: str) -> list[dict]:
        self.log.shutdown()
        self.log.start()
        return [json.loads(line) for line in (self.folder / name).read_text().splitlines()]


@pytest.fixture
def kept(tmp_path):
    kept = Kept(tmp_path / "access")
    yield kept
    kept.log.shutdown()


def test_a_stranger_who_asks_often_is_counted(kept):
    kept.ask(ANA, 200, "/api/v1/mission/stop", method="POST")
    for each in range(900):
        kept.ask(path=f"/{each}" + "x" * 8000)
    lines = kept.lines("strangers.log")
    assert len(lines) == OFTEN + 1
    assert lines[-1]["asker"] == "10.0.0.1"
    assert lines[-1]["more"] == {"GET 401": 900 - OFTEN}
    assert max(len(json.dumps(line)) for line in lines) < 600
    assert [line["who"] for line in kept.lines("audit.log")] == ["ana"]


def test_a_viewer_who_asks_often_is_counted_but_what_operators_did_is_not(kept):
    for _ in range(OFTEN + 50):
        kept.ask(WALL, 200, "/api/v1/mission/stop", method="POST")
        kept.ask(ANA, 200, "/api/v1/mission/stop", method="POST")
    lines = kept.lines("audit.log")
    assert [line.get("who") for line in lines].count("ana") == OFTEN + 50
    assert [line["more"] for line in lines if line.get("asker") == "wall"] == [{"POST 200": 50}]


def test_a_new_minute_has_lines_again(kept):
    for _ in range(OFTEN + 1):
        kept.ask()
    kept.now += audit.WINDOW
    kept.ask(status=403)
    lines = kept.lines("strangers.log")
    assert lines[-2]["more"] == {"GET 401": 1}
    assert lines[-1]["status"] == 403


def test_many_addresses_and_methods_are_counted_together(kept, monkeypatch):
    monkeypatch.setattr(audit, "ASKERS", 10)
    for each in range(2000):
        kept.ask(address=f"10.0.{each // 250}.{each % 250}", method="M" * 5000 + str(each))
    lines = kept.lines("strangers.log")
    assert len(lines) < 50
    assert sum(sum(line.get("more", {}).values()) for line in lines) + OFTEN + 10 == 2000
    assert max(len(json.dumps(line)) for line in lines) < 6000


def test_odd_texts_stay_on_their_line(kept):
    kept.ask(path="/a\r\n\x1b[2J\ud800\u2028", address="x" * 900)
    [line] = kept.lines("strangers.log")
    assert line["path"] == r"/a\r\n\x1b[2J\ud800\u2028"
    assert len(line["address"]) < 100


def test_only_the_owner_reads_it_nor_what_was_rotated(tmp_path):
    os.umask(os.umask(0o022) & 0)  # whatever the umask is
    path = tmp_path / "audit.log"
    path.write_text("old\n")
    path.chmod(0o644)
    file = audit._OwnersFile(path, maxBytes=100, backupCount=3)
    for _ in range(10):
        file.emit(logging.makeLogRecord({"msg": "x" * 60}))
    file.close()
    found = {each.name: stat.S_IMODE(each.stat().st_mode) for each in tmp_path.iterdir()}
    assert len(found) == 4
    assert set(found.values()) == {0o600}
