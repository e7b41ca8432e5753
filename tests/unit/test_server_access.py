"""Tokens, roles, the limit on failures, and the policy of pages."""

from __future__ import annotations

import base64
import hashlib
import json
import stat
import threading
from datetime import timedelta

import pytest

from server.access import attempts
from server.access.attempts import Attempts
from server.access.headers import content_policy, inline_scripts
from server.access.roles import WEBSOCKET, Role, needed_role
from server.access.tokens import Holder, TokenStore
from server.edge.authority import network_of
from sim.errors import ConfigError


@pytest.fixture
def tokens(tmp_path):
    return TokenStore(tmp_path / "access")


class TestTokens:
    def test_a_token_names_its_holder(self, tokens):
        secret = tokens.create("ana", Role.OPERATOR)
        assert tokens.holder_of(secret) == Holder("ana", Role.OPERATOR)
        assert tokens.holder_of(secret + "x") is None
        assert tokens.holder_of("") is None

    def test_the_file_holds_no_token_and_only_its_owner_reads_it(self, tokens, tmp_path):
        secret = tokens.create("ana", Role.OPERATOR)
        path = tmp_path / "access" / "tokens.json"
        assert secret not in path.read_text()
        assert json.loads(path.read_text())["tokens"][0]["digest"] == hashlib.sha256(secret.encode()).hexdigest()
        assert stat.S_IMODE(path.stat().st_mode) == 0o600

    def test_another_process_knows_of_changes_at_once(self, tokens, tmp_path):
        service = TokenStore(tmp_path / "access")
        assert not service.any_valid
        secret = tokens.create("ana", Role.VIEWER)
        assert service.holder_of(secret) == Holder("ana", Role.VIEWER)
        tokens.revoke("ana")
        assert service.holder_of(secret) is None

    def test_those_that_are_made_at_once_are_all_kept(self, tokens, tmp_path):
        stores = [TokenStore(tmp_path / "access") for _ in range(8)]
        makers = [
            threading.Thread(target=store.create, args=(f"n{each}", Role.VIEWER)) for each, store in enumerate(stores)
        ]
        for maker in makers:
            maker.start()
        for maker in makers:
            maker.join()
        assert sorted(token.name for token in tokens.tokens()) == [f"n{each}" for each in range(8)]

    def test_one_that_has_expired_holds_no_longer(self, tokens):
        secret = tokens.create("ana", Role.ADMIN, timedelta(seconds=-1))
        assert tokens.holder_of(secret) is None
        assert not tokens.any_valid
        assert tokens.tokens()[0].expired

    def test_a_name_is_given_once(self, tokens):
        tokens.create("ana", Role.VIEWER)
        for name in ("ana", "admin"):
            with pytest.raises(ConfigError, match="is taken"):
                tokens.create(name, Role.VIEWER)

    @pytest.mark.parametrize("name", ["", "a b", "../x", "é", "x" * 41])
    def test_names_that_cannot_be(self, tokens, name):
        with pytest.raises(ConfigError, match="letters"):
            tokens.create(name, Role.VIEWER)

    def test_a_token_that_there_is_not_cannot_be_revoked(self, tokens):
        tokens.create("ana", Role.VIEWER)
        with pytest.raises(ConfigError, match="known: ana"):
            tokens.revoke("bob")

    def test_a_damaged_file_lets_nobody_in_and_says_so(self, tokens, tmp_path):
        (tmp_path / "access").mkdir()
        (tmp_path / "access" / "tokens.json").write_text("{")
        with pytest.raises(ConfigError, match="damaged"):
            tokens.tokens()
        assert tokens.holder_of("anything") is None

    @pytest.mark.parametrize(
        "content",
        [b"", b"{", b"\xff\xfe", b"[]", b"null", b"[" * 100_000, b'{"version": 2}', b'{"tokens": [{"name": 1}]}',
         b'{"tokens": [{"name": "a", "role": "king", "digest": "x", "created": "now", "expires": null}]}',
         b'{"tokens": [{"name": "a", "role": "admin", "digest": "x", "created": "2026-01-01T00:00:00",'
         b' "expires": "2026-01-01T00:00:00"}]}'],
    )  # fmt: skip
    def test_what_becomes_of_the_file_changes_nothing_of_who_is_let_in(self, tokens, tmp_path, content, caplog):
        secret = tokens.create("ana", Role.OPERATOR)
        path = tmp_path / "access" / "tokens.json"
        whole = path.read_bytes()
        assert tokens.holder_of(secret)
        path.write_bytes(content)
        for _ in range(3):
            assert tokens.holder_of(secret) == Holder("ana", Role.OPERATOR)
            assert tokens.operators() == ("ana",)
        assert "tokens.json" in tokens.damage
        assert caplog.text.count("go on holding") == 1
        path.write_bytes(whole)
        assert (tokens.holder_of(secret), tokens.damage) == (Holder("ana", Role.OPERATOR), None)

    def test_a_file_that_is_gone_or_a_folder_in_its_place_is_damage_too(self, tokens, tmp_path):
        secret = tokens.create("ana", Role.OPERATOR)
        path = tmp_path / "access" / "tokens.json"
        assert tokens.holder_of(secret)
        path.unlink()
        assert (tokens.holder_of(secret).name, "gone" in tokens.damage) == ("ana", True)
        path.mkdir()
        assert (tokens.holder_of(secret).name, "not a regular file" in tokens.damage) == ("ana", True)
        path.rmdir()
        path.with_name("elsewhere").write_text("x")
        path.symlink_to(path)
        assert (tokens.holder_of(secret).name, tokens.damage is not None) == ("ana", True)

    def test_a_secret_of_any_text_is_no_token(self, tokens):
        for text in ("\ud800", "\x00", "é" * 10_000):
            assert tokens.holder_of(text) is None

    def test_an_administrators_token_from_a_file(self, tmp_path):
        (tmp_path / "secret").write_text("s" * 43 + "\n")
        tokens = TokenStore(tmp_path / "access", tmp_path / "secret")
        assert tokens.any_valid
        assert tokens.holder_of("s" * 43) == Holder("admin", Role.ADMIN)

    @pytest.mark.parametrize("content", [None, "short"])
    def test_a_file_without_a_token_is_refused(self, tmp_path, content):
        if content is not None:
            (tmp_path / "secret").write_text(content)
        with pytest.raises(ConfigError, match="admin_token_file"):
            TokenStore(tmp_path, tmp_path / "secret")


