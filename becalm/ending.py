"""What asks a process of Becalm to end, and how it does before it listens to anyone: at once, in order, with 0."""

from __future__ import annotations

import signal
from typing import NoReturn

ENDING_SIGNALS = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
"""What ends the service as Ctrl-C does: somebody asks for it, its terminal is gone, or has been asked to end it."""


def end_when_asked() -> None:
    """From now on end with 0 when asked to, but by none that whoever started this has it ignore (`nohup`)."""
    for number in ENDING_SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)


def _end(_number: int, _frame: object) -> NoReturn:
    raise SystemExit(0)
