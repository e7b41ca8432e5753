"""Sockets to listen on, bound before anything is started for them."""

from __future__ import annotations

import errno
import socket

from server.errors import AddressInUse


def bound_socket(host: str, port: int) -> socket.socket:
    """A socket bound to this address, before anything is started for it.

    Raises:
        AddressInUse: it is taken; the message names the address and what to do.

    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # The protocol must be named: asyncio turns Nagle's algorithm off (40 ms an answer) only where it is.
    bound = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((host, port))
        bound.listen()
    except OSError as error:
        bound.close()
        raise _unavailable(host, port, error) from None
    return bound


def _unavailable(host: str, port: int, error: OSError) -> AddressInUse:
    if error.errno == errno.EADDRINUSE:
        tip = f"end the program that listens there, or choose another port, such as --port {port + 1}"
        return AddressInUse(f"port {port} on {host} is in use", tip=tip)
    tip = "choose an address of this machine with --host, and a port above 1023 with --port"
    return AddressInUse(f"cannot listen on {host}, port {port}: {error.strerror or error}", tip=tip)
