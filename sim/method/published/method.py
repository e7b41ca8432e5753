"""The published method as a value: `METHOD`."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.config import MissionConfig
from sim.control.admittance import admittance_transition
from sim.control.phases import Command
from sim.method.method import Method, register_kernel
from sim.method.published import sequence
from sim.method.published.memory import PUBLISHED_MEMORY, Activity, PlanKind, PublishedHandle
from sim.method.published.refusal import refusal
from sim.method.published.words import WORDS


def _handle(config: MissionConfig, own: np.ndarray[Any, np.dtype[Any]]) -> PublishedHandle:
    return PublishedHandle(own, admittance_transition(config.published.impedance, config.control.period))


def _spin_threshold(config: MissionConfig) -> float:
    return float(config.published.caging.spin_threshold)


METHOD = Method(
    title="Detumbling by absorbed touches, then caging (Uchida, Uno, Yoshida 2024)",
    memory=PUBLISHED_MEMORY,
    activities=Activity,
    plan_kinds=PlanKind,
    closing=(Activity.CLOSING, Activity.WAITING),
    commands=frozenset(Command),
    handle=_handle,
    spin_threshold=_spin_threshold,
    refusal=refusal,
    enclosure=None,
    words=WORDS,
)

register_kernel(
    PublishedHandle,
    begin=sequence.begin,
    react=sequence.react,
    plan=sequence.plan,
    hand_twist=sequence.hand_twist,
)
