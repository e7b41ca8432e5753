"""The simulated plant in reduced coordinates: joints cannot part, and a state can be copied.

The robot is its centre of mass, its momentum, the base's angle, and eight joints with their rates. Each step of h is a
velocity Verlet step for momentum and target around an exact one for the servos:

1. half a kick by the forces at the start;
2. a drift: joints by the closed form of the first-order servo, the centre of mass by its momentum, the base's angle
   by the quadrature of L / I + c . (joint rates), with 1 / I and c interpolated over three instants;
3. the contacts at the poses of the end;
4. half a kick by them, and what they change in the joint rates.

Contact is that of `sim.plant.contact`, for tips and solids alike (docs/decisions/0010-reduced-plant.md).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Self

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import HandMount, MissionConfig
from sim.errors import PlantDiverged
from sim.model.clearance import initial_base_pose, initial_target_pose
from sim.model.planar import cross, direction, in_frame, point_velocity
from sim.model.reduced_model import FREE, SHAPE, body_place, joint_place, reduced_inertia, set_shape, solve_in_place
from sim.model.robot import JOINTS, LINKS, RobotModel, base_shape, initial_joint_angles, robot_model
from sim.model.shape import Shape, surface
from sim.model.target import TargetModel, target_model
from sim.plant.contact import contact_force, tip_contact
from sim.plant.plant import (
    PLANT_STATE,
    AirTable,
    SavedState,
    advance_plant,
    air_table,
    copy_state,
    diverged_at,
    register_kernel,
)
from sim.plant.solid_contact import Solids, depth_in_capsule_side, solids
from sim.record import Record, copy_vector, packed, record_of

StateArray = np.ndarray[Any, np.dtype[Any]]

_BASE = -1
"""Stands for an arm where a part of the robot is named by its arm and link."""
_MOST_PIVOTS = 64
"""Of the search for the joints at their torque limit; a few are enough."""
_ROUNDED = 1.0 + 1e-12
"""A torque beyond the limit by rounding is at the limit."""
_STILL = 1e-9
"""Momentum of a plant at rest, for judging jumps [N s]: far above rounding."""

REDUCED_STATE = np.dtype(
    [
        ("centre", np.float64, (2,)),  # the robot's centre of mass
        ("base_angle", np.float64),
        ("joint_angle", np.float64, (FREE,)),
        ("joint_rate", np.float64, (FREE,)),
        ("momentum", np.float64, (3,)),  # of the robot, angular about its centre of mass
        ("target_pose", np.float64, (3,)),
        ("target_twist", np.float64, (3,)),
        ("force", np.float64, (3,)),  # of the contacts on the robot, torque about its centre of mass
        ("target_force", np.float64, (3,)),  # ... on the target, torque about its centre
        ("joint_acceleration", np.float64, (FREE,)),  # that the contacts cause in joints without servos
        ("inverse_inertia", np.float64),  # of the robot about its centre of mass
        ("base_per_joint", np.float64, (FREE,)),  # base rate per unit of joint rate at zero momentum
    ],
    align=True,
)
"""All that the next step depends on, but for the commanded rates; world axes, SI. A copy of it copies the plant."""


class Servo(NamedTuple):
    """The closed form of the first-order servo over one step of h with time constant T."""

    time_constant: float
    free_joints: int
    """8, or 6 if the mounts are rigid."""
    decay: float
    """exp(-h / T)."""
    travel: float
    """Integral of exp(-t / T) over the step [s]."""
    half_travel: float
    """... over its first half."""
    weights: FloatArray
    """Integral of exp(-t / T) times a parabola, per value of it at 0, h / 2, h [s], shape (3,)."""
    correction: float
    """Change of a rate at the end per change of its acceleration over the step [s]."""
    sure_change: float
    """Sum of the sizes of all changes of rates in a step [rad/s] that needs less than the torque limit for sure."""


class Fixed(NamedTuple):
    """What does not change while a plant flies; compiled code reads it as a record."""

    robot: RobotModel
    total_mass: float
    base_shape: Shape
    target: TargetModel
    solids: Solids
    servo: Servo
    table: AirTable


_SCRATCH = np.dtype(
    [
        ("settled", np.float64, (FREE,)),  # rate to which each servo decays [rad/s]
        ("change", np.float64, (FREE,)),  # change of each rate that its servo makes in the step [rad/s]
        ("wanted", np.float64, (FREE,)),  # the same without a torque limit [rad/s]
        ("acceleration", np.float64, (FREE,)),  # that of the joints by the contacts at the start [rad/s2]
        ("torque", np.float64, (FREE,)),  # of contacts at the joints [N m]
        ("matrix", np.float64, (FREE, FREE)),  # H*
        ("part", np.float64, (FREE, FREE)),  # rows and columns of H*
        ("right_side", np.float64, (FREE,)),
        ("saturated", np.int64, (FREE,)),  # sign of the torque of each joint at its limit, 0 within it
        ("axes", np.float64, (2,)),  # cosine and sine of the base's angle at the end of the step
        ("momentum", np.float64, (3,)),  # the robot's, as predicted for the end of the step
        ("target_twist", np.float64, (3,)),  # likewise
        ("base_twist", np.float64, (3,)),  # likewise
        (
            "point",
            np.float64,
            (LINKS + 1, 3),
        ),  # joints of an arm and its hand centre, with the angle of the link before
        ("twist", np.float64, (LINKS + 1, 3)),  # of those points as parts of the link before them
    ],
    align=True,
)
"""What a step writes before it reads it; world axes, SI."""


class ReducedHandle(NamedTuple):
    """What compiled code steps the plant by."""

    plant: StateArray
    """One record: `own` (a `REDUCED_STATE`), the fields of `Fixed`, and what a step writes; shape (1,)."""


class ReducedPlant:
    """The simulated robot and target in reduced coordinates. Owned by one thread."""

    perceived = None

    def __init__(self, config: MissionConfig) -> None:
        """Robot and target as configured."""
        self.parameters: Record = record_of(config)
        self.state: Record = np.zeros(1, PLANT_STATE)[0]
        fixed = _fixed(config)
        self.handle = ReducedHandle(_plant_record(fixed))
        self._own: StateArray = self.handle.plant["own"]
        _lay_out(self._own, config)
        self._begin(initial_base_pose(config), np.zeros(3))

    @classmethod
    def standing(cls, config: MissionConfig, state: Record) -> Self:
        """Robot and target as configured, where a state has them.

        Args:
            config: what they are.
            state: one element of `PLANT_STATE`; contacts, wrenches and momentum of it follow from the rest, and are
                found again.

        """
        plant = cls(config)
        stand(plant.handle, plant.parameters, state, plant.state)
        return plant

    def _begin(self, base_pose: FloatArray, base_twist: FloatArray) -> None:
        _begin(self.handle.plant[0], self.parameters, base_pose, base_twist, self.state)

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

    @property
    def copyable(self) -> Self:
        """The plant itself: `REDUCED_STATE` is all that the next step follows from."""
        return self

    def save(self) -> SavedState:
        """A copy of where the plant stands."""
        return SavedState(self._own.copy(), self.state.copy())

    def restore(self, saved: SavedState) -> None:
        """Return to where the plant stood: from there the same commanded rates give the same states, bit for bit.

        Args:
            saved: of a plant of the same configuration.

        """
        self._own[:] = saved.own
        copy_state(self.state, saved.state)
        _set_shape(self.handle.plant[0], self.handle.plant[0]["end"])


def _fixed(config: MissionConfig) -> Fixed:
    robot, target = robot_model(config.robot), target_model(config.target)
    return Fixed(
        robot=robot,
        total_mass=robot.total_mass,
        base_shape=base_shape(config.robot.base),
        target=target,
        solids=solids(config, robot, target),
        servo=_servo(config, robot),
        table=air_table(config.table),
    )


def _plant_record(fixed: Fixed) -> StateArray:
    """The record of a `ReducedHandle`, shape (1,)."""
    constants = packed(fixed)
    kind = np.dtype(
        [
            ("own", REDUCED_STATE),
            *((name, constants.dtype[name]) for name in constants.dtype.names or ()),
            ("middle", SHAPE),  # of the robot at half the step
            ("end", SHAPE),  # ... at its end
            ("scratch", _SCRATCH),
        ],
        align=True,
    )
    plant = np.zeros(1, kind)
    for name in constants.dtype.names or ():
        plant[name] = constants[name]
    return plant


def _lay_out(own: StateArray, config: MissionConfig) -> None:
    """Joints and target as configured."""
    own["joint_angle"][0, : 2 * JOINTS] = initial_joint_angles(config.robot.arm).ravel()
    target = config.target
    own["target_pose"][0] = initial_target_pose(config)
    own["target_twist"][0] = target.initial_velocity_x, target.initial_velocity_y, target.initial_spin


def _servo(config: MissionConfig, robot: RobotModel) -> Servo:
    servo, step = config.robot.servo, config.simulation.time_step
    T = servo.time_constant
    decay = math.exp(-step / T) if T > 0.0 else 0.0
    reach = float(robot.link_length.sum())
    # No entry of H* is greater than the inertia of all links at the far end of a stretched arm.
    greatest_inertia = float(robot.link_inertia.sum() + robot.link_mass.sum() * reach**2)
    return Servo(
        time_constant=T,
        free_joints=2 * JOINTS if servo.hand_mount is HandMount.RIGID else FREE,
        decay=decay,
        travel=T * -math.expm1(-step / T) if T > 0.0 else 0.0,
        half_travel=T * -math.expm1(-step / (2.0 * T)) if T > 0.0 else 0.0,
        weights=_decaying_weights(step, T),
        correction=_correction(step, T),
        sure_change=servo.torque_limit * step / greatest_inertia,
    )


def _correction(step: float, time_constant: float) -> float:
    """Integral of exp(-(h - t) / T) t / h over the step [s]."""
    if time_constant == 0.0:
        return 0.0
    zeroth, first = _moments(step / time_constant)[:2]
    return step * (zeroth - first)  # by t -> h - t


def _decaying_weights(step: float, time_constant: float) -> FloatArray:
    """Weights of the values of a parabola at 0, h / 2, h in its integral with exp(-t / T) over the step [s]."""
    if time_constant == 0.0:
        return np.zeros(3)
    zeroth, first, second = _moments(step / time_constant)
    return step * np.array([zeroth - 3 * first + 2 * second, 4 * (first - second), 2 * second - first])


def _moments(z: float) -> tuple[float, float, float]:
    """Integrals of x^n exp(-z x) over [0, 1], n = 0, 1, 2; a series where the closed form would cancel."""
    if z > 1.0:
        e = math.exp(-z)
        zeroth = (1.0 - e) / z
        first = (zeroth - e) / z
        return zeroth, first, (2.0 * first - e) / z
    terms = [(-z) ** n / math.factorial(n) for n in range(20)]
    zeroth, first, second = (sum(term / (n + k + 1) for n, term in enumerate(terms)) for k in range(3))
    return zeroth, first, second


@compiled
def stand(handle: ReducedHandle, parameters: Record, where: Record, state: Record) -> None:
    """Put robot and target where one state has them; what follows from that, contacts too, into the other.

    Args:
        handle: of the plant.
        parameters: record of the configuration.
        where: one element of `PLANT_STATE`; its contacts, wrenches and momentum are not read.
        state: likewise; changed.

    """
    own = handle.plant[0].own
    for arm in range(2):
        for link in range(JOINTS):
            own.joint_angle[joint_place(arm, link)] = where.joint_angle[arm, link]
            own.joint_rate[joint_place(arm, link)] = where.joint_rate[arm, link]
        own.joint_angle[joint_place(arm, JOINTS)] = where.mount_angle[arm]
        own.joint_rate[joint_place(arm, JOINTS)] = where.mount_rate[arm]
    copy_vector(own.target_pose, where.target_pose)
    copy_vector(own.target_twist, where.target_twist)
    state.tick, state.time = where.tick, where.time
    _begin(handle.plant[0], parameters, where.base_pose, where.base_twist, state)


@compiled
def _begin(plant: Record, parameters: Record, base_pose: FloatArray, base_twist: FloatArray, state: Record) -> None:
    """Everything that follows from joints, base and target at the start; contacts, too."""
    own = plant.own
    _set_shape(plant, plant.end)
    c, s = direction(base_pose[2])
    x, y = plant.end.centre[0], plant.end.centre[1]
    own.centre[0], own.centre[1] = base_pose[0] + c * x - s * y, base_pose[1] + s * x + c * y
    own.base_angle = base_pose[2]
    _keep_shape(plant)
    _place_base(plant, state)
    _take_momentum(plant, base_twist)
    _predict(plant, 0.0)
    _find_contacts(plant, parameters, state)
    _report(plant, state)


@compiled
def _take_momentum(plant: Record, base_twist: FloatArray) -> None:
    """The robot's momentum that gives its base that twist at the joint rates as they are: `_base_twist` the other way.

    A robot at rest has none, to the last bit.
    """
    own, rest = plant.own, np.empty(3)
    own.momentum[:] = 0.0
    if not base_twist.any() and not own.joint_rate.any():
        return
    _base_twist(plant, own.momentum, rest)
    spin = (base_twist[2] - rest[2]) / plant.end.inverse_inertia
    own.momentum[2] = spin
    _base_twist(plant, own.momentum, rest)
    for axis in range(2):
        own.momentum[axis] = plant.total_mass * (base_twist[axis] - rest[axis])


@compiled_inline
def _set_shape(plant: Record, shape: Record) -> None:
    """The robot's shape at the joint angles as they are, into a record of `SHAPE`."""
    angle = plant.own.joint_angle
    for arm in range(2):
        turn = 0.0
        for link in range(LINKS):
            turn += angle[joint_place(arm, link)]
            shape.turn[body_place(arm, link)] = turn
    set_shape(plant.robot, shape)


