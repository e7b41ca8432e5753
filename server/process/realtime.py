"""How soon a thread runs that is due: within its process, and before other processes.

Real-time scheduling, where a user may have it, has two levels. All threads of a process are before other processes:
those without deadlines hold locks, the interpreter's above all, that those with deadlines wait for. Threads with
deadlines are before the rest, whose work may take longer than a control period.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from sim.errors import ConfigError

PROCESS_PRIORITY, THREAD_PRIORITY = 1, 2
"""Priorities, the lowest there are: after what the system itself does in real time."""
SWITCH_INTERVAL = 5e-4
"""Longest time that another thread keeps Python from one that is due [s]; Python's own default is 5 ms."""
_TIP = "let this user have it (limits.conf or ulimits of a container: rtprio 2; systemd: LimitRTPRIO=2), or leave it"


def schedule_realtime() -> None:
    """Run before whatever is not real time; so do all threads that begin after this.

    Raises:
        ConfigError: this system has no such thing, or does not let this user have it.

    """
    if sys.platform != "linux":
        raise ConfigError(f"realtime = true: there is no real-time scheduling on {sys.platform}", tip="leave it")
    try:
        _schedule(THREAD_PRIORITY)  # it may have one and not the other
        _schedule(PROCESS_PRIORITY)
    except PermissionError:
        raise ConfigError("realtime = true: this user may not have real-time scheduling", tip=_TIP) from None


def shorten_switch_interval() -> None:
    """Let threads of this process have Python soon after they ask for it."""
    sys.setswitchinterval(SWITCH_INTERVAL)


@contextmanager
def realtime_priority() -> Iterator[None]:
    """In a real-time process, run this thread and those that it begins meanwhile before the others."""
    if sys.platform != "linux" or os.sched_getscheduler(0) != os.SCHED_RR:
        yield
        return
    before = os.sched_getparam(0).sched_priority
    _schedule(THREAD_PRIORITY)
    try:
        yield
    finally:
        _schedule(before)


def _schedule(priority: int) -> None:
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(priority))
