"""The data folder has one owner: the service that runs on it, which says who it is to any other that would start."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from server.errors import DataFolderInUse, StoredUnreadable
from server.files import read_document, replace_file
from server.instants import wall_clock
from sim.file_lock import ProcessLock, is_locked
from sim.snapshot import FrozenMessage

LOCK_NAME = "service.lock"
OWNER_NAME = "service.json"


class Owner(FrozenMessage):
    """The service that has a data folder."""

    pid: int
    host: str
    address: str
    since: str

    @property
    def words(self) -> str:
        """For people."""
        return f"the service at {self.address} (process {self.pid} on {self.host}, since {self.since})"


@contextmanager
def owned(folder: Path, address: str) -> Iterator[None]:
    """The folder is this service's, which answers at that address, until the block ends or the process dies.

    Raises:
        DataFolderInUse: it is another's; the message says whose.
        OSError: the folder cannot be made or written.

    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        lock = ProcessLock(folder / LOCK_NAME)
    except BlockingIOError:
        raise _in_use(folder) from None
    try:
        owner = Owner(pid=os.getpid(), host=socket.gethostname(), address=address, since=wall_clock())
        replace_file(folder / OWNER_NAME, owner.model_dump_json(indent=1).encode())
        yield
    finally:
        (folder / OWNER_NAME).unlink(missing_ok=True)
        lock.release()


def require_free(folder: Path) -> None:
    """See that no other service has the folder; nothing is written.

    Raises:
        DataFolderInUse: one has.

    """
    if is_locked(folder / LOCK_NAME):
        raise _in_use(folder)


def _in_use(folder: Path) -> DataFolderInUse:
    try:
        whose = read_document(folder / OWNER_NAME, Owner).words
    except (FileNotFoundError, StoredUnreadable):
        whose = f"a service that has not said which it is; `fuser {folder / LOCK_NAME}` finds its process"
    tip = "end that one, or give this one a folder of its own with --data-dir or BECALM_DATA_DIR"
    return DataFolderInUse(f"the data folder {folder} belongs to {whose}", tip=tip)