@compiled_inline
def _step(handle: ReducedHandle, parameters: Record, joint_rate: FloatArray, state: Record) -> None:
    """One physics step under joint rates [rad/s], shape (2, 3); the state is that of its end."""
    plant = handle.plant[0]
    step = parameters.simulation.time_step
    own, before = plant.own, plant.scratch.acceleration
    copy_vector(before, own.joint_acceleration)
    _settle(plant, parameters, joint_rate, step)
    _kick(plant, 0.5 * step)
    _drift(plant, step)
    _place_base(plant, state)
    _predict(plant, 0.5 * step)
    _find_contacts(plant, parameters, state)
    for joint in range(FREE):
        own.joint_rate[joint] += plant.servo.correction * (own.joint_acceleration[joint] - before[joint])
    _kick(plant, 0.5 * step)
    _report(plant, state)


@compiled_inline
def _settle(plant: Record, parameters: Record, joint_rate: FloatArray, step: float) -> None:
    """The rates to which the servos decay: those commanded, giving way to contact, within the torque limit."""
    own, servo, scratch = plant.own, plant.servo, plant.scratch
    total = 0.0
    for arm in range(2):
        for link in range(LINKS):
            joint = joint_place(arm, link)
            commanded = joint_rate[arm, link] if link < JOINTS else 0.0
            settled = commanded + servo.time_constant * own.joint_acceleration[joint]
            scratch.settled[joint] = settled
            change = (settled - own.joint_rate[joint]) * (1.0 - servo.decay) - step * own.joint_acceleration[joint]
            scratch.change[joint] = change
            total += abs(change)
    if total > servo.sure_change:
        _limit_torque(plant, parameters.robot.servo.torque_limit, step)


