"""The compiled heart of a fit: rollouts under recorded commands, what sensors read of them, and what is left of it.

A fit makes some ten thousand short rollouts, so all that is done with one is compiled, without the interpreter's lock:
threads share the work. Compiled functions of this package that call one another stand in this file, because numba
notices a change of a function's own file only.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.identification.recording import BoolArray
from sim.model.target import to_centre_of_mass, to_middle
from sim.plant.plant import PlantHandle, advance_plant
from sim.plant.reduced_plant import stand
from sim.record import Record

NODE = 14
"""Numbers that a rollout begins with: pose and twist of the base, of the target's middle, and the mounts' angles."""
MOUNTS = slice(12, 14)

CHANNELS = 18
"""Readings of a row: base pose, target pose, six joints, two wrenches."""
BASE, TARGET, JOINTS, WRENCHES = slice(0, 3), slice(3, 6), slice(6, 12), slice(12, 18)

COLUMNS = 29
"""Of a row that was flown: a node's first twelve numbers, joints, wrenches, hands' angles, mounts' angles, and how many
parts of the robot beside its tips touch the target."""
_JOINT, _WRENCH, _HAND, _MOUNT = 12, 18, 24, 26
SOLID = 28

_LOST = 1e3
"""Residual of a rollout that left all numbers, in standard deviations."""


class Reader(NamedTuple):
    """What sensors make of the state; compiled code reads it as a record."""

    gain: FloatArray
    """Of the wrists, shape (2,)."""
    bias: FloatArray
    """Of the wrists in their hands' axes [N, N, N m], shape (2, 3)."""
    lag: float
    """By how much poses are older than the other readings of their row [s]."""
    part: float
    """Of each new wrench in the smoothed one; 1 without smoothing."""
    period: float
    """Between rows [s]."""


class Stepped(NamedTuple):
    """A reduced plant, as compiled code steps it."""

    handle: PlantHandle
    """Changed."""
    parameters: Record
    """Record of the configuration."""


class Flight(NamedTuple):
    """What is flown, and by which sensors it is read."""

    free: Stepped
    """For rows in which nothing can touch: a step takes a whole period."""
    solid: Stepped
    """For all others."""
    touchable: BoolArray
    """Whether the robot may touch the target in the period from each row on, shape (rows,)."""
    reader: Record
    """Record of `Reader`."""
    start: Record
    """One element of `PLANT_STATE`: joints at the first row; base, target and mounts are the node's."""
    state: Record
    """Likewise, to work with."""
    rates: FloatArray
    """Joint rates [rad/s] from each row to the next, shape (rows, 2, 3); the last is not flown."""
    rows: FloatArray
    """Shape (rows, 29); written."""


class Seen(NamedTuple):
    """What the sensors have read."""

    measured: FloatArray
    """Shape (rows, 18)."""
    known: BoolArray
    """Where it is a reading, shape (rows, 18)."""
    untouched: BoolArray
    """Where a wrench says no more than that its force was under the threshold, shape (rows, 2)."""
    threshold: float
    """[N]"""


@compiled
def fly(flight: Flight, node: FloatArray) -> int:
    """Fly from a node, shape (14,), into `flight.rows`; how many rows are finite."""
    start, state, rows = flight.start, flight.state, flight.rows
    for axis in range(3):
        start.base_pose[axis], start.base_twist[axis] = node[axis], node[3 + axis]
        start.target_pose[axis], start.target_twist[axis] = node[6 + axis], node[9 + axis]
    to_centre_of_mass(flight.free.parameters.target, start.target_pose, start.target_twist)
    start.mount_angle[0], start.mount_angle[1] = node[12], node[13]
    touchable = flight.touchable[0]
    plant = flight.solid if touchable else flight.free
    stand(plant.handle, plant.parameters, start, state)
    for row in range(rows.shape[0]):
        _write_row(plant.parameters.target, state, rows[row])
        if row + 1 == rows.shape[0]:
            break
        if flight.touchable[row] != touchable:
            touchable = flight.touchable[row]
            plant = flight.solid if touchable else flight.free
            stand(plant.handle, plant.parameters, state, state)
        if not advance_plant(plant.handle, plant.parameters, flight.rates[row], state):
            return row + 1
    return int(rows.shape[0])


