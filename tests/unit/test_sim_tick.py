"""One tick as a row of a table: columns, units, values."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.tick import COLUMNS, QUANTITIES, TICK, column_values

UNITS = {"1", "s", "m", "rad", "m/s", "rad/s", "N", "N m", "m2", "kg m2", "N s", "N m s"}


def test_every_number_of_a_tick_has_one_column():
    count = sum(int(np.prod(TICK[quantity.name].shape)) for quantity in QUANTITIES)
    assert len(COLUMNS) == count
    assert len({(column.quantity, column.place) for column in COLUMNS}) == count


def test_names_are_unique_and_units_si():
    assert len({column.name for column in COLUMNS}) == len(COLUMNS)
    assert {column.unit for column in COLUMNS} <= UNITS


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("mission.time", "s"),
        ("target.twist.angle", "rad/s"),
        ("left.hand_wrench.x", "N"),
        ("right.joint_angle.3", "rad"),
        ("right.manipulability", "m2"),
        ("base.pose.angle", "rad"),
    ],
)
def test_known_columns(name, unit):
    assert {column.name: column.unit for column in COLUMNS}[name] == unit


def test_values_are_those_of_the_field():
    ticks = np.zeros(3, TICK)
    ticks["tip_force"][:, 1, 0, 1] = [1.0, 2.0, 3.0]
    ticks["time"] = [0.0, 0.1, 0.2]
    values = {column.name: column_values(ticks, column) for column in COLUMNS}
    assert values["right.tip_force.tip_1.y"].tolist() == [1.0, 2.0, 3.0]
    assert values["mission.time"].tolist() == [0.0, 0.1, 0.2]
    assert not values["left.tip_force.tip_1.y"].any()


def test_every_column_reads_a_place_of_its_own():
    """Fill a tick with a different number in every place: the columns give each of them once."""
    tick = np.zeros(1, TICK)
    number = 0
    for name in TICK.names:
        flat = tick[name].reshape(-1)
        for place in range(flat.size):
            number += 1
            flat[place] = number % 250
        tick[name] = flat.reshape(tick[name].shape)
    seen = sorted(float(column_values(tick, column)[0]) for column in COLUMNS)
    assert seen == sorted(float(k % 250) for k in range(1, number + 1))


def test_no_gaps():
    """Equal ticks are equal bytes: nothing undefined lies between the fields."""
    assert TICK.itemsize == sum(int(TICK[name].itemsize) for name in TICK.names or ())