@compiled
def _limit_torque(plant: Record, limit: float, step: float) -> None:
    """Joints that would need more than the limit [N m] get it; the others get the rates that their servos ask for.

    Which are which depends on all of them, so one after the other is put right (Murty's least index, which ends for
    a positive definite H*).
    """
    own, servo, scratch = plant.own, plant.servo, plant.scratch
    _set_shape(plant, plant.middle)
    reduced_inertia(plant.total_mass, plant.middle, scratch.matrix)
    scratch.saturated[:] = 0
    copy_vector(scratch.wanted, scratch.change)
    for _ in range(_MOST_PIVOTS):
        if not _put_one_right(plant, limit * step):
            break
        _change_saturated(plant, limit * step)
    for joint in range(servo.free_joints):
        if scratch.saturated[joint] == 0:
            continue
        end = own.joint_rate[joint] + step * own.joint_acceleration[joint] + scratch.change[joint]
        scratch.settled[joint] = (end - own.joint_rate[joint] * servo.decay) / (1.0 - servo.decay)


@compiled
def _put_one_right(plant: Record, impulse: float) -> bool:
    """Mark or release the first joint that an impulse [N m s] in the step moves too little or too far; if any."""
    scratch, size = plant.scratch, plant.servo.free_joints
    for i in range(size):
        mark = scratch.saturated[i]
        if mark != 0:
            if mark * (scratch.change[i] - scratch.wanted[i]) > 0.0:
                scratch.saturated[i] = 0
                scratch.change[i] = scratch.wanted[i]
                return True
            continue
        needed = 0.0
        for j in range(size):
            needed += scratch.matrix[i, j] * scratch.change[j]
        if abs(needed) > impulse * _ROUNDED:
            scratch.saturated[i] = 1 if needed > 0.0 else -1
            return True
    return False


