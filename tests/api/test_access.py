"""A service that asks for tokens: who gets in, what they may, and what is logged of it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import time
from functools import partial

import httpx
import pytest
import viser
from click.testing import CliRunner
from starlette.routing import Route, WebSocketRoute
from websockets.asyncio import client as websocket
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.typing import Subprotocol

import becalm
from becalm.cli import main
from server.access.attempts import ALLOWED
from server.access.lease import NOT_SIGNED_IN, REASON
from server.access.roles import RULES, WEBSOCKET, Role
from server.access.tokens import TokenStore
from server.app import create_app
from server.settings import Settings
from sim.errors import ConfigError

PATIENCE = 180.0
"""Bound on a wait for the disk [s]."""

connect = partial(websocket.connect, open_timeout=PATIENCE)


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    return Settings(data_dir=tmp_path_factory.mktemp("data"), require_tokens=True, configuration="published_figures")


@pytest.fixture(scope="module")
def secrets(settings):
    store = TokenStore(settings.data_dir / "access")
    return {role: store.create(f"a-{role}", role) for role in Role}


@pytest.fixture(scope="module")
def guarded(secrets, settings, serving):
    assert secrets, "tokens are there before the service is"
    with serving(settings) as served:
        yield served


def bearer(secret: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {secret}"}


def ask(served, method: str, path: str, secret: str | None = None, **more) -> httpx.Response:
    with httpx.Client(base_url=served.api, trust_env=False, timeout=PATIENCE) as client:
        return client.request(method, path, headers=bearer(secret) if secret else {}, **more)


def audited(served, settings) -> list[dict]:
    served.services.access.audit.shutdown()  # which writes what waits
    served.services.access.audit.start()
    lines = (settings.data_dir / "access" / "audit.log").read_text().splitlines()
    return [json.loads(line) for line in lines]


def test_without_a_token_only_health_the_session_and_the_page_answer(guarded):
    assert ask(guarded, "GET", "/health").status_code == 200
    assert ask(guarded, "GET", "/session").json() == {"token_needed": True, "name": None, "role": None}
    for method, path in (("GET", "/mission"), ("POST", "/mission/stop"), ("GET", "/runs"), ("GET", "/nothing")):
        answer = ask(guarded, method, path)
        assert answer.status_code == 401
        assert answer.headers["www-authenticate"].startswith("Bearer")
        assert answer.headers["content-type"] == "application/problem+json"
        assert "Authorization: Bearer" in answer.json()["tip"]


@pytest.mark.parametrize(
    ("role", "mission", "stop", "command", "delete"),
    [(Role.VIEWER, 200, 200, 403, 403), (Role.OPERATOR, 200, 200, 422, 403), (Role.ADMIN, 200, 200, 422, 404)],
)
def test_roles(guarded, secrets, role, mission, stop, command, delete):
    secret = secrets[role]
    assert ask(guarded, "GET", "/mission", secret).status_code == mission
    assert ask(guarded, "POST", "/mission/stop", secret).status_code == stop
    assert ask(guarded, "POST", "/mission/commands", secret, json={"command": "dance"}).status_code == command
    assert ask(guarded, "DELETE", "/runs/20261122T113000123-4f9a2c", secret).status_code == delete


def test_the_missions_log_names_who_asked(guarded, secrets):
    ask(guarded, "POST", "/mission/commands", secrets[Role.OPERATOR], json={"command": "reset"})
    ask(guarded, "POST", "/mission/commands", secrets[Role.OPERATOR], json={"command": "detumble"})
    ask(guarded, "POST", "/mission/stop", secrets[Role.VIEWER])
    run = ask(guarded, "GET", "/mission", secrets[Role.VIEWER]).json()["run_id"]
    expected = [("detumble", "a-operator"), ("stop", "a-viewer")]
    deadline = time.monotonic() + PATIENCE
    while (asked := _asked(guarded, run, secrets))[-2:] != expected and time.monotonic() < deadline:
        time.sleep(0.05)  # the recorder writes in a thread of its own
    assert asked[-2:] == expected


def _asked(guarded, run, secrets):
    """Who gave which command, as the run's log has it on disk now."""
    events = ask(guarded, "GET", f"/runs/{run}/events", secrets[Role.VIEWER]).json()
    return [(event["command"], event["who"]) for event in events if event["kind"] == "command"]


