"""The live run that the end of the service before this one cut off: whoever opens a page now is shown it."""

from __future__ import annotations

import logging

import numpy as np
from pydantic import Field

from server.errors import StoredUnreadable
from server.library.reader import RunReader
from server.library.runs import RECOVERED_NOTE, RunStore
from server.mission.live_mission import RESTING_PHASES
from server.mission.live_run import CUT_OFF_NOTE
from sim.control.phases import Phase
from sim.snapshot import FrozenMessage

LAST_MOMENTS = 1.0
"""Of a run, in which the phase that was cut off is looked for [s]: an orderly end stops the robot first."""

log = logging.getLogger(__name__)


class CutOffRun(FrozenMessage):
    """A run that was under way when the service ended."""

    run_id: str
    phase: str = Field(description="In which the end of the service met it")
    time: float = Field(description="Mission time of its last recorded tick [s]")


def cut_off_run(store: RunStore) -> CutOffRun | None:
    """The newest live run that has ended, if the end of a service cut it off; None if it ended by itself."""
    reader = next(filter(_is_ended_live_run, store.newest()), None)
    if reader is None or not _was_cut_off(reader):
        return None
    try:
        phase = _last_phase(reader)
    except (OSError, StoredUnreadable, ValueError) as error:  # its log is damaged: the library reports it
        log.warning("run %s was cut off, and does not say in which phase: %s", reader.record.id, error)
        return None
    if phase is None:
        return None
    return CutOffRun(run_id=reader.record.id, phase=phase.label, time=reader.record.duration)


def _is_ended_live_run(reader: RunReader) -> bool:
    return reader.record.kind in ("live", "fork") and reader.record.integrity is not None


def _was_cut_off(reader: RunReader) -> bool:
    return reader.record.outcome is None and reader.record.note in (CUT_OFF_NOTE, RECOVERED_NOTE)


def _last_phase(reader: RunReader) -> Phase | None:
    """The phase in which the mission was under way in its last moments; None if it rested: nothing was cut off."""
    moments = [ticks["phase"] for ticks in reader.chunks(since=reader.record.duration - LAST_MOMENTS)]
    phases = np.concatenate(moments) if moments else np.zeros(0, np.uint8)
    under_way = phases[~np.isin(phases, RESTING_PHASES)]
    return Phase(int(under_way[-1])) if len(under_way) else None
