"""A file claimed by a living process: the system frees the claim when the process dies, however it dies.

Claims are locks of the `filelock` library. Where the file system has none (some network and FUSE mounts), a file
beside it, `NAME.pid`, names the process and its host instead; one whose process is gone from this host counts no more.
"""

from __future__ import annotations

import errno
import logging
import os
import tempfile
from pathlib import Path

from filelock import BaseFileLock, FileLock, SoftFileLock, Timeout, lock_descriptor

WITHOUT_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EPERM)
"""What a file system answers that knows no locks."""

log = logging.getLogger(__name__)


class Claim:
    """Held from its making until `release`."""

    def __init__(self, path: Path) -> None:
        """Claim this file, which is made if it is not there; its folder is.

        Raises:
            BlockingIOError: another claim on it is alive.
            OSError: the file cannot be made or opened.

        """
        if not path.parent.is_dir():  # the library would make it
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        self._path = path
        try:
            self._lock = _acquired(FileLock(path, thread_local=False, fallback_to_soft=False), path)
        except OSError as error:
            if error.errno not in WITHOUT_LOCKS:
                raise
            self._lock = _without_locks(path, error)

    def release(self, *, remove: bool = False) -> None:
        """Give the file free, and remove it if it was only there to be claimed."""
        if remove:
            self._path.unlink(missing_ok=True)
        self._lock.release()


def _acquired(lock: BaseFileLock, path: Path) -> BaseFileLock:
    try:
        lock.acquire(blocking=False)
    except Timeout:
        raise BlockingIOError(errno.EAGAIN, "another process holds it", str(path)) from None
    return lock


def _without_locks(path: Path, error: OSError) -> BaseFileLock:
    marker = path.with_name(path.name + ".pid")
    lock = _acquired(SoftFileLock(marker, thread_local=False), marker)
    log.warning("the file system of %s has no locks (%s); %s tells who holds it", path, error.strerror, marker.name)
    return lock


def is_claimed(path: Path) -> bool:
    """Whether a living process claims this file, or one may: it cannot be tried by this user, or on this disk."""
    if not path.exists():
        return False
    try:
        Claim(path).release()
    except OSError:
        return True
    return False


def has_locks(folder: Path) -> bool:
    """Whether the file system of this folder knows locks: tried on a file that never has a name."""
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            lock_descriptor(file.fileno(), blocking=False)
        except OSError as error:
            if error.errno in WITHOUT_LOCKS:
                return False
            raise
    return True
