"""The simulated plant: robot and target as ten pymunk bodies, tip contact by our own law.

Joints are a `PivotJoint` and a `SimpleMotor` each, added from the base outwards. Tips are not shapes: the
spring-damper law of `sim.plant.contact` is all that acts between them and the target. Base, links and the
U of each hand are solid against the target. The servo is a first-order rate loop that does not reject
contact forces; the motor constraint then gives the rate it asks for, within the torque limit.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pymunk

from sim.compiled import FloatArray, IntArray, compiled
from sim.config import HandMount, MissionConfig
from sim.errors import PlantDiverged
from sim.model.clearance import hand_outline, initial_base_pose, initial_target_pose
from sim.model.generalized_jacobian import free_flying_model, joint_acceleration_under_contact
from sim.model.planar import cross
from sim.model.robot import (
    JOINTS,
    LINKS,
    RobotModel,
    base_shape,
    chain,
    freedom,
    inertia_matrix,
    initial_joint_angles,
    robot_model,
    tip_position,
)
from sim.model.shape import Shape
from sim.model.target import target_shape
from sim.plant.chipmunk import (
    ANGLE,
    ANGULAR_VELOCITY,
    POSITION,
    SET_FORCE,
    SET_RATE,
    SET_TORQUE,
    STEP,
    VELOCITY,
    address,
    call_scalar,
    call_vector,
    function_addresses,
    get_scalar,
    get_vector,
)
from sim.plant.contact import tip_contact
from sim.plant.plant import PLANT_STATE, advance_plant, air_table, diverged_at, register_kernel
from sim.record import Record, code_of, packed, record_of

BODIES = 10
TARGET = 9
"""Place of the target among the bodies: base, left links 1-3 and hand, right links 1-3 and hand, target."""

_ROBOT_GROUP = 1
_TARGET_TYPE, _BASE_TYPE, _ARM_TYPE = 1, 2, 3


_RIGID = code_of(HandMount.RIGID)
_STILL = 1e-9
"""Momentum of a plant at rest, for judging jumps [N s]: far above rounding."""


@compiled
def body_of(arm: int, link: int) -> int:
    """Place among the bodies of an arm's link (0-2) or hand (3)."""
    return 1 + LINKS * arm + link


class PymunkHandle(NamedTuple):
    """What compiled code needs to step the space: addresses and constants, nothing that it may change but `solid`."""

    functions: IntArray
    space: int
    bodies: IntArray
    motors: IntArray
    solid: IntArray
    """Solid contacts of the target now: with the base, with an arm; shape (2,), kept by pymunk's callbacks."""
    robot: RobotModel
    target_shape: np.ndarray[Any, np.dtype[Any]]
    """A `Shape`, packed, shape (1,)."""
    masses: FloatArray
    inertias: FloatArray
    pose: FloatArray
    """Of all bodies as last observed, shape (10, 3); only stepping the space changes it."""
    twist: FloatArray
    """Likewise."""
    predicted: FloatArray
    """Poses at the end of the step under way, shape (10, 3)."""
    force: FloatArray
    """Forces and torques of this step's contacts on the bodies, shape (10, 3)."""


class PymunkPlant:
    """The simulated robot and target. Owned by one thread: pymunk's objects are not safe for two."""

    perceived = None
    copyable = None

    def __init__(self, config: MissionConfig) -> None:
        """Robot and target as configured."""
        self.parameters: Record = record_of(config)
        self.state: Record = np.zeros(1, PLANT_STATE)[0]
        robot = robot_model(config.robot)
        self._space = _space(config)
        self._bodies = _bodies(config, robot)
        self._motors = _joints(config, robot, self._bodies)
        solid = np.zeros(2, np.int64)
        self._space.add(*self._bodies, *_shapes(config, robot, self._bodies))
        for joint in self._motors:
            self._space.add(*joint)
        self._watch_solid_contacts(solid)
        self.handle = PymunkHandle(
            functions=function_addresses(),
            space=address(self._space._space),
            bodies=np.array([address(body._body) for body in self._bodies]),
            motors=np.array([address(motor._constraint) for _, motor in self._motors]),
            solid=solid,
            robot=robot,
            target_shape=packed(target_shape(config.target)),
            masses=np.array([body.mass for body in self._bodies]),
            inertias=np.array([body.moment for body in self._bodies]),
            pose=np.zeros((BODIES, 3)),
            twist=np.zeros((BODIES, 3)),
            predicted=np.zeros((BODIES, 3)),
            force=np.zeros((BODIES, 3)),
        )
        observe(self.handle, self.state)

    @property
    def next_tick(self) -> int:
        """The tick whose joint rates are commanded next."""
        return int(self.state["tick"])

    def observe(self) -> None:
        """Nothing to wait for: the state is that at the end of the last control period."""

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """Step through one control period under joint rates [rad/s], shape (2, 3).

        Raises:
            PlantDiverged: the state is not finite, or total momentum jumped.

        """
        if not advance_plant(self.handle, self.parameters, joint_rate, self.state):
            raise PlantDiverged(diverged_at(float(self.state["time"])))

    def _watch_solid_contacts(self, solid: IntArray) -> None:
        for place, kind in enumerate((_BASE_TYPE, _ARM_TYPE)):

            def begin(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any, place: int = place) -> None:
                solid[place] += 1

            def separate(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any, place: int = place) -> None:
                solid[place] -= 1

            self._space.on_collision(_TARGET_TYPE, kind, begin=begin, separate=separate)


