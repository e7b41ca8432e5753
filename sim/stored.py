"""What files and folders hold, read under current names (`sim.schema_history`).

Only what is stored, or written into a file, is read so. A request over REST and `--set` use current names; for a
former one the error gives the current name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sim.configurations import nested, read_config_file
from sim.errors import ConfigError
from sim.schema_history import PARAMETER_CHANGES, VERSION, Change, Read, require_known_version, under_todays_names


def read_tree(stored: Mapping[str, Any], changes: Sequence[Change]) -> Read:
    """A nested mapping with every value under its current path; without changes it stays as it is.

    Raises:
        ConfigError: a value stands both under a former name and under the current one, or in the place of a group.

    """
    if not changes:
        return Read(dict(stored), ())
    read = under_todays_names(leaves(stored), changes)
    return Read(nested(read.values), read.notices)


def read_parameters(stored: Mapping[str, Any]) -> Read:
    """A nested configuration, or changes to one, of any version; `version` is checked and left out.

    Raises:
        ConfigError: it is of a later version, or a value stands in two places.

    """
    require_known_version(stored.get(VERSION, 1))
    return read_tree({name: value for name, value in stored.items() if name != VERSION}, PARAMETER_CHANGES)


def leaves(tree: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """A nested mapping by full path; an empty group counts as a value."""
    flat: dict[str, Any] = {}
    for name, value in tree.items():
        if isinstance(value, Mapping) and value:
            flat |= leaves(value, f"{prefix}{name}.")
        else:
            flat[f"{prefix}{name}"] = value
    return flat


def read_parameters_file(path: Path) -> Read:
    """The nested changes in a TOML or JSON file, written for any version; notices name the file.

    Raises:
        ConfigError: the file is missing, does not parse, or is of a later version.

    """
    return in_file(path, read_config_file(path))


def in_file(path: Path, changes: Mapping[str, Any], kind: str = "config file") -> Read:
    """Nested changes that stand in this file, under current names; notices and errors name the file.

    Raises:
        ConfigError: they are of a later version, or a value stands in two places.

    """
    try:
        read = read_parameters(changes)
    except ConfigError as error:
        raise ConfigError(f"{kind} {str(path)!r}: {error}", tip=error.tip) from None
    return Read(read.values, tuple(f"{kind} {str(path)!r}: {notice}" for notice in read.notices))
