"""Its numbers."""

from __future__ import annotations

from sim.parameters import MethodConfig, Number, parameter


class ReachAndHoldConfig(MethodConfig):
    """How far, and how long."""

    distance: Number = parameter(0.03, "Way of each hand, back along its axis", unit="m", source="chosen", gt=0, le=0.1)
    duration: Number = parameter(0.5, "Time of the way", unit="s", source="chosen", gt=0, le=10, live=True)
    stillness: Number = parameter(0.2, "Time of holding still", unit="s", source="chosen", gt=0, le=10, live=True)