@compiled
def _write_row(target: Record, state: Record, into: FloatArray) -> None:
    """One element of `PLANT_STATE` as a row, shape (29,): the target's pose and twist are those of its middle."""
    into[SOLID] = state.base_contact + state.arm_contact
    for axis in range(3):
        into[axis], into[3 + axis] = state.base_pose[axis], state.base_twist[axis]
        into[6 + axis], into[9 + axis] = state.target_pose[axis], state.target_twist[axis]
        for arm in range(2):
            into[_JOINT + 3 * arm + axis] = state.joint_angle[arm, axis]
            into[_WRENCH + 3 * arm + axis] = state.hand_wrench[arm, axis]
    to_middle(target, into[6:9], into[9:12])
    for arm in range(2):
        angle = state.base_pose[2] + state.mount_angle[arm]
        for joint in range(3):
            angle += state.joint_angle[arm, joint]
        into[_HAND + arm], into[_MOUNT + arm] = angle, state.mount_angle[arm]


@compiled
def read(rows: FloatArray, reader: Record, readings: FloatArray) -> None:
    """What the sensors would have read of rows that were flown.

    Args:
        rows: shape (rows, 29).
        reader: record of `Reader`.
        readings: shape (rows, 18); written: poses as late as the recorded ones, wrenches in world axes.

    """
    count, late = rows.shape[0], reader.lag / reader.period
    for row in range(count):
        place = row - late
        before = min(max(math.floor(place), 0), max(0, count - 2))
        after, part = min(before + 1, count - 1), place - before
        for axis in range(3):
            for body in range(2):
                column = 6 * body + axis
                if place < 0.0:  # before the first row as its twist says
                    value = rows[0, column] + place * reader.period * rows[0, column + 3]
                else:
                    value = rows[before, column] + part * (rows[after, column] - rows[before, column])
                readings[row, 3 * body + axis] = value
        for joint in range(6):
            readings[row, 6 + joint] = rows[row, _JOINT + joint]
    for arm in range(2):
        _read_wrist(rows, reader, arm, readings)


@compiled
def _read_wrist(rows: FloatArray, reader: Record, arm: int, readings: FloatArray) -> None:
    """The wrenches of one arm: smoothed from the first row's value on, with gain and bias."""
    gain, bias, into = reader.gain[arm], reader.bias[arm], 12 + 3 * arm
    biased = bias[0] != 0.0 or bias[1] != 0.0
    for row in range(rows.shape[0]):
        for axis in range(3):
            value = rows[row, _WRENCH + 3 * arm + axis]
            if row > 0 and reader.part < 1.0:
                before = readings[row - 1, into + axis]
                value = before + reader.part * (value - before)
            readings[row, into + axis] = value
    for row in range(rows.shape[0]):
        for axis in range(3):
            readings[row, into + axis] *= gain
        if biased:
            c, s = math.cos(rows[row, _HAND + arm]), math.sin(rows[row, _HAND + arm])
            readings[row, into] += c * bias[0] - s * bias[1]
            readings[row, into + 1] += s * bias[0] + c * bias[1]
        readings[row, into + 2] += bias[2]


@compiled
def fly_residual(flight: Flight, seen: Seen, weights: FloatArray, node: FloatArray, left: FloatArray) -> float:
    """Fly from a node, and what is left of the readings: predicted less measured, in standard deviations.

    Zero where nothing was measured. The joints' mean is taken out: the offset of an encoder reading at the node is
    none of the motion.

    Args:
        flight: what is flown; changed.
        seen: what was measured.
        weights: standard deviations of the channels, shape (18,).
        node: shape (14,).
        left: shape (rows, 18); written.

    Returns:
        The sum of its squares.

    """
    if fly(flight, node) < flight.rows.shape[0]:
        left[:] = _LOST
    else:
        read(flight.rows, flight.reader, left)
        _compare(seen, weights, left)
    squares = 0.0
    for row in range(left.shape[0]):
        for channel in range(CHANNELS):
            squares += left[row, channel] * left[row, channel]
    return squares


