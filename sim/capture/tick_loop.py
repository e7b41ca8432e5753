"""One control tick after another, compiled: observe, perceive, watch, decide, write. Generic in plant and method."""

from __future__ import annotations

from sim.capture.caging import tips_enclose
from sim.capture.events import Ticks
from sim.capture.monitor import watch
from sim.compiled import compiled
from sim.control.hand_motion import hand_twists
from sim.control.phases import Verdict
from sim.method.method import MethodHandle, decide
from sim.model.robot import Chain, RobotModel, chain
from sim.perception.perceived import Perceived, is_perfect, perceive
from sim.plant.plant import PlantHandle, advance_plant
from sim.record import Record


@compiled
def fly(
    handle: PlantHandle,
    method: MethodHandle,
    robot: RobotModel,
    shapes: Record,
    parameters: Record,
    memory: Record,
    monitor: Record,
    state: Record,
    known: Perceived,
    rows: Ticks,
) -> tuple[int, bool]:
    """Fly as many ticks as there are rows of `TICK`, which are filled; stops after the tick of a verdict.

    Returns:
        How many ticks were flown, and whether the plant's state is still finite.

    """
    for place in range(rows.shape[0]):
        over = control_tick(method, robot, shapes, parameters, memory, monitor, state, known, rows[place])
        if not advance_plant(handle, parameters, memory.commanded_joint_rate, state):
            return place + 1, False
        if over:
            return place + 1, True
    return rows.shape[0], True


@compiled
def know(
    belief: Record,
    parameters: Record,
    robot: RobotModel,
    shapes: Record,
    state: Record,
    links: Chain,
    closed: int,
) -> Chain:
    """All that the controller gets of a state, into one element of `PERCEIVED`; the chain as it is believed.

    `closed` is whether the tips truly enclose the target: perfect sensors know.
    """
    believed = perceive(belief, parameters, robot, state, links)
    if is_perfect(parameters.perception):
        belief.closed = closed
    else:
        belief.closed = tips_enclose(robot, shapes.target, believed.hand_pose, belief.target_pose)
    return believed


@compiled
def control_tick(
    method: MethodHandle,
    robot: RobotModel,
    shapes: Record,
    parameters: Record,
    memory: Record,
    monitor: Record,
    state: Record,
    known: Perceived,
    row: Record,
) -> bool:
    """Watch a state, command joint rates from what is known of it, write a row of `TICK`; whether a verdict fell."""
    before = monitor.verdict
    links = chain(robot, state.base_pose, state.joint_angle, state.mount_angle)
    watch(monitor, memory, parameters, robot, shapes, state, links)
    over = bool(monitor.verdict != before)
    verdict = monitor.verdict if over else Verdict.NONE
    belief = known[0]
    believed = know(belief, parameters, robot, shapes, state, links, monitor.closed)
    decide(method, memory, parameters, robot, belief, believed, verdict)
    write_tick(row, memory, monitor, state, links, belief)
    return over


@compiled
def follow(
    method: MethodHandle,
    robot: RobotModel,
    shapes: Record,
    parameters: Record,
    memory: Record,
    monitor: Record,
    state: Record,
    known: Perceived,
    recorded: Ticks,
    rows: Ticks,
) -> int:
    """Judge recorded states, rows of `TICK`, and command joint rates from them; `rows` are filled.

    Returns:
        How many ticks were followed; it stops after the tick of a verdict.

    """
    for place in range(recorded.shape[0]):
        recall(recorded[place], state)
        if control_tick(method, robot, shapes, parameters, memory, monitor, state, known, rows[place]):
            return place + 1
    return len(recorded)


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
def write_tick(row: Record, memory: Record, monitor: Record, state: Record, links: Chain, belief: Record) -> None:
    """One tick as it is recorded: the state it began with, what was known of it and what was commanded from that."""
    row.tick, row.time = state.tick, state.time
    row.phase, row.activity, row.plan = memory.phase, memory.activity, memory.plan_count
    row.closed, row.perceived_closed, row.rate_limited = monitor.closed, belief.closed, memory.rate_limited
    row.base_overlap, row.solid_contact = monitor.base_overlap, state.arm_contact > 0
    row.base_contact = state.base_contact
    row.base_pose[:], row.base_twist[:] = state.base_pose, state.base_twist
    row.target_pose[:], row.target_twist[:] = state.target_pose, state.target_twist
    row.joint_angle[:], row.joint_rate[:] = state.joint_angle, state.joint_rate
    row.commanded_joint_rate[:] = memory.commanded_joint_rate
    row.hand_pose[:] = links.hand_pose
    row.mount_angle[:], row.mount_rate[:] = state.mount_angle, state.mount_rate
    row.hand_twist[:] = hand_twists(state, links)
    row.desired_hand_pose[:], row.desired_hand_twist[:] = memory.desired_hand_pose, memory.desired_hand_twist
    row.hand_wrench[:], row.tip_force[:] = state.hand_wrench, state.tip_force
    for arm in range(2):
        for tip in range(2):
            row.tip_contact[arm, tip] = state.tip_contact[arm, tip] != 0
    row.base_perceived_pose[:], row.base_perceived_twist[:] = belief.base_pose, belief.base_twist
    row.target_perceived_pose[:], row.target_perceived_twist[:] = belief.target_pose, belief.target_twist
    row.perceived_hand_wrench[:] = belief.hand_wrench
    for arm in range(2):
        row.perceived_contact[arm] = belief.touching[arm] != 0
    row.manipulability[:] = monitor.manipulability
    row.momentum[:] = state.momentum