@compiled
def _change_saturated(plant: Record, impulse: float) -> None:
    """Changes of the rates of the marked joints under their impulses [N m s], the others' as they are."""
    scratch, size = plant.scratch, plant.servo.free_joints
    count = 0
    for i in range(size):
        if scratch.saturated[i] != 0:
            scratch.right_side[count] = scratch.saturated[i] * impulse
            column = 0
            for j in range(size):
                if scratch.saturated[j] != 0:
                    scratch.part[count, column] = scratch.matrix[i, j]
                    column += 1
                else:
                    scratch.right_side[count] -= scratch.matrix[i, j] * scratch.change[j]
            count += 1
    solve_in_place(scratch.part, scratch.right_side, count)
    count = 0
    for i in range(size):
        if scratch.saturated[i] != 0:
            scratch.change[i] = scratch.right_side[count]
            count += 1


@compiled_inline
def _kick(plant: Record, time: float) -> None:
    """Momentum and the target's twist by forces, drag and tilt held for that long [s]."""
    own, table, target = plant.own, plant.table, plant.target
    for axis in range(2):
        slope = table.slope_x if axis == 0 else table.slope_y
        own.momentum[axis] += time * (own.force[axis] + plant.total_mass * slope)
        own.target_twist[axis] += time * (own.target_force[axis] / target.mass + slope)
    own.momentum[2] += time * own.force[2]
    own.target_twist[2] += time * own.target_force[2] / target.inertia
    if table.drag != 0.0:
        left = math.exp(-table.drag * time)
        for axis in range(3):
            own.momentum[axis] *= left
            own.target_twist[axis] *= left


@compiled_inline
def _drift(plant: Record, step: float) -> None:
    """Positions and joint rates at the end of the step, at momenta as they are."""
    own, servo, settled = plant.own, plant.servo, plant.scratch.settled
    for joint in range(FREE):
        excess = own.joint_rate[joint] - settled[joint]
        start = own.joint_angle[joint]
        own.joint_angle[joint] = start + settled[joint] * 0.5 * step + excess * servo.half_travel
        plant.scratch.change[joint] = start + settled[joint] * step + excess * servo.travel
    _set_shape(plant, plant.middle)
    copy_vector(own.joint_angle, plant.scratch.change)
    _set_shape(plant, plant.end)
    own.base_angle += _turn(plant, step)
    for joint in range(FREE):
        own.joint_rate[joint] = settled[joint] + (own.joint_rate[joint] - settled[joint]) * servo.decay
    for axis in range(2):
        own.centre[axis] += step * own.momentum[axis] / plant.total_mass
    for axis in range(3):
        own.target_pose[axis] += step * own.target_twist[axis]
    _keep_shape(plant)


