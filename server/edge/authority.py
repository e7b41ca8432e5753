"""Hosts and origins as what they are: scheme, host and port, not texts."""

from __future__ import annotations

import ipaddress
import re
from typing import NamedTuple

import idna

DEFAULT_PORTS = {"http": 80, "https": 443}

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")

LONGEST_NAME = 253
"""Characters of a host name (RFC 1035)."""

_AUTHORITY = re.compile(
    r"(?:\[(?P<address>[0-9A-Fa-f:.]+)\]|(?P<name>[^\s\[\]@:/\\?#%<>^|\x00-\x20\x7f]+))(?::(?P<port>[0-9]{0,5}))?"
)
_ORIGIN = re.compile(r"(?P<scheme>[A-Za-z][A-Za-z0-9+.-]*)://(?P<authority>.+)")
_LABEL = re.compile(r"[a-z0-9_](?:[a-z0-9_-]*[a-z0-9_])?")


class Authority(NamedTuple):
    """A host, and the port if one is said."""

    host: str
    """In lower case and without a final dot; letters beyond ASCII as IDNA; an IPv6 address in its shortest form."""
    port: int | None

    def port_of(self, scheme: str) -> int | None:
        """The port that is meant in an address of that scheme."""
        return DEFAULT_PORTS.get(scheme) if self.port is None else self.port


class PageOrigin(NamedTuple):
    """Where a page comes from."""

    scheme: str
    authority: Authority


def host_name(text: str) -> str | None:
    """A host name or address as `Authority` keeps it, IPv6 with or without brackets; None if that is none."""
    try:
        return str(ipaddress.IPv6Address(text.removeprefix("[").removesuffix("]")))
    except ValueError:
        return _name(text)


def read_authority(text: str) -> Authority | None:
    """What a `Host` header says, `lab.example:8000`; None if that is no host."""
    found = _AUTHORITY.fullmatch(text)
    if found is None:
        return None
    host = host_name(f"[{found['address']}]") if found["address"] else _name(found["name"])
    port = int(found["port"]) if found["port"] else None
    return None if host is None or (port is not None and not 0 < port < 65536) else Authority(host, port)


def read_origin(text: str) -> PageOrigin | None:
    """What an `Origin` header says, `https://lab.example`; None if that is no origin, as `null` is none."""
    found = _ORIGIN.fullmatch(text)
    authority = read_authority(found["authority"]) if found else None
    return None if found is None or authority is None else PageOrigin(found["scheme"].lower(), authority)


def is_same(origin: PageOrigin, host: Authority, scheme: str) -> bool:
    """Whether a page of that origin asks the service that shows it.

    Args:
        origin: of the page.
        host: what the request is addressed to.
        scheme: of the request as the service knows it: where a proxy that says nothing of it takes the encryption
            off, it knows `http` only.

    """
    if origin.scheme not in DEFAULT_PORTS or (scheme in ("https", "wss") and origin.scheme != "https"):
        return False
    return origin.authority.host == host.host and origin.authority.port_of(origin.scheme) == host.port_of(origin.scheme)


def network_of(address: str) -> str:
    """Whose address that is: of IPv6 somebody has a whole network, and as many addresses as they like."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address):
        return address
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    return str(ipaddress.IPv6Network((found.packed[:8] + bytes(8), 64)))


def _name(text: str) -> str | None:
    """A name of labels, or an IPv4 address."""
    name = text.removesuffix(".")
    if not name.isascii():
        try:
            name = idna.encode(name, uts46=True).decode()
        except idna.IDNAError:
            return None
    name = name.lower()
    labels = name.split(".")
    fits = len(name) <= LONGEST_NAME and all(len(label) < 64 and _LABEL.fullmatch(label) for label in labels)
    return name if fits else None
