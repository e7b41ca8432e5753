"""`becalm serve --check`: what would be started, after looking at all that a start would fail on."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from becalm.serving import address
from becalm.sockets import bound_socket
from server.app import create_app
from server.pages.console import STATIC
from server.process.data_folder import require_free
from server.settings import Chosen, Settings
from server.versions import becalm_version
from sim.file_lock import supports_locks

DEFAULT = "default"


def checked(chosen: Chosen) -> dict[str, Any]:
    """Every setting with its source, and what follows from them; nothing is started or written.

    Raises:
        ConfigError: a start would refuse these settings.
        AddressInUse: the address is taken.
        DataFolderInUse: another service has the data folder.
        PermissionError: the data folder cannot be written.

    """
    settings = chosen.settings
    create_app(settings)
    with bound_socket(settings.host, settings.port) as bound:
        url = address(settings.host, bound.getsockname()[1] if settings.port else 0)
    there = _writable(settings.data_dir)
    require_free(settings.data_dir)
    return {
        "version": becalm_version(),
        "address": url,
        "console": (STATIC / "index.html").exists(),
        "tokens_required": settings.tokens_required,
        "locks": supports_locks(there),
        "settings": settings.model_dump(mode="json"),
        "sources": {name: chosen.sources.get(name, DEFAULT) for name in Settings.model_fields},
    }


def _writable(folder: Path) -> Path:
    """The folder, or the one that it would be made in, which can be written."""
    there = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    if not there.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(there))
    if not os.access(there, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(there))
    return there


def as_text(found: Mapping[str, Any]) -> str:
    """For people."""
    settings, sources = found["settings"], found["sources"]
    let_in = "who has a token" if found["tokens_required"] else "everyone who reaches it"
    locks = "locked by the system" if found["locks"] else "no locks on its file system: a file in it names the owner"
    studies = settings["scheduler"] or f"{settings['study_workers']} at a time on this machine"
    lines = [
        f"Becalm {found['version']} would start at {found['address']}",
        f"  flies     {settings['plant']}, opening with {settings['configuration']}",
        f"  studies   {studies}",
        f"  lets in   {let_in}",
        f"  data      {settings['data_dir']}, {locks}",
        f"  console   {'built' if found['console'] else 'not built: pip install . builds it'}",
        "",
    ]
    width = max(map(len, settings))
    lines += [f"  {name:<{width}}  {_shown(value):<34}  {sources[name]}" for name, value in settings.items()]
    return "\n".join(lines)


def _shown(value: Any) -> str:
    if value in (None, [], {}):
        return "-"
    return ", ".join(value) if isinstance(value, list) else str(value)