def _space(config: MissionConfig) -> pymunk.Space:
    simulation, table = config.simulation, air_table(config.table)
    space = pymunk.Space()
    space.iterations = simulation.solver_iterations
    space.collision_slop = simulation.collision_slop
    space.damping = math.exp(-table.drag)  # pymunk's is the part of a velocity that is left after a second
    space.gravity = table.slope_x, table.slope_y
    return space


def _bodies(config: MissionConfig, robot: RobotModel) -> list[pymunk.Body]:
    base_pose = initial_base_pose(config)
    links = chain(robot, base_pose, initial_joint_angles(config.robot.arm), np.zeros(2))
    bodies = [_body(robot.base_mass, robot.base_inertia, base_pose)]
    for arm in range(2):
        for link in range(LINKS):
            pose = np.array([*links.centre[arm, link], links.angle[arm, link]])
            bodies.append(_body(robot.link_mass[link], robot.link_inertia[link], pose))
    target = _body(config.target.mass, config.target.inertia, initial_target_pose(config))
    target.velocity = config.target.initial_velocity_x, config.target.initial_velocity_y
    target.angular_velocity = config.target.initial_spin
    return [*bodies, target]


def _body(mass: float, inertia: float, pose: FloatArray) -> pymunk.Body:
    body = pymunk.Body(float(mass), float(inertia))
    body.position = float(pose[0]), float(pose[1])
    body.angle = float(pose[2])
    return body


def _joints(
    config: MissionConfig, robot: RobotModel, bodies: list[pymunk.Body]
) -> list[tuple[pymunk.PivotJoint, pymunk.SimpleMotor]]:
    """Pivot and motor of each joint, from the base outwards: their order is part of the result."""
    simulation = config.simulation
    # Chipmunk's bias is the part of an error that is left after a second.
    error_bias = math.exp(-1.0 / simulation.joint_error_time) if simulation.joint_error_time else 0.0
    joints = []
    for arm in range(2):
        for link in range(LINKS):
            place = body_of(arm, link)
            child = bodies[place]
            if link == 0:
                shoulder_x, shoulder_y = robot.shoulder_in_base[arm].tolist()
                parent, anchor = bodies[0], (shoulder_x, shoulder_y)
            else:
                parent = bodies[place - 1]
                anchor = (0.0, float(robot.link_length[link - 1] - robot.link_centre[link - 1]))
            pivot = pymunk.PivotJoint(parent, child, anchor, (0.0, float(-robot.link_centre[link])))
            motor = pymunk.SimpleMotor(parent, child, 0.0)
            motor.max_force = config.robot.servo.torque_limit
            for constraint in (pivot, motor):
                constraint.error_bias = error_bias
                constraint.collide_bodies = False
            joints.append((pivot, motor))
    return joints


def _shapes(config: MissionConfig, robot: RobotModel, bodies: list[pymunk.Body]) -> list[pymunk.Shape]:
    """Solid shapes: the target, and what of the robot it may strike besides the tips."""
    arm = config.robot.arm
    shapes = [_solid(_outline(bodies[0], base_shape(config.robot.base)), _BASE_TYPE)]
    for side in range(2):
        for link in range(JOINTS):
            start = (arm.shoulder_clearance if link == 0 else 0.0) - float(robot.link_centre[link])
            end = float(robot.link_length[link] - robot.link_centre[link])
            link_shape = pymunk.Segment(bodies[body_of(side, link)], (0.0, start), (0.0, end), arm.link_radius)
            shapes.append(_solid(link_shape, _ARM_TYPE))
        shapes += _hand_shapes(config, robot, bodies[body_of(side, JOINTS)])
    target = _outline(bodies[TARGET], target_shape(config.target))
    target.collision_type = _TARGET_TYPE
    shapes.append(target)
    for shape in shapes:
        shape.friction = config.contact.friction
    return shapes