class TestRoles:
    def test_each_covers_those_before_it(self):
        assert [Role.OPERATOR.covers(role) for role in Role] == [True, True, False]

    @pytest.mark.parametrize(
        ("method", "path", "role"),
        [
            ("GET", "/", None),
            ("GET", "/assets/index-1.js", None),
            ("GET", "/api/v1/health", None),
            ("GET", "/metrics", Role.VIEWER),
            ("POST", "/api/v1/session", None),
            ("GET", "/api/v1/mission", Role.VIEWER),
            (WEBSOCKET, "/api/v1/telemetry", Role.VIEWER),
            (WEBSOCKET, "/scene", Role.VIEWER),
            ("GET", "/scene/", Role.VIEWER),
            ("POST", "/api/v1/mission/stop", Role.VIEWER),
            ("POST", "/api/v1/mission/commands", Role.OPERATOR),
            ("PATCH", "/api/v1/mission/config", Role.OPERATOR),
            ("POST", "/api/v1/runs", Role.OPERATOR),
            ("DELETE", "/api/v1/runs/x", Role.ADMIN),
            ("GET", "/openapi.json", Role.VIEWER),
            ("POST", "/anything", Role.ADMIN),
            (WEBSOCKET, "/anything", Role.ADMIN),
        ],
    )
    def test_of_requests(self, method, path, role):
        assert needed_role(method, path) == role

    def test_health_lets_nobody_change_anything(self):
        assert needed_role("POST", "/api/v1/health") == Role.OPERATOR


class TestAttempts:
    def test_after_ten_failures_an_address_waits_for_the_first_to_grow_old(self):
        now = [100.0]
        counted = Attempts(clock=lambda: now[0])
        for each in range(attempts.ALLOWED):
            assert counted.failed("a", f"guess-{each}") is None
            now[0] += 1.0
        assert counted.failed("a", "another") == pytest.approx(attempts.WINDOW - attempts.ALLOWED)
        assert counted.failed("b", "another") is None
        now[0] = 100.0 + attempts.WINDOW
        assert counted.failed("a", "another") is None

    def test_the_same_token_again_is_no_further_try(self):
        counted = Attempts(clock=lambda: 0.0)
        assert {counted.failed("a", "revoked") for _ in range(500)} == {None}
        for each in range(attempts.ALLOWED - 1):
            assert counted.failed("a", f"guess-{each}") is None
        assert counted.failed("a", "one more")
        assert counted.failed("a", "revoked") is None

    def test_a_network_of_addresses_is_one_somebody(self):
        counted = Attempts(clock=lambda: 0.0)
        for each in range(attempts.ALLOWED):
            assert counted.failed(f"fd00:0:0:1::{each:x}", f"guess-{each}") is None
        assert counted.failed("fd00:0:0:1:ffff::1", "another")
        assert counted.failed("fd00:0:0:2::1", "another") is None
        assert network_of("::ffff:10.0.0.1") == network_of("10.0.0.1")

    def test_memory_is_bounded(self):
        counted = Attempts()
        for address in range(attempts.ADDRESSES + 50):
            counted.failed(str(address), "guess")
        assert len(counted._failures) == attempts.ADDRESSES


class TestPolicy:
    def test_scripts_of_a_page_are_allowed_by_their_digest(self):
        script = "let a = 1 > 0;\r\nb()"
        page = f'<head><script data-x="a > b">{script}</script><script src="/x.js"></script></head>'.encode()
        digest = base64.b64encode(hashlib.sha256(script.replace("\r\n", "\n").encode()).digest()).decode()
        assert inline_scripts(page) == f"'sha256-{digest}'"

    def test_scripts_are_our_files_unless_said_otherwise(self):
        assert "script-src 'self'" in content_policy()
        assert content_policy("script-src 'none'").count("script-src") == 1
