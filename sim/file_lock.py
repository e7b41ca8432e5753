"""A file locked by a running process: the system releases the lock when the process ends, however it ends.

The locks are those of the `filelock` library. Where the file system has none (some network and FUSE mounts), a file
beside it, `NAME.pid`, names the process and its host instead; one whose process is gone from this host is ignored.
"""

from __future__ import annotations

import errno
import logging
import os
import tempfile
from pathlib import Path

from filelock import BaseFileLock, FileLock, SoftFileLock, Timeout, lock_descriptor

WITHOUT_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EPERM)
"""Errors of a file system that does not support locks."""

log = logging.getLogger(__name__)


class ProcessLock:
    """The lock on one file, held from its construction to `release`."""

    def __init__(self, path: Path) -> None:
        """Lock this file, which is created if it is missing; its folder must exist.

        Raises:
            BlockingIOError: another process holds it.
            OSError: the file cannot be created or opened.

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
        """Release the file; with `remove` delete it, if it was there for the lock only."""
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
    log.warning("the file system of %s has no locks (%s); %s says who holds it", path, error.strerror, marker.name)
    return lock


def is_locked(path: Path) -> bool:
    """Whether a running process holds this file, or may hold it: this user, or this disk, does not allow the test."""
    if not path.exists():
        return False
    try:
        ProcessLock(path).release()
    except OSError:
        return True
    return False


def supports_locks(folder: Path) -> bool:
    """Whether the file system of this folder supports locks: tried on a file without a name."""
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            lock_descriptor(file.fileno(), blocking=False)
        except OSError as error:
            if error.errno in WITHOUT_LOCKS:
                return False
            raise
    return True