def _hand_shapes(config: MissionConfig, robot: RobotModel, body: pymunk.Body) -> list[pymunk.Shape]:
    arm = config.robot.arm
    to_hand = float(robot.link_length[JOINTS] - robot.link_centre[JOINTS])
    outline = [(float(x), float(y) + to_hand) for x, y in hand_outline(arm)]
    radius = arm.hand.finger_radius
    return [_solid(pymunk.Segment(body, start, end, radius), _ARM_TYPE) for start, end in pairwise(outline)]


def _outline(body: pymunk.Body, shape: Shape) -> pymunk.Shape:
    if shape.sides == 0:
        x, y = shape.vertices[0]
        return pymunk.Circle(body, shape.rounding, (float(x), float(y)))
    return pymunk.Poly(body, [(float(x), float(y)) for x, y in shape.vertices[: shape.corners]], radius=shape.rounding)


def _solid(shape: pymunk.Shape, kind: int) -> pymunk.Shape:
    shape.collision_type = kind
    shape.filter = pymunk.ShapeFilter(group=_ROBOT_GROUP)
    return shape


@compiled
def observe(handle: PymunkHandle, state: Record) -> None:
    """Read the bodies into the plant's state: poses, twists, joints, momentum. Wrenches are left as they are."""
    _read_bodies(handle)
    pose, twist = handle.pose, handle.twist
    state.base_pose[:], state.base_twist[:] = pose[0], twist[0]
    state.target_pose[:], state.target_twist[:] = pose[TARGET], twist[TARGET]
    for arm in range(2):
        for link in range(JOINTS):
            child = body_of(arm, link)
            parent = 0 if link == 0 else child - 1
            state.joint_angle[arm, link] = pose[child, 2] - pose[parent, 2]
            state.joint_rate[arm, link] = twist[child, 2] - twist[parent, 2]
        hand = body_of(arm, JOINTS)
        state.mount_angle[arm] = pose[hand, 2] - pose[hand - 1, 2]
        state.mount_rate[arm] = twist[hand, 2] - twist[hand - 1, 2]
    state.momentum[:] = 0.0
    for body in range(BODIES):
        px, py = handle.masses[body] * twist[body, 0], handle.masses[body] * twist[body, 1]
        state.momentum[0] += px
        state.momentum[1] += py
        state.momentum[2] += handle.inertias[body] * twist[body, 2] + cross(pose[body, 0], pose[body, 1], px, py)
    state.base_contact, state.arm_contact = handle.solid[0], handle.solid[1]


@compiled
def _momentum_of_all_bodies(handle: PymunkHandle) -> float:
    """The sum of the sizes of all bodies' momenta, by which a jump is judged [N s, with N m s at 1 m]."""
    total = _STILL
    for body in range(BODIES):
        speed = math.hypot(handle.twist[body, 0], handle.twist[body, 1])
        total += handle.masses[body] * speed + handle.inertias[body] * abs(handle.twist[body, 2])
    return total


@compiled
def _step(handle: PymunkHandle, parameters: Record, joint_rate: FloatArray, state: Record) -> None:
    dt = parameters.simulation.time_step
    for body in range(BODIES):
        for axis in range(3):
            handle.predicted[body, axis] = handle.pose[body, axis] + dt * handle.twist[body, axis]
    touching = _tip_forces(handle, parameters, state)
    if touching:
        for body in range(BODIES):
            fx, fy, torque = handle.force[body, 0], handle.force[body, 1], handle.force[body, 2]
            call_vector(handle.functions[SET_FORCE], handle.bodies[body], fx, fy)
            call_scalar(handle.functions[SET_TORQUE], handle.bodies[body], torque)
    _drive_servos(handle, parameters, joint_rate, state, touching)
    call_scalar(handle.functions[STEP], handle.space, dt)
    observe(handle, state)


@compiled
def _read_bodies(handle: PymunkHandle) -> None:
    """Observe poses and twists of all bodies."""
    pose, twist = handle.pose, handle.twist
    for body in range(BODIES):
        pointer = handle.bodies[body]
        pose[body, 0], pose[body, 1] = get_vector(handle.functions[POSITION], pointer)
        pose[body, 2] = get_scalar(handle.functions[ANGLE], pointer)
        twist[body, 0], twist[body, 1] = get_vector(handle.functions[VELOCITY], pointer)
        twist[body, 2] = get_scalar(handle.functions[ANGULAR_VELOCITY], pointer)


