"""Access tokens: created and revoked by the command line, hashed at rest, looked up with every request.

A token is 256 random bits. Nobody can guess one or find it by its SHA-256, so that a slow password hash would
only make every request slow. The file is replaced as a whole, and read again when it has changed: a running
service knows a new or a revoked token with the next request.
"""

from __future__ import annotations

import hashlib
import logging
import os
import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Literal, NamedTuple

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field, ValidationError

from server.access.roles import Role
from server.errors import StoredUnreadable
from server.files import read_document, replace_file
from sim.errors import ConfigError
from sim.file_lock import ProcessLock

NAME = r"[A-Za-z0-9][A-Za-z0-9._-]{0,39}"
PREFIX = "becalm_"
SHORTEST_SECRET = 32
"""Characters of a token that comes from a file; those made here have 50."""

LONGEST_CHANGE = 10.0
"""What one process waits for another that changes the tokens [s]; it takes a few milliseconds."""

ADMIN_NAME = "admin"
"""Whose token the file of `BECALM_ADMIN_TOKEN_FILE` holds."""

log = logging.getLogger(__name__)


class Holder(NamedTuple):
    """Who asks, and what they may."""

    name: str
    role: Role


class Token(BaseModel):
    """What is kept of a token: everything but the token."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field(pattern=f"^{NAME}$")
    role: Role
    digest: str = Field(description="SHA-256, hexadecimal")
    created: AwareDatetime
    expires: AwareDatetime | None

    @property
    def expired(self) -> bool:
        """Whether it no longer holds."""
        return self.expires is not None and self.expires <= datetime.now(UTC)


class _TokenFile(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: Literal[1] = 1
    tokens: tuple[Token, ...] = ()


class _Stamp(NamedTuple):
    """What changes whenever a file does."""

    written: int
    changed: int
    inode: int
    size: int


class TokenStore:
    """The tokens of one data folder, and perhaps an administrator's from a file of its own.

    A file that cannot be read any more changes nothing of who is let in: the tokens that were last read go on holding,
    `damage` says why, and so does the log. STOP is for those who are signed in, whatever becomes of a disk.
    """

    def __init__(self, folder: Path, admin_file: Path | None = None) -> None:
        """Read nothing yet, but for the administrator's token.

        Raises:
            ConfigError: the administrator's file cannot be read, or holds no token.

        """
        self._path = folder / "tokens.json"
        self._admin_digest = _digest(_secret_in(admin_file)) if admin_file is not None else None
        self._stamp: _Stamp | None = None
        self._by_digest: dict[str, Token] = {}
        self._damage: ConfigError | None = None

    def create(self, name: str, role: Role, lifetime: timedelta | None = None) -> str:
        """Make a token; this is the only time that it is seen.

        Raises:
            ConfigError: there is one of that name, or the name cannot be one.

        """
        with self._changing():
            return self._create(name, role, lifetime)

    def _create(self, name: str, role: Role, lifetime: timedelta | None) -> str:
        present = self.tokens()
        if name == ADMIN_NAME or any(token.name == name for token in present):
            raise ConfigError(f"name = {name!r} is taken", tip="choose another, or revoke that token first")
        secret = PREFIX + secrets.token_urlsafe(32)
        created = datetime.now(UTC)
        expires = None if lifetime is None else created + lifetime
        try:
            token = Token(name=name, role=role, digest=_digest(secret), created=created, expires=expires)
        except ValidationError:
            raise ConfigError(f"name = {name!r}: write 1 to 40 letters, digits, dots, dashes or underscores") from None
        self._write((*present, token))
        return secret

    def revoke(self, name: str) -> None:
        """Let a token hold no longer, from the next request on.

        Raises:
            ConfigError: there is none of that name.

        """
        with self._changing():
            present = self.tokens()
            kept = tuple(token for token in present if token.name != name)
            if len(kept) == len(present):
                known = ", ".join(token.name for token in present) or "none"
                raise ConfigError(f"name = {name!r}: there is no such token; known: {known}")
            self._write(kept)

    def tokens(self) -> tuple[Token, ...]:
        """All of them, also those that have expired.

        Raises:
            ConfigError: their file cannot be read.

        """
        self._read_if_changed()
        if self._damage is not None:
            raise self._damage
        return tuple(self._by_digest.values())

    @property
    def damage(self) -> str | None:
        """Why the file of the tokens cannot be read; None while it can."""
        self._read_if_changed()
        return None if self._damage is None else str(self._damage)

    def operators(self) -> tuple[str, ...]:
        """Names of all who may command the mission."""
        self._read_if_changed()
        named = [each.name for each in self._by_digest.values() if each.role.covers(Role.OPERATOR) and not each.expired]
        return (*named, ADMIN_NAME) if self._admin_digest is not None else tuple(named)

    @property
    def any_valid(self) -> bool:
        """Whether anyone could be let in."""
        return self._admin_digest is not None or any(not token.expired for token in self.tokens())

    def holder_of(self, secret: str) -> Holder | None:
        """Whose token that is; None if it is not a token, or no longer valid."""
        digest = _digest(secret)
        if digest == self._admin_digest:
            return Holder(ADMIN_NAME, Role.ADMIN)
        self._read_if_changed()
        token = self._by_digest.get(digest)
        return None if token is None or token.expired else Holder(token.name, token.role)

    def _read_if_changed(self) -> None:
        try:
            status = self._path.stat()
        except FileNotFoundError:
            if self._by_digest:
                self._keep_what_held(f"{self._path.name} is gone", None)
            else:
                self._stamp = self._damage = None
            return
        except OSError as error:
            self._keep_what_held(f"{self._path.name}: {error.strerror}", None)
            return
        stamp = _Stamp(status.st_mtime_ns, status.st_ctime_ns, status.st_ino, status.st_size)
        if stamp == self._stamp:
            return
        try:
            kept = read_document(self._path, _TokenFile)
        except (FileNotFoundError, StoredUnreadable) as error:
            self._keep_what_held(str(error), stamp)
        else:
            self._stamp, self._damage = stamp, None
            self._by_digest = {token.digest: token for token in kept.tokens}

    def _keep_what_held(self, why: str, stamp: _Stamp | None) -> None:
        """Go on with the tokens that were last read; said once in the log."""
        tip = "restore it from a backup, or remove it, create new tokens and start the service again"
        damage = ConfigError(f"the tokens of {self._path.parent} cannot be read: {why}", tip=tip)
        if str(damage) != str(self._damage):
            log.error("%s; the %d tokens that were last read go on holding", damage, len(self._by_digest))
        self._stamp, self._damage = stamp, damage

    @contextmanager
    def _changing(self) -> Iterator[None]:
        """From reading the file to replacing it nobody else does so, in whatever process."""
        self._path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        lock = self._locked()
        try:
            yield
        finally:
            lock.release()

    def _locked(self) -> ProcessLock:
        given_up = time.monotonic() + LONGEST_CHANGE
        while True:
            try:
                return ProcessLock(self._path.with_suffix(".lock"))
            except BlockingIOError:
                if time.monotonic() > given_up:
                    what = f"the tokens of {self._path.parent} are being changed by another process"
                    raise ConfigError(what, tip="try again when that has ended") from None
                time.sleep(0.02)

    def _write(self, tokens: tuple[Token, ...]) -> None:
        replace_file(self._path, _TokenFile(tokens=tokens).model_dump_json(indent=1).encode(), mode=0o600)


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode(errors="surrogatepass")).hexdigest()


def _secret_in(path: Path) -> str:
    try:
        secret = path.read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        tip = f"the service's user, {os.getuid()}, must be able to read it"
        raise ConfigError(f"admin_token_file = '{path}' cannot be read: {error}", tip=tip) from None
    if len(secret) < SHORTEST_SECRET:
        what = f"admin_token_file = '{path}' holds {len(secret)} characters; a token has {SHORTEST_SECRET} or more"
        raise ConfigError(what, tip="write one with: python -c 'import secrets; print(secrets.token_urlsafe(32))'")
    return secret
