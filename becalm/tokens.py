"""`becalm token`: who may sign in to the service of this data folder."""

from __future__ import annotations

import json
from datetime import timedelta
from typing import Any

import click

from server.access.roles import Role
from server.access.tokens import Token, TokenStore
from server.settings import Settings

SHORTEST_DAYS, LONGEST_DAYS = 1e-5, 36_525
"""Days for which a token may be valid: a second to a hundred years."""

EXAMPLES = """\b
Examples:
  becalm token create ana --role operator
  becalm token create wall-display --role viewer --days 365
  becalm token list
  becalm token revoke ana

\b
Roles:
  viewer      sees everything, and may press STOP
  operator    commands the mission, changes parameters, starts runs and studies
  admin       deletes runs and studies besides

Tokens lie in BECALM_DATA_DIR; a running service knows of a change at once.
"""


def _store() -> TokenStore:
    return TokenStore(Settings.from_environment().data_dir / "access")


def _lifetime(_context: click.Context, _option: click.Parameter, days: float | None) -> timedelta | None:
    if days is None:
        return None
    if not SHORTEST_DAYS <= days <= LONGEST_DAYS:  # NaN fails this, too
        raise click.BadParameter(
            f"{days:g} days: write {SHORTEST_DAYS:.0e} to {LONGEST_DAYS}; left out, it does not expire"
        )
    return timedelta(days=days)


@click.group("token", epilog=EXAMPLES, short_help="Make, list and revoke access tokens.")
def token() -> None:
    """Make, list and revoke the tokens by which people and scripts sign in."""


@token.command()
@click.argument("name")
@click.option("--role", type=click.Choice([role.value for role in Role]), required=True, help="What it allows.")
@click.option(
    "--days", type=float, callback=_lifetime, help="How long it is valid.  [default: without end; at most 36525]"
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document.")
def create(*, name: str, role: str, days: timedelta | None, as_json: bool) -> None:
    """Make a token for NAME and print it: this once, it is kept nowhere."""
    secret = _store().create(name, Role(role), days)
    if as_json:
        click.echo(json.dumps({"name": name, "role": role, "token": secret}))
    else:
        click.echo(secret)
        click.echo(f"That is the token of {name} ({role}). It is shown this once; keep it safe.", err=True)


@token.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document.")
def list_tokens(*, as_json: bool) -> None:
    """List the tokens by name, never what they are."""
    found = [_described(each) for each in _store().tokens()]
    if as_json:
        click.echo(json.dumps(found))
        return
    for each in found:
        holds = "expired" if each["expired"] else f"until {each['expires']}" if each["expires"] else "without end"
        click.echo(f"{each['name']:<24}{each['role']:<10}{holds}")
    if not found:
        click.echo("There are none yet: becalm token create NAME --role operator", err=True)


@token.command()
@click.argument("name")
def revoke(*, name: str) -> None:
    """Revoke the token of NAME."""
    _store().revoke(name)
    click.echo(f"The token of {name} is revoked.", err=True)


def _described(each: Token) -> dict[str, Any]:
    kept = each.model_dump(mode="json", exclude={"digest"})
    return {**kept, "expired": each.expired}