@compiled
def _tip_forces(handle: PymunkHandle, parameters: Record, state: Record) -> bool:
    """Contact of all four tips at the predicted poses, into the state and as forces on the bodies; whether any is."""
    pose, twist, force = handle.predicted, handle.twist, handle.force
    force[:] = 0.0
    touching = False
    for arm in range(2):
        body = body_of(arm, JOINTS)
        hand = _hand_pose(handle.robot, pose[body])
        state.hand_wrench[arm, :] = 0.0
        for tip in range(2):
            x, y = tip_position(handle.robot, hand, tip)
            contact = tip_contact(
                parameters.contact, handle.target_shape[0], handle.robot.tip_radius,
                x, y, pose[body], twist[body], pose[TARGET], twist[TARGET],
            )  # fmt: skip
            state.tip_contact[arm, tip] = contact.touching
            state.tip_force[arm, tip, 0], state.tip_force[arm, tip, 1] = contact.force_x, contact.force_y
            if contact.touching:
                touching = True
                fx, fy, px, py = contact.force_x, contact.force_y, contact.point_x, contact.point_y
                state.hand_wrench[arm, 0] += fx
                state.hand_wrench[arm, 1] += fy
                state.hand_wrench[arm, 2] += cross(px - hand[0], py - hand[1], fx, fy)
                _add_force(force[body], pose[body], fx, fy, px, py)
                _add_force(force[TARGET], pose[TARGET], -fx, -fy, px, py)
    return touching


@compiled
def _add_force(total: FloatArray, pose: FloatArray, fx: float, fy: float, px: float, py: float) -> None:
    """Add a force at a world point to a body's force and torque about its centre of mass, shape (3,)."""
    total[0] += fx
    total[1] += fy
    total[2] += cross(px - pose[0], py - pose[1], fx, fy)


@compiled
def _hand_pose(robot: RobotModel, body_pose: FloatArray) -> FloatArray:
    """Pose of the hand's centre from that of its centre of mass, shape (3,)."""
    reach = robot.link_length[JOINTS] - robot.link_centre[JOINTS]
    angle = body_pose[2]
    return np.array([body_pose[0] - reach * math.sin(angle), body_pose[1] + reach * math.cos(angle), angle])


@compiled
def _drive_servos(
    handle: PymunkHandle, parameters: Record, joint_rate: FloatArray, state: Record, touching: bool
) -> None:
    """Motor rates at the end of the step: a first-order lag to those commanded, giving way to contact wrenches.

    d(rate)/dt = (commanded - rate) / T + H*^-1 J*^T F, exact over the step for held commanded rates and forces.
    """
    time_constant, dt = parameters.robot.servo.time_constant, parameters.simulation.time_step
    decay = math.exp(-dt / time_constant) if time_constant > 0.0 else 0.0
    given_way = np.zeros(2 * LINKS)
    if touching and time_constant > 0.0:
        given_way = time_constant * _acceleration(handle, parameters, state)
    for arm in range(2):
        for link in range(LINKS):
            driven = link < JOINTS
            commanded = joint_rate[arm, link] if driven else 0.0
            present = state.joint_rate[arm, link] if driven else state.mount_rate[arm]
            settled = commanded + given_way[freedom(arm, link) - 3]
            rate = settled + (present - settled) * decay
            call_scalar(handle.functions[SET_RATE], handle.motors[LINKS * arm + link], -rate)


@compiled
def _acceleration(handle: PymunkHandle, parameters: Record, state: Record) -> FloatArray:
    """H*^-1 J*^T F at the predicted poses, shape (8,) [rad/s2]."""
    pose = handle.predicted
    joint_angle, mount_angle = np.empty((2, JOINTS)), np.empty(2)
    for arm in range(2):
        for link in range(JOINTS):
            child = body_of(arm, link)
            joint_angle[arm, link] = pose[child, 2] - pose[0 if link == 0 else child - 1, 2]
        hand = body_of(arm, JOINTS)
        mount_angle[arm] = pose[hand, 2] - pose[hand - 1, 2]
    links = chain(handle.robot, pose[0], joint_angle, mount_angle)
    model = free_flying_model(handle.robot, pose[0], links)
    free_joints = 2 * JOINTS if parameters.robot.servo.hand_mount == _RIGID else 2 * LINKS
    inertia = inertia_matrix(handle.robot, pose[0], links)
    return joint_acceleration_under_contact(model, inertia, state.hand_wrench, free_joints)


register_kernel(PymunkHandle, step=_step, momentum_size=_momentum_of_all_bodies)