@compiled_inline
def _turn(plant: Record, step: float) -> float:
    """The base's turn in the step [rad]: base rate = L / I + c . (joint rates), I and c at three instants."""
    own, servo, settled = plant.own, plant.servo, plant.scratch.settled
    first, middle, last = own.base_per_joint, plant.middle.base_per_joint, plant.end.base_per_joint
    sixth = step / 6.0
    turn = (
        own.momentum[2] * sixth * (own.inverse_inertia + 4.0 * plant.middle.inverse_inertia + plant.end.inverse_inertia)
    )
    for joint in range(FREE):
        steady = sixth * (first[joint] + 4.0 * middle[joint] + last[joint])
        weights = servo.weights
        decaying = weights[0] * first[joint] + weights[1] * middle[joint] + weights[2] * last[joint]
        turn += settled[joint] * steady + (own.joint_rate[joint] - settled[joint]) * decaying
    return float(turn)


@compiled_inline
def _keep_shape(plant: Record) -> None:
    """What the next step needs of the shape at its start."""
    own = plant.own
    own.inverse_inertia = plant.end.inverse_inertia
    copy_vector(own.base_per_joint, plant.end.base_per_joint)


@compiled_inline
def _place_base(plant: Record, state: Record) -> None:
    """The base's pose from the centre of mass and the base's angle."""
    own, end, axes = plant.own, plant.end, plant.scratch.axes
    c, s = direction(own.base_angle)
    axes[0], axes[1] = c, s
    state.base_pose[0] = own.centre[0] - (c * end.centre[0] - s * end.centre[1])
    state.base_pose[1] = own.centre[1] - (s * end.centre[0] + c * end.centre[1])
    state.base_pose[2] = own.base_angle


@compiled_inline
def _predict(plant: Record, time: float) -> None:
    """Momentum and target twist that long from now [s] under the forces as they are, and the base's twist then."""
    own, target, scratch = plant.own, plant.target, plant.scratch
    for axis in range(3):
        scratch.momentum[axis] = own.momentum[axis] + time * own.force[axis]
        inertia = target.mass if axis < 2 else target.inertia
        scratch.target_twist[axis] = own.target_twist[axis] + time * own.target_force[axis] / inertia
    _base_twist(plant, scratch.momentum, scratch.base_twist)


@compiled_inline
def _base_twist(plant: Record, momentum: FloatArray, twist: FloatArray) -> None:
    """Of the base's centre of mass at the end of the step, from the robot's momentum, shape (3,), and joint rates."""
    own, end, axes = plant.own, plant.end, plant.scratch.axes
    rate = momentum[2] * end.inverse_inertia
    x = y = 0.0
    for joint in range(FREE):
        joint_rate = own.joint_rate[joint]
        rate += end.base_per_joint[joint] * joint_rate
        x += end.lean[joint, 1] * joint_rate
        y -= end.lean[joint, 0] * joint_rate
    x = x / plant.total_mass + rate * end.centre[1]
    y = y / plant.total_mass - rate * end.centre[0]
    twist[0] = momentum[0] / plant.total_mass + axes[0] * x - axes[1] * y
    twist[1] = momentum[1] / plant.total_mass + axes[1] * x + axes[0] * y
    twist[2] = rate


@compiled_inline
def _find_contacts(plant: Record, parameters: Record, state: Record) -> None:
    """All contacts at the poses of the end of the step: forces, the joints' accelerations by them, and counts."""
    own = plant.own
    own.force[:] = 0.0
    own.target_force[:] = 0.0
    own.joint_acceleration[:] = 0.0
    plant.scratch.torque[:] = 0.0
    state.hand_wrench[:] = 0.0
    state.tip_force[:] = 0.0
    state.tip_contact[:] = 0
    state.base_contact = state.arm_contact = 0
    x, y = _target_in_base(plant, state)
    solids = plant.solids
    touching = False
    if _within(solids.base_reach, x, y + solids.base_ahead):
        state.base_contact = _touch_base(plant, parameters, state)
    for arm in range(2):
        if _is_near_arm(plant, arm, x, y):
            _place_arm(plant, arm, state)
            state.arm_contact += _touch_links(plant, parameters, arm)
            touching = _touch_tips(plant, parameters, arm, state) or touching
    if touching or state.base_contact > 0 or state.arm_contact > 0:
        _accelerate_joints(plant)


@compiled_inline
def _target_in_base(plant: Record, state: Record) -> tuple[float, float]:
    """The target's centre in base axes from the base's centre of mass [m]."""
    own, axes = plant.own, plant.scratch.axes
    dx, dy = own.target_pose[0] - state.base_pose[0], own.target_pose[1] - state.base_pose[1]
    return axes[0] * dx + axes[1] * dy, -axes[1] * dx + axes[0] * dy


@compiled_inline
def _within(reach: float, x: float, y: float) -> bool:
    """Whether a vector is no longer than that."""
    return x * x + y * y <= reach * reach


