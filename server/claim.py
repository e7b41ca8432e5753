"""A folder claimed by a living process: the system frees the claim when the process dies, however it dies."""

from __future__ import annotations

import os
import sys
from pathlib import Path

CLAIM_NAME = ".writing"

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

    def __init__(self, folder: Path) -> None:
        """Claim the folder.

        Raises:
            BlockingIOError: another claim on it is alive.

        """
        self._descriptor = os.open(folder / CLAIM_NAME, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            _lock(self._descriptor)
        except OSError:
            os.close(self._descriptor)
            raise BlockingIOError(f"{folder} is being written by another process") from None

    def release(self) -> None:
        """Give the folder free. The file stays: to remove it would let two claims hold two files of one name."""
        os.close(self._descriptor)


def is_claimed(folder: Path) -> bool:
    """Whether a living process writes this folder."""
    if not (folder / CLAIM_NAME).exists():
        return False
    try:
        Claim(folder).release()
    except BlockingIOError:
        return True
    return False
