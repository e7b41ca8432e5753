"""One control tick after another, compiled: observe, perceive, watch, decide, write. Generic in plant and method."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.capture.caging import tips_enclose
from sim.capture.events import Ticks, has_event
from sim.capture.monitor import MONITOR, note_decision, watch
from sim.compiled import compiled, compiled_inline
from sim.config import MissionConfig, RobotConfig
from sim.control.hand_motion import HAND_MOTION, hand_twist
from sim.control.memory import MEMORY
from sim.control.phases import Verdict
from sim.method.method import MethodHandle, decide
from sim.model.clearance import shapes_of
from sim.model.reduced_model import CHAIN, SHAPE, set_chain, shape_of_state
from sim.model.robot import RobotModel, robot_model
from sim.perception.perceived import PERCEIVED, perceive
from sim.plant.plant import PlantHandle, advance_plant, robot_shape
from sim.record import Record, copy_rows, copy_vector, dtype_of, packed

FLIGHT = np.dtype(
    [
        ("robot", packed(robot_model(RobotConfig())).dtype),
        ("shapes", shapes_of(MissionConfig()).dtype),
        ("parameters", dtype_of(MissionConfig)),
        ("memory", MEMORY),
        ("monitor", MONITOR),
        ("known", PERCEIVED),
        ("perceived_elsewhere", np.int64),  # whether a robot's link or a recording says what is known: it is there
        ("shape", SHAPE),  # to work with: of the robot, where no plant has it
        ("links", CHAIN),  # likewise: where they truly are
        ("motion", HAND_MOTION),  # likewise: what the controller computes
    ],
    align=True,
)
"""All of a mission but plant and method that a tick reads or changes: one array is handed to compiled code."""

Flight = np.ndarray[Any, np.dtype[Any]]
"""An array of one `FLIGHT`."""


@compiled
def fly(handle: PlantHandle, method: MethodHandle, flight: Flight, state: Record, rows: Ticks) -> tuple[int, bool]:
    """Fly as many ticks as there are rows of `TICK`, which are filled; stops after the tick of a verdict.

    Returns:
        How many ticks were flown, and whether the plant's state is still finite.

    """
    own = flight[0]
    for place in range(rows.shape[0]):
        shape = robot_shape(handle, own.robot, state, own.shape)
        over = _tick(method, own, state, shape, rows[place])
        if not advance_plant(handle, own.parameters, own.memory.commanded_joint_rate, state):
            return place + 1, False
        if over:
            return place + 1, True
    return rows.shape[0], True


@compiled
def fly_unrecorded(
    handle: PlantHandle,
    method: MethodHandle,
    flight: Flight,
    state: Record,
    ticks: int,
    spin_threshold: float,
    every: int,
    rows: Ticks,
) -> tuple[int, int, bool, bool]:
    """Fly as `fly`, but keep no rows except the first, the last, those with an event, and the one before each of these.

    Args:
        handle: of the plant.
        method: of the method.
        flight: all that a tick reads or changes.
        state: of the plant.
        ticks: how many to fly at most.
        spin_threshold: of the target's spin, whose crossing is an event [rad/s]; not a number for none.
        every: rows of ticks that are a multiple of this are kept, too; 0 for none.
        rows: of `TICK`, for those that are kept; the last two to work with. Where they are full, it stops.

    Returns:
        How many ticks were flown, how many rows are kept, whether the plant's state is still finite, and whether
        the last tick was that of a verdict.

    """
    own, recent = flight[0], rows[rows.shape[0] - 2 :]
    flown, kept, last_kept, finite, over = 0, 0, 0, True, False
    while flown < ticks and finite and not over and kept + 5 <= rows.shape[0]:
        before, row = recent[(flown + 1) % 2], recent[flown % 2]
        over = _tick(method, own, state, robot_shape(handle, own.robot, state, own.shape), row)
        finite = advance_plant(handle, own.parameters, own.memory.commanded_joint_rate, state)
        flown += 1
        if flown == 1 or has_event(before, row, spin_threshold):
            if last_kept < flown - 1:
                rows[kept] = before
                kept += 1
            rows[kept] = row
            kept += 1
            last_kept = flown
        elif every > 0 and row.tick % every == 0:
            rows[kept] = row
            kept += 1
            last_kept = flown
    if last_kept < flown:
        rows[kept] = recent[(flown + 1) % 2]
        kept += 1
    return flown, kept, finite, over


@compiled
def control_tick(method: MethodHandle, flight: Flight, state: Record, row: Record) -> bool:
    """Watch a state, command joint rates from what is known of it, write a row of `TICK`; whether a verdict fell."""
    own = flight[0]
    return _tick(method, own, state, shape_of_state(own.robot, state, own.shape), row)


@compiled
def _tick(method: MethodHandle, flight: Record, state: Record, shape: Record, row: Record) -> bool:
    """`control_tick` with the robot's shape at that state."""
    memory, monitor, belief, links = flight.memory, flight.monitor, flight.known, flight.links
    before = monitor.verdict
    set_chain(state.base_pose, shape, links)
    watch(monitor, memory, flight.parameters, flight.robot, flight.shapes, state, links)
    over = bool(monitor.verdict != before)
    verdict = monitor.verdict if over else Verdict.NONE
    if _learn(flight, state):
        believed_shape, believed_links = shape, links
    else:
        believed_shape, believed_links = belief.shape, belief.links
    decide(
        method, memory, flight.parameters, flight.robot, belief, believed_shape, believed_links, flight.motion, verdict
    )
    note_decision(monitor, memory, state)
    write_tick(row, memory, monitor, state, links, belief)
    return over