@compiled
def fly_slopes(
    flight: Flight,
    seen: Seen,
    weights: FloatArray,
    node: FloatArray,
    residual: FloatArray,
    scales: FloatArray,
    slopes: FloatArray,
) -> None:
    """How what is left changes with the numbers of a node, by differences.

    Where nothing can touch, base and target know nothing of each other, and one rollout moves both.

    Args:
        flight: what is flown; changed.
        seen: what was measured.
        weights: standard deviations of the channels, shape (18,).
        node: shape (14,).
        residual: what is left of it, shape (rows, 18).
        scales: of each number the step for differences, and the spread of its prior, shape (2, 14).
        slopes: of residuals and prior, shape (rows 18 + 14, numbers); written.

    """
    left, moved = np.empty(residual.shape), np.empty(NODE)
    step, paired = scales[0], not flight.touchable.any()
    slopes[:] = 0.0
    numbers = slopes.shape[1]
    for number in range(numbers // 2 if paired else numbers):
        other = number + numbers // 2
        moved[:] = node
        moved[number] += step[number]
        if paired:
            moved[other] += step[other]
        fly_residual(flight, seen, weights, moved, left)
        for row in range(left.shape[0]):
            for channel in range(6 if paired else CHANNELS):
                moves = other if paired and channel >= 3 else number
                change = left[row, channel] - residual[row, channel]
                slopes[row * CHANNELS + channel, moves] = change / step[moves]
    for number in range(numbers):
        slopes[residual.size + number, number] = 1.0 / scales[1, number]


@compiled
def normal_equations(slopes: FloatArray, left: FloatArray, curvature: FloatArray, gradient: FloatArray) -> None:
    """The square of slopes, and slopes by what is left: small, but of long arrays.

    Compiled, because BLAS shares such among threads of its own, which here only get in each other's way.

    Args:
        slopes: shape (residuals, numbers).
        left: shape (residuals,).
        curvature: shape (numbers, numbers); added to.
        gradient: shape (numbers,); added to.

    """
    numbers = slopes.shape[1]
    for place in range(slopes.shape[0]):
        for i in range(numbers):
            value = slopes[place, i]
            if value == 0.0:
                continue
            gradient[i] += value * left[place]
            for j in range(numbers):
                curvature[i, j] += value * slopes[place, j]


@compiled
def add_product(rows: FloatArray, factors: FloatArray, into: FloatArray) -> None:
    """Rows, shape (residuals, numbers), by factors, shape (numbers, parameters), added to the first rows of `into`."""
    for place in range(into.shape[0]):
        for i in range(rows.shape[1]):
            value = rows[place, i]
            if value == 0.0:
                continue
            for j in range(into.shape[1]):
                into[place, j] += value * factors[i, j]


@compiled
def product(rows: FloatArray, columns: FloatArray, into: FloatArray) -> None:
    """Transposed rows, shape (residuals, numbers), by columns, shape (residuals, parameters), into (numbers, ...)."""
    into[:] = 0.0
    for place in range(columns.shape[0]):
        for i in range(rows.shape[1]):
            value = rows[place, i]
            if value == 0.0:
                continue
            for j in range(columns.shape[1]):
                into[i, j] += value * columns[place, j]


@compiled
def _compare(seen: Seen, weights: FloatArray, left: FloatArray) -> None:
    """Make residuals of readings, shape (rows, 18)."""
    total, count = np.zeros(6), np.zeros(6)
    for row in range(left.shape[0]):
        for channel in range(12):
            left[row, channel] -= seen.measured[row, channel]
        for arm in range(2):
            _compare_wrist(seen, row, arm, left[row])
        for channel in range(CHANNELS):
            if not seen.known[row, channel]:
                left[row, channel] = 0.0
            elif 6 <= channel < 12:
                total[channel - 6] += left[row, channel]
                count[channel - 6] += 1.0
    for row in range(left.shape[0]):
        for joint in range(6):
            if seen.known[row, 6 + joint]:
                left[row, 6 + joint] -= total[joint] / count[joint]
        for channel in range(CHANNELS):
            left[row, channel] /= weights[channel]
            if not math.isfinite(left[row, channel]):
                left[row, channel] = _LOST


@compiled
def _compare_wrist(seen: Seen, row: int, arm: int, left: FloatArray) -> None:
    """A wrench less the measured one; where no touch was felt, what of its force is beyond the threshold."""
    first = 12 + 3 * arm
    if not seen.untouched[row, arm]:
        for axis in range(3):
            left[first + axis] -= seen.measured[row, first + axis]
        return
    force = math.hypot(left[first], left[first + 1])
    excess = 1.0 - seen.threshold / force if force > seen.threshold else 0.0
    left[first] *= excess
    left[first + 1] *= excess
    left[first + 2] = 0.0
