"""Real-time scheduling: asked of the system, and refused in words."""

from __future__ import annotations

import os
import sys

import pytest

from server.process.realtime import PROCESS_PRIORITY, THREAD_PRIORITY, realtime_priority, schedule_realtime
from sim.errors import ConfigError
from sim.study import executors

linux = pytest.mark.skipif(sys.platform != "linux", reason="there is none on other systems")


@linux
def test_realtime_threads_run_before_the_rest_of_the_process(monkeypatch):
    asked = []
    monkeypatch.setattr(os, "sched_setscheduler", lambda _, policy, given: asked.append((policy, given.sched_priority)))
    schedule_realtime()
    assert asked[-1] == (os.SCHED_RR, PROCESS_PRIORITY)
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_RR)
    monkeypatch.setattr(os, "sched_getparam", lambda _: os.sched_param(PROCESS_PRIORITY))
    with realtime_priority():
        assert asked[-1] == (os.SCHED_RR, THREAD_PRIORITY)
    assert asked[-1] == (os.SCHED_RR, PROCESS_PRIORITY)


@linux
def test_without_real_time_nobody_is_before_others(monkeypatch):
    monkeypatch.setattr(os, "sched_setscheduler", lambda *_: pytest.fail("nothing is to be asked for"))
    with realtime_priority():
        pass


@linux
def test_who_may_not_have_it_is_told_how_to_get_it(monkeypatch):
    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    with pytest.raises(ConfigError, match="realtime") as refused:
        schedule_realtime()
    assert "rtprio" in refused.value.tip


@linux
def test_studies_do_not_take_the_missions_turn(monkeypatch):
    asked = []
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_RR)
    monkeypatch.setattr(os, "sched_setscheduler", lambda *given: asked.append(given))
    executors.leave_realtime()
    assert [policy for _, policy, _ in asked] == [os.SCHED_OTHER]