@compiled_inline
def _learn(flight: Record, state: Record) -> bool:
    """`know`, or, where somebody else has perceived, what follows from that."""
    belief = flight.known
    if flight.perceived_elsewhere != 0:
        set_chain(belief.base_pose, shape_of_state(flight.robot, belief, belief.shape), belief.links)
        belief.closed = tips_enclose(
            flight.robot, flight.shapes.seen_target, belief.links.hand_pose, belief.target_pose
        )
        return False
    return know(belief, flight.parameters, flight.robot, flight.shapes, state, flight.monitor.closed)


@compiled_inline
def know(belief: Record, parameters: Record, robot: RobotModel, shapes: Record, state: Record, closed: int) -> bool:
    """All that the controller gets of a state, into one element of `PERCEIVED`; whether it is the truth.

    `closed` is whether the tips truly enclose the target: perfect sensors know.
    """
    if perceive(belief, parameters, robot, shapes.seen_target, state):
        belief.closed = closed
        return True
    belief.closed = tips_enclose(robot, shapes.seen_target, belief.links.hand_pose, belief.target_pose)
    return False


@compiled
def follow(method: MethodHandle, flight: Flight, state: Record, recorded: Ticks, rows: Ticks) -> int:
    """Judge recorded states, rows of `TICK`, and command joint rates from them; `rows` are filled.

    Returns:
        How many ticks were followed; it stops after the tick of a verdict.

    """
    for place in range(recorded.shape[0]):
        recall(recorded[place], state)
        if flight[0].perceived_elsewhere != 0:
            recall_perceived(recorded[place], flight[0].known)
        if control_tick(method, flight, state, rows[place]):
            return place + 1
    return len(recorded)


@compiled
def look(flight: Flight, state: Record, row: Record) -> None:
    """Write a state, before anything is commanded, as a row of `TICK`; what is perceived of it is not remembered."""
    own = flight[0]
    set_chain(state.base_pose, shape_of_state(own.robot, state, own.shape), own.links)
    watch(own.monitor, own.memory, own.parameters, own.robot, own.shapes, state, own.links)
    _learn(own, state)
    write_tick(row, own.memory, own.monitor, state, own.links, own.known)


@compiled
def recall(row: Record, state: Record) -> None:
    """The plant's state, one element of `PLANT_STATE`, from the tick that it was recorded in."""
    state.tick, state.time = row.tick, row.time
    state.base_pose[:], state.base_twist[:] = row.base_pose, row.base_twist
    state.target_pose[:], state.target_twist[:] = row.target_pose, row.target_twist
    state.joint_angle[:], state.joint_rate[:] = row.joint_angle, row.joint_rate
    state.mount_angle[:], state.mount_rate[:] = row.mount_angle, row.mount_rate
    state.hand_wrench[:], state.tip_force[:] = row.hand_wrench, row.tip_force
    for arm in range(2):
        for tip in range(2):
            state.tip_contact[arm, tip] = row.tip_contact[arm, tip]
    state.base_contact, state.arm_contact = row.base_contact, row.solid_contact
    state.momentum[:] = row.momentum


