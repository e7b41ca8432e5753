"""Conditions that several methods speak of before a next step."""

from __future__ import annotations

from sim.snapshot import Condition

OPEN = "The hands are open; the arms hold."
"""What is happening once the hands have opened."""


def spin_condition(spin: float, bound: float, *, met: bool, what: str) -> Condition:
    """The target's spin [rad/s] against a bound [rad/s], in words of what the bound is."""
    words = f"spin {abs(spin):.2f} rad/s is {'not over' if met else 'over'} {what}"
    return Condition(name="spin", met=met, value=abs(spin), bound=bound, unit="rad/s", words=words)


def enclosed_condition(*, met: bool) -> Condition:
    """Whether the tips enclose the target, as it is perceived."""
    words = "the tips enclose the target" if met else "the tips do not enclose the target yet"
    return Condition.of("enclosed", words, met=met)


def open_hands_condition(*, met: bool) -> Condition:
    """Whether the opening has ended."""
    return Condition.of("hands_open", "the hands are open" if met else "the hands are still opening", met=met)
