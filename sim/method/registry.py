"""The list of methods: the one line that each needs outside its folder.

A method named `x` lives in the folder `sim/method/x`: its parameters in `parameters.py`, and in `method.py` its
`METHOD` (`sim.method.method.Method`).
"""

from __future__ import annotations

from enum import StrEnum

from sim.method.co_moving_couple.parameters import CoMovingCoupleConfig
from sim.method.published.parameters import PublishedConfig
from sim.parameters import ConfigModel


class MethodGroups(ConfigModel):
    """The parameters of each method, by its name."""

    published: PublishedConfig = PublishedConfig()
    co_moving_couple: CoMovingCoupleConfig = CoMovingCoupleConfig()


MethodName = StrEnum("MethodName", list(MethodGroups.model_fields))  # type: ignore[misc]  # the fields name them