async def test_telemetry_and_scene_are_behind_the_same_check(guarded, secrets):
    scene = guarded.telemetry.replace("/api/v1/telemetry", "/scene")
    for address in (guarded.telemetry, scene):
        with pytest.raises(InvalidStatus) as refused:
            await connect(address)
        assert refused.value.response.status_code == 403
    async with connect(guarded.telemetry, additional_headers=bearer(secrets[Role.VIEWER])) as watcher:
        assert json.loads(await watcher.recv())["type"] == "hello"


def test_the_client_says_why_it_gets_no_telemetry(guarded, secrets):
    address = guarded.api.removesuffix("/api/v1")
    with becalm.Client(address) as nobody, pytest.raises(becalm.ServiceRefused) as refused:
        next(nobody.watch())
    assert refused.value.status == 403
    with becalm.Client(address, secrets[Role.VIEWER]) as viewer:
        assert next(viewer.watch()).run_id == viewer.mission().run_id


def test_a_browser_keeps_the_token_in_a_cookie_no_script_reads(guarded, secrets):
    with httpx.Client(base_url=guarded.api, trust_env=False, timeout=PATIENCE) as browser:
        answer = browser.post("/session", json={"token": secrets[Role.OPERATOR]})
        assert answer.json() == {"token_needed": True, "name": "a-operator", "role": "operator"}
        cookie = answer.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=strict" in cookie
        assert browser.get("/mission").status_code == 200
        assert browser.delete("/session").status_code == 204
        assert browser.get("/mission").status_code == 401


def test_a_revoked_token_holds_no_longer_and_a_new_one_at_once(guarded, settings):
    store = TokenStore(settings.data_dir / "access")
    secret = store.create("guest", Role.VIEWER)
    assert ask(guarded, "GET", "/mission", secret).status_code == 200
    store.revoke("guest")
    assert ask(guarded, "GET", "/mission", secret).status_code == 401


async def test_sockets_end_with_their_token(guarded, settings, secrets):
    store = TokenStore(settings.data_dir / "access")
    guest = bearer(store.create("guest-2", Role.VIEWER))
    viewer = bearer(secrets[Role.VIEWER])
    addresses = [guarded.telemetry, guarded.telemetry.replace("/api/v1/telemetry", "/scene")]
    protocol = [Subprotocol(f"viser-v{viser.__version__}")]
    async with contextlib.AsyncExitStack() as stack:
        ended = [
            await stack.enter_async_context(
                connect(each, additional_headers=guest, subprotocols=protocol, max_size=None)
            )
            for each in addresses
        ]
        staying = await stack.enter_async_context(connect(guarded.telemetry, additional_headers=viewer))
        store.revoke("guest-2")
        for socket in ended:
            with pytest.raises(ConnectionClosedError) as closed:
                await asyncio.wait_for(_read_to_the_end(socket), PATIENCE)
            assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (NOT_SIGNED_IN, REASON)
        await staying.recv()


async def _read_to_the_end(socket) -> None:
    while True:
        await socket.recv()


def test_nothing_that_becomes_of_the_token_file_keeps_anybody_from_stop(guarded, secrets, settings):
    path = settings.data_dir / "access" / "tokens.json"
    whole = path.read_bytes()
    assert ask(guarded, "POST", "/mission/stop", secrets[Role.VIEWER]).status_code == 200
    path.write_bytes(whole[:100])
    try:
        assert ask(guarded, "POST", "/mission/stop", secrets[Role.VIEWER]).status_code == 200
        assert ask(guarded, "GET", "/mission", "nonesuch").status_code in (401, 429)
        assert "cannot be read" in ask(guarded, "GET", "/health").json()["access_failure"]
    finally:
        path.write_bytes(whole)
    assert ask(guarded, "GET", "/health").json()["access_failure"] is None


def test_where_a_request_comes_from_is_not_what_it_says(guarded):
    for each in range(ALLOWED + 1):
        headers = {**bearer(f"guess-{each}"), "X-Forwarded-For": f"10.0.0.{each}"}
        answer = httpx.get(guarded.api + "/mission", headers=headers, trust_env=False, timeout=PATIENCE)
    assert answer.status_code == 429


