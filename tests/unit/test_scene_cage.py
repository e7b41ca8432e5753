"""How the cage is drawn follows what the mission says of it, and nothing else."""

from types import SimpleNamespace
from typing import Any

import pytest

from server.scene.cage import cage_state


@pytest.mark.parametrize(
    ("phase", "closed", "margin", "drawn"),
    [
        ("idle", False, None, "none"),
        ("detumbling", False, None, "none"),
        ("caging", False, None, "open"),
        ("caging", True, None, "closed"),
        ("holding", True, None, "closed"),
        ("holding", False, None, "open"),
        ("holding", True, 0.004, "locked"),
        ("released", False, 0.004, "none"),
    ],
)
def test_the_cage_is_drawn_as_it_is(phase, closed, margin, drawn):
    snapshot: Any = SimpleNamespace(phase=phase, cage_closed=closed, cage_margin=margin)
    assert cage_state(snapshot) == drawn
