"""Roles, and which one each request takes: the only place that says so."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import NamedTuple

WEBSOCKET = "WEBSOCKET"
"""Stands for the method of a request that opens one."""


class Role(StrEnum):
    """What somebody may do; each may do all that those before it may."""

    VIEWER = "viewer"
    OPERATOR = "operator"
    ADMIN = "admin"

    def covers(self, needed: Role) -> bool:
        """Whether this role is enough where that one is needed."""
        order = list(Role)
        return order.index(self) >= order.index(needed)


class Rule(NamedTuple):
    """Requests and the role they take; None: no token at all."""

    methods: frozenset[str]
    path: re.Pattern[str]
    role: Role | None


_READ = "GET HEAD OPTIONS"
_ANY = f"{_READ} POST PUT PATCH DELETE {WEBSOCKET}"


def _rule(methods: str, path: str, role: Role | None) -> Rule:
    return Rule(frozenset(methods.split()), re.compile(path), role)


RULES = (
    _rule(_READ, "/api/v1/health", None),
    _rule(_ANY, "/api/v1/session", None),
    # STOP comes from anyone who may see the mission.
    _rule("POST", "/api/v1/mission/stop", Role.VIEWER),
    _rule(f"{_READ} {WEBSOCKET}", "/(api/v1|scene)(/.*)?", Role.VIEWER),
    _rule("GET HEAD", "/metrics", Role.VIEWER),
    _rule("DELETE", "/api/v1/(presets|rehearsals|atlases|alarms)/.*", Role.OPERATOR),
    _rule("DELETE", "/api/v1/.*", Role.ADMIN),
    _rule("POST PUT PATCH", "/api/v1/.*", Role.OPERATOR),
    # The console's own files hold nothing of the mission, and sign people in.
    _rule(_READ, r"/|/index\.html|/favicon\.svg|/(assets|swagger|help)/.*", None),
    _rule(_READ, ".*", Role.VIEWER),
)
"""The first that fits holds."""


def needed_role(method: str, path: str) -> Role | None:
    """The role that a request takes, None if it takes no token; what no rule names takes the highest."""
    for rule in RULES:
        if method in rule.methods and rule.path.fullmatch(path):
            return rule.role
    return Role.ADMIN
