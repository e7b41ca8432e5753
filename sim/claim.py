"""A file claimed by a living process: the system frees the claim when the process dies, however it dies."""

from __future__ import annotations

import os
import sys
from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


class Claim:
    """Held from its making until `release`."""

    def __init__(self, path: Path) -> None:
        """Claim this file, which is made if it is not there; its folder is.

        Raises:
            BlockingIOError: another claim on it is alive.

        """
        self._path = path
        self._descriptor = _claimed(path)

    def release(self, *, remove: bool = False) -> None:
        """Give the file free, and remove it if it was only there to be claimed."""
        if remove:
            self._path.unlink(missing_ok=True)
        os.close(self._descriptor)


def _claimed(path: Path) -> int:
    """A locked descriptor of the file that stands under this name, not of one that was removed meanwhile."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            _lock(descriptor)
        except OSError:
            os.close(descriptor)
            raise BlockingIOError(f"{path} is claimed by another process") from None
        if _stands_under(path, descriptor):
            return descriptor
        os.close(descriptor)


def _stands_under(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def is_claimed(path: Path) -> bool:
    """Whether a living process claims this file."""
    if not path.exists():
        return False
    try:
        Claim(path).release()
    except BlockingIOError:
        return True
    return False