@compiled_inline
def _is_near_arm(plant: Record, arm: int, x: float, y: float) -> bool:
    """Whether the target, centred there in base axes [m], may touch a part of the arm."""
    joint, hand, solids = plant.end.joint, plant.end.hand, plant.solids
    if _within(solids.hand_reach, x - hand[arm, 0], y - hand[arm, 1]):
        return True
    for link in range(JOINTS):
        middle_x = 0.5 * (joint[arm, link, 0] + joint[arm, link + 1, 0])
        middle_y = 0.5 * (joint[arm, link, 1] + joint[arm, link + 1, 1])
        if _within(solids.link_reach[link], x - middle_x, y - middle_y):
            return True
    return False


@compiled_inline
def _place_arm(plant: Record, arm: int, state: Record) -> None:
    """Joints, hand centre and their predicted twists in the world."""
    own, end, axes, scratch = plant.own, plant.end, plant.scratch.axes, plant.scratch
    base_pose, point, twist = state.base_pose, scratch.point, scratch.twist
    angle, rate = base_pose[2], scratch.base_twist[2]
    for place in range(LINKS + 1):
        x = end.joint[arm, place, 0] if place < LINKS else end.hand[arm, 0]
        y = end.joint[arm, place, 1] if place < LINKS else end.hand[arm, 1]
        point[place, 0] = base_pose[0] + axes[0] * x - axes[1] * y
        point[place, 1] = base_pose[1] + axes[1] * x + axes[0] * y
        if place == 0:
            twist[0, 0], twist[0, 1] = point_velocity(base_pose, scratch.base_twist, point[0, 0], point[0, 1])
        else:
            joint = joint_place(arm, place - 1)
            angle += own.joint_angle[joint]
            rate += own.joint_rate[joint]
            twist[place, 0] = twist[place - 1, 0] - rate * (point[place, 1] - point[place - 1, 1])
            twist[place, 1] = twist[place - 1, 1] + rate * (point[place, 0] - point[place - 1, 0])
        point[place, 2], twist[place, 2] = angle, rate


@compiled
def _touch_tips(plant: Record, parameters: Record, arm: int, state: Record) -> bool:
    """Contact of both tips of a hand, into the state and as forces; whether there is any."""
    own, scratch = plant.own, plant.scratch
    hand, hand_twist = scratch.point[LINKS], scratch.twist[LINKS]
    cosine, sine = _hand_axes(plant, arm)
    touching = False
    for tip in range(2):
        offset = plant.robot.tip_offset if tip == 1 else -plant.robot.tip_offset
        contact = tip_contact(
            parameters.contact, plant.target.shape, plant.robot.tip_radius,
            hand[0] + offset * cosine, hand[1] + offset * sine, hand, hand_twist,
            own.target_pose, scratch.target_twist,
        )  # fmt: skip
        if contact.touching:
            touching = True
            fx, fy, px, py = contact.force_x, contact.force_y, contact.point_x, contact.point_y
            state.tip_contact[arm, tip] = 1
            state.tip_force[arm, tip, 0], state.tip_force[arm, tip, 1] = fx, fy
            state.hand_wrench[arm, 0] += fx
            state.hand_wrench[arm, 1] += fy
            state.hand_wrench[arm, 2] += cross(px - hand[0], py - hand[1], fx, fy)
            _push_arm(plant, arm, JOINTS, fx, fy, px, py)
            _push(plant, fx, fy, px, py)
    return touching


@compiled_inline
def _hand_axes(plant: Record, arm: int) -> tuple[float, float]:
    """Cosine and sine of a hand's angle in the world."""
    axes, end = plant.scratch.axes, plant.end
    c, s = end.cosine[body_place(arm, JOINTS)], end.sine[body_place(arm, JOINTS)]
    return axes[0] * c - axes[1] * s, axes[1] * c + axes[0] * s


@compiled
def _touch_links(plant: Record, parameters: Record, arm: int) -> int:
    """Contacts of the links, palm and fingers of an arm as forces; how many parts touch."""
    point, solids = plant.scratch.point, plant.solids
    count = 0
    for link in range(JOINTS):
        start_x, start_y = point[link, 0], point[link, 1]
        if link == 0:
            part = solids.link_1_start / plant.robot.link_length[0]
            start_x += part * (point[1, 0] - start_x)
            start_y += part * (point[1, 1] - start_y)
        end_x, end_y = point[link + 1, 0], point[link + 1, 1]
        count += _touch_capsule(plant, parameters, arm, link, solids.link_radius, start_x, start_y, end_x, end_y)
    c, s = _hand_axes(plant, arm)
    hand = point[LINKS]
    end_x, end_y = _at(hand, c, s, solids.outline[0])
    for side in range(3):
        start_x, start_y = end_x, end_y
        end_x, end_y = _at(hand, c, s, solids.outline[side + 1])
        count += _touch_capsule(plant, parameters, arm, JOINTS, solids.finger_radius, start_x, start_y, end_x, end_y)
    return count