def test_trying_tokens_is_slowed_down_but_holders_are_let_in(guarded, secrets):
    answers = [ask(guarded, "GET", "/mission", f"guess-{each}") for each in range(ALLOWED + 1)]
    assert answers[-1].status_code == 429
    assert int(answers[-1].headers["retry-after"]) > 0
    signing_in = ask(guarded, "POST", "/session", json={"token": "another guess"})
    assert (signing_in.status_code, "retry-after" in signing_in.headers) == (429, True)
    stop = ask(guarded, "POST", "/mission/stop", "a guess at STOP")
    assert (stop.status_code, stop.json()["detail"]) == (401, "this token is unknown, has expired or was revoked")
    assert ask(guarded, "GET", "/mission", secrets[Role.VIEWER]).status_code == 200


def test_what_changes_and_what_is_refused_is_logged(guarded, secrets, settings):
    ask(guarded, "POST", "/mission/stop", secrets[Role.VIEWER])
    ask(guarded, "PATCH", "/mission/config", secrets[Role.VIEWER], json={})
    entries = [(each["who"], each["method"], each["path"], each["status"]) for each in audited(guarded, settings)]
    assert ("a-viewer", "POST", "/api/v1/mission/stop", 200) in entries
    assert ("a-viewer", "PATCH", "/api/v1/mission/config", 403) in entries
    assert all(secret not in json.dumps(audited(guarded, settings)) for secret in secrets.values())


def test_every_route_has_a_rule(tmp_path):
    app = create_app(Settings(data_dir=tmp_path, configuration="published_figures"))
    asked = []
    for path, operations in app.openapi()["paths"].items():
        asked += [(method.upper(), path) for method in operations]
    for route in app.routes:
        if isinstance(route, Route):
            asked += [(method, route.path) for method in route.methods or ()]
        elif isinstance(route, WebSocketRoute):
            asked.append((WEBSOCKET, route.path))
    assert len(asked) > 25
    without = [
        each for each in asked if not any(each[0] in rule.methods and rule.path.fullmatch(each[1]) for rule in RULES)
    ]
    assert without == []


def test_every_answer_carries_the_security_headers(guarded):
    for path in ("/", "/api/v1/health", "/api/v1/mission", "/nothing"):
        headers = httpx.get(guarded.api.removesuffix("/api/v1") + path, trust_env=False, timeout=PATIENCE).headers
        assert "default-src 'self'" in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"


def test_a_service_for_others_refuses_to_start_without_a_token(tmp_path):
    with pytest.raises(ConfigError, match="nobody has one"):
        create_app(Settings(data_dir=tmp_path, host="0.0.0.0"))
    assert create_app(Settings(data_dir=tmp_path, host="0.0.0.0", require_tokens=False))
    result = CliRunner().invoke(main, ["serve", "--host", "0.0.0.0"], env={"BECALM_DATA_DIR": str(tmp_path)})
    assert result.exit_code == 2
    assert "becalm token create" in result.stderr


class TestCommandLine:
    def invoke(self, tmp_path, *arguments: str):
        return CliRunner().invoke(main, ["token", *arguments], env={"BECALM_DATA_DIR": str(tmp_path)})

    def test_create_list_revoke(self, tmp_path):
        made = self.invoke(tmp_path, "create", "ana", "--role", "operator", "--days", "2")
        assert TokenStore(tmp_path / "access").holder_of(made.stdout.strip()).name == "ana"
        assert "this once" in made.stderr
        [listed] = json.loads(self.invoke(tmp_path, "list", "--json").stdout)
        assert (listed["name"], listed["role"], listed["expired"]) == ("ana", "operator", False)
        assert "digest" not in listed
        assert self.invoke(tmp_path, "revoke", "ana").exit_code == 0
        assert json.loads(self.invoke(tmp_path, "list", "--json").stdout) == []

    def test_what_cannot_be_is_said(self, tmp_path):
        assert self.invoke(tmp_path, "create", "ana", "--role", "king").exit_code == 2
        refused = self.invoke(tmp_path, "revoke", "ana")
        assert (refused.exit_code, "no such token" in refused.stderr) == (2, True)