@compiled
def recall_perceived(row: Record, known: Record) -> None:
    """What a robot's link perceived, one element of `PERCEIVED`, from the tick that it was recorded in.

    But for what nobody records: the filters' own memory, and when the target was last seen, which is taken to be then.
    """
    known.tick, known.time, known.target_seen_at = row.tick, row.time, row.time
    known.base_pose[:], known.base_twist[:] = row.base_perceived_pose, row.base_perceived_twist
    known.target_pose[:], known.target_twist[:] = row.target_perceived_pose, row.target_perceived_twist
    known.joint_angle[:], known.joint_rate[:] = row.joint_angle, row.joint_rate
    known.mount_angle[:], known.mount_rate[:] = row.mount_angle, row.mount_rate
    known.hand_wrench[:] = row.perceived_hand_wrench
    known.target_twist_deviation[:] = row.target_perceived_twist_deviation
    known.target_inertia = row.target_perceived_inertia
    known.target_inertia_deviation = row.target_perceived_inertia_deviation
    for arm in range(2):
        known.touching[arm] = row.perceived_contact[arm]
        for tip in range(2):
            known.tip_contact[arm, tip] = row.tip_contact[arm, tip]


@compiled_inline
def write_tick(row: Record, memory: Record, monitor: Record, state: Record, links: Record, belief: Record) -> None:
    """One tick as it is recorded: the state it began with, what was known of it and what was commanded from that."""
    row.tick, row.time = state.tick, state.time
    row.phase, row.activity, row.plan = memory.phase, memory.activity, memory.plan_count
    row.closed, row.perceived_closed, row.rate_limited = monitor.closed, belief.closed, memory.rate_limited
    row.base_overlap, row.solid_contact = monitor.base_overlap, state.arm_contact > 0
    row.base_contact, row.trouble = state.base_contact, memory.trouble
    copy_vector(row.base_pose, state.base_pose)
    copy_vector(row.base_twist, state.base_twist)
    copy_vector(row.target_pose, state.target_pose)
    copy_vector(row.target_twist, state.target_twist)
    copy_vector(row.mount_angle, state.mount_angle)
    copy_vector(row.mount_rate, state.mount_rate)
    copy_vector(row.momentum, state.momentum)
    copy_vector(row.manipulability, monitor.manipulability)
    copy_rows(row.joint_angle, state.joint_angle)
    copy_rows(row.joint_rate, state.joint_rate)
    copy_rows(row.hand_wrench, state.hand_wrench)
    copy_rows(row.commanded_joint_rate, memory.commanded_joint_rate)
    copy_rows(row.desired_hand_pose, memory.desired_hand_pose)
    copy_rows(row.desired_hand_twist, memory.desired_hand_twist)
    copy_rows(row.hand_pose, links.hand_pose)
    copy_vector(row.base_perceived_pose, belief.base_pose)
    copy_vector(row.base_perceived_twist, belief.base_twist)
    copy_vector(row.target_perceived_pose, belief.target_pose)
    copy_vector(row.target_perceived_twist_deviation, belief.target_twist_deviation)
    row.target_perceived_inertia = belief.target_inertia
    row.target_perceived_inertia_deviation = belief.target_inertia_deviation
    copy_vector(row.wanted_force, memory.wanted_force)
    copy_vector(row.target_perceived_twist, belief.target_twist)
    copy_rows(row.perceived_hand_wrench, belief.hand_wrench)
    for arm in range(2):
        row.hand_twist[arm, 0], row.hand_twist[arm, 1], row.hand_twist[arm, 2] = hand_twist(state, links, arm)
        row.perceived_contact[arm] = belief.touching[arm] != 0
        row.contact_expected[arm] = memory.expects_contact[arm]
        for tip in range(2):
            row.tip_contact[arm, tip] = state.tip_contact[arm, tip] != 0
            copy_vector(row.tip_force[arm, tip], state.tip_force[arm, tip])