@compiled_inline
def _at(origin: FloatArray, c: float, s: float, point: FloatArray) -> tuple[float, float]:
    """A point of a frame whose axes have that cosine and sine, in the world [m]."""
    return origin[0] + (c * point[0] - s * point[1]), origin[1] + (s * point[0] + c * point[1])


@compiled
def _touch_capsule(
    plant: Record,
    parameters: Record,
    arm: int,
    link: int,
    radius: float,
    start_x: float,
    start_y: float,
    end_x: float,
    end_y: float,
) -> int:
    """Contact of one capsule of a link or hand: its ends in the target, the target's corners in it; 1 if any."""
    target, shape = plant.own.target_pose, plant.target.shape
    from_x, from_y, to_x, to_y = start_x - target[0], start_y - target[1], end_x - target[0], end_y - target[1]
    if not _passes_within(radius + shape.corner_circle, from_x, from_y, to_x, to_y):
        return 0
    c, s = direction(target[2])
    start_u, start_v = c * from_x + s * from_y, c * from_y - s * from_x
    end_u, end_v = c * to_x + s * to_y, c * to_y - s * to_x
    touching = 0
    for end in range(2):
        u, v = (start_u, start_v) if end == 0 else (end_u, end_v)
        distance, normal_u, normal_v = surface(shape, u, v)
        if distance < radius:
            x, y = (start_x, start_y) if end == 0 else (end_x, end_y)
            nx, ny = c * normal_u - s * normal_v, s * normal_u + c * normal_v
            _press(plant, parameters, arm, link, radius - distance, nx, ny, x - radius * nx, y - radius * ny)
            touching = 1
    for corner in range(shape.corners):
        u, v = shape.vertices[corner, 0], shape.vertices[corner, 1]
        reach = radius + shape.rounding
        depth, normal_u, normal_v = depth_in_capsule_side(start_u, start_v, end_u, end_v, reach, u, v)
        if depth > 0.0:
            u, v = u - shape.rounding * normal_u, v - shape.rounding * normal_v
            x, y = target[0] + (c * u - s * v), target[1] + (s * u + c * v)
            nx, ny = s * normal_v - c * normal_u, -s * normal_u - c * normal_v
            _press(plant, parameters, arm, link, depth, nx, ny, x, y)
            touching = 1
    return touching


@compiled_inline
def _passes_within(reach: float, start_x: float, start_y: float, end_x: float, end_y: float) -> bool:
    """Whether a straight way comes that near to the origin."""
    along_x, along_y = end_x - start_x, end_y - start_y
    length_squared = along_x * along_x + along_y * along_y
    part = -(start_x * along_x + start_y * along_y)
    part = 0.0 if part <= 0.0 else min(1.0, part / length_squared)
    return _within(reach, start_x + part * along_x, start_y + part * along_y)


@compiled
def _corner(shape: Record, pose: FloatArray, corner: int) -> tuple[float, float]:
    """A corner of a shape whose frame has that pose, in the world [m]."""
    c, s = direction(pose[2])
    return _at(pose, c, s, shape.vertices[corner])


@compiled
def _touch_base(plant: Record, parameters: Record, state: Record) -> int:
    """Contact of the base: its corners in the target and the target's in it; 1 if any."""
    copy_vector(plant.scratch.point[0], state.base_pose)
    base, target = plant.base_shape, plant.target.shape
    pushing = _press_corners(plant, parameters, base, state.base_pose, target, plant.own.target_pose, 1.0)
    pushed = _press_corners(plant, parameters, target, plant.own.target_pose, base, state.base_pose, -1.0)
    return max(pushing, pushed)


@compiled
def _press_corners(
    plant: Record,
    parameters: Record,
    shape: Record,
    pose: FloatArray,
    other: Record,
    other_pose: FloatArray,
    way: float,
) -> int:
    """Contacts of the base by the corners of one shape in another; 1 if any.

    Args:
        plant: record of `PLANT`.
        parameters: record of the configuration.
        shape: whose corners.
        pose: of its frame, shape (3,).
        other: what they are pushed out of.
        other_pose: of its frame, shape (3,).
        way: 1 if the corners are the base's, -1 if they are the target's.

    """
    touching = 0
    for corner in range(shape.corners):
        x, y = _corner(shape, pose, corner)
        u, v = in_frame(other_pose, x, y)
        distance, normal_u, normal_v = surface(other, u, v)
        depth = shape.rounding - distance
        if depth > 0.0:
            c, s = direction(other_pose[2])
            nx, ny = c * normal_u - s * normal_v, s * normal_u + c * normal_v
            px, py = x - shape.rounding * nx, y - shape.rounding * ny
            _press(plant, parameters, _BASE, 0, depth, way * nx, way * ny, px, py)
            touching = 1
    return touching


@compiled
def _press(
    plant: Record,
    parameters: Record,
    arm: int,
    link: int,
    depth: float,
    nx: float,
    ny: float,
    px: float,
    py: float,
) -> None:
    """The force of a solid contact on base or arm and target, at a world point [m].

    Args:
        plant: record of `PLANT`.
        parameters: record of the configuration.
        arm: whose part it is, or `_BASE`.
        link: which of its links, 3 for the hand.
        depth: of the overlap [m].
        nx: the direction in which the robot is pushed, world axes.
        ny: likewise.
        px: where [m].
        py: likewise.

    """
    law, scratch, own = parameters.contact, plant.scratch, plant.own
    if arm == _BASE:
        vx, vy = point_velocity(scratch.point[0], scratch.base_twist, px, py)
    else:
        vx, vy = point_velocity(scratch.point[link + 1], scratch.twist[link + 1], px, py)
    target_vx, target_vy = point_velocity(own.target_pose, scratch.target_twist, px, py)
    fx, fy = contact_force(
        law.solid_stiffness, law.solid_damping, law.friction, law.friction_speed,
        depth, nx, ny, vx - target_vx, vy - target_vy,
    )  # fmt: skip
    if arm != _BASE:
        _push_arm(plant, arm, link, fx, fy, px, py)
    _push(plant, fx, fy, px, py)


@compiled
def _push(plant: Record, fx: float, fy: float, px: float, py: float) -> None:
    """Add a force [N] at a world point [m] to those on the robot, and its opposite to those on the target."""
    own = plant.own
    own.force[0] += fx
    own.force[1] += fy
    own.force[2] += cross(px - own.centre[0], py - own.centre[1], fx, fy)
    own.target_force[0] -= fx
    own.target_force[1] -= fy
    own.target_force[2] -= cross(px - own.target_pose[0], py - own.target_pose[1], fx, fy)


@compiled
def _push_arm(plant: Record, arm: int, link: int, fx: float, fy: float, px: float, py: float) -> None:
    """Add a force [N] on a link at a world point [m] to the torques at the joints that carry it."""
    point, torque = plant.scratch.point, plant.scratch.torque
    for inner in range(link + 1):
        torque[joint_place(arm, inner)] += cross(px - point[inner, 0], py - point[inner, 1], fx, fy)


@compiled
def _accelerate_joints(plant: Record) -> None:
    """H*^-1 J*^T F: the accelerations of joints that give way to the contacts; none without a time constant."""
    own, end, axes, scratch = plant.own, plant.end, plant.scratch.axes, plant.scratch
    size = plant.servo.free_joints
    if plant.servo.time_constant == 0.0:
        return
    fx = axes[0] * own.force[0] + axes[1] * own.force[1]
    fy = -axes[1] * own.force[0] + axes[0] * own.force[1]
    for joint in range(size):
        scratch.torque[joint] += end.base_per_joint[joint] * own.force[2]
        scratch.torque[joint] -= cross(end.lean[joint, 0], end.lean[joint, 1], fx, fy) / plant.total_mass
    reduced_inertia(plant.total_mass, end, scratch.matrix)
    solve_in_place(scratch.matrix, scratch.torque, size)
    for joint in range(size):
        own.joint_acceleration[joint] = scratch.torque[joint]


@compiled_inline
def _report(plant: Record, state: Record) -> None:
    """What the plant reports beside the base's pose and the contacts."""
    own = plant.own
    _base_twist(plant, own.momentum, state.base_twist)
    for arm in range(2):
        for link in range(JOINTS):
            joint = joint_place(arm, link)
            state.joint_angle[arm, link], state.joint_rate[arm, link] = own.joint_angle[joint], own.joint_rate[joint]
        mount = joint_place(arm, JOINTS)
        state.mount_angle[arm], state.mount_rate[arm] = own.joint_angle[mount], own.joint_rate[mount]
    copy_vector(state.target_pose, own.target_pose)
    copy_vector(state.target_twist, own.target_twist)
    mass = plant.target.mass
    target_x, target_y = mass * own.target_twist[0], mass * own.target_twist[1]
    state.momentum[0] = own.momentum[0] + target_x
    state.momentum[1] = own.momentum[1] + target_y
    state.momentum[2] = (
        own.momentum[2]
        + cross(own.centre[0], own.centre[1], own.momentum[0], own.momentum[1])
        + plant.target.inertia * own.target_twist[2]
        + cross(own.target_pose[0], own.target_pose[1], target_x, target_y)
    )


@compiled_inline
def _momentum_size(handle: ReducedHandle) -> float:
    """The sum of the sizes of the robot's and the target's momenta [N s, with N m s at 1 m]."""
    own, target = handle.plant[0].own, handle.plant[0].target
    size = _STILL + abs(own.momentum[0]) + abs(own.momentum[1]) + abs(own.momentum[2])
    size += target.mass * (abs(own.target_twist[0]) + abs(own.target_twist[1]))
    return float(size + target.inertia * abs(own.target_twist[2]))


@compiled_inline
def _shape(handle: ReducedHandle, robot: Record, state: Record, shape: Record) -> Record:
    """The robot's shape at the end of the last step, which that step has found: `shape_of_state` gives the same."""
    return handle.plant[0].end


register_kernel(ReducedHandle, step=_step, momentum_size=_momentum_size, shape=_shape)
