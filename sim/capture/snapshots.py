"""The snapshot of a tick: what is published of it, put together from a mission's records."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from sim.capture.monitor import touches_of
from sim.capture.narration import description, readiness
from sim.capture.stages import Visit, stages
from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.config import Estimator, MissionConfig
from sim.control.memory import NO_PLAN
from sim.control.phases import Phase
from sim.control.trajectory import BOTH_ARMS
from sim.method.method import Method, method_of
from sim.record import Record
from sim.snapshot import (
    ArmState,
    BodyState,
    Outcome,
    Plan,
    PlannedTouch,
    Prediction,
    Snapshot,
    TargetEstimate,
    Vector2,
    Vector3,
)


class Flown(NamedTuple):
    """What a mission has of its last tick."""

    config: MissionConfig
    row: Record
    """One element of `TICK`."""
    monitor: Record
    memory: Record
    visits: Sequence[Visit]
    outcome: Outcome | None


def snapshot_of(flown: Flown, phase: Phase, reached: Phase) -> Snapshot:
    """The snapshot of a tick in that phase; `reached` is the phase that the mission is in after it."""
    config, row, monitor, memory, visits, outcome = flown
    method = method_of(config)
    touches, plan = touches_of(monitor), _plan(memory, method, reached)
    return Snapshot(
        tick=int(row["tick"]),
        time=float(row["time"]),
        method=config.method.value,
        phase=phase.label,
        activity=method.activities(int(row["activity"])).name.lower(),
        description=description(row, config, phase, plan, touches, outcome),
        base=BodyState(pose=_vector(row["base_pose"]), twist=_vector(row["base_twist"])),
        target=BodyState(pose=_vector(row["target_pose"]), twist=_vector(row["target_twist"])),
        left=_arm_state(row, 0),
        right=_arm_state(row, 1),
        target_estimate=_estimate(row, config),
        trouble=method.words.trouble.get(int(row["trouble"]), ""),
        spin=float(row["target_twist"][2]),
        spin_threshold=method.spin_threshold(config),
        drift=math.hypot(row["target_twist"][0], row["target_twist"][1]),
        cage_closed=bool(row["closed"]),
        cage_margin=outcome.cage_margin if outcome and reached is Phase.HOLDING else None,
        peak_tip_force=float(monitor["peak"]),
        momentum=_vector(row["momentum"]),
        contacts=touches,
        plan=plan,
        readiness=readiness(row, config, phase, outcome),
        stages=stages(visits, phase, outcome),
        outcome=outcome,
    )


def _plan(memory: Record, method: Method, phase: Phase) -> Plan | None:
    if memory["plan_kind"] == NO_PLAN or phase not in (Phase.DETUMBLING, Phase.CAGING, Phase.RELEASED):
        return None
    knots, arm = int(memory["plan_knots"]), int(memory["plan_arm"])
    poses = [
        [_vector(pose) for pose in memory["plan_pose"][side, :knots]] if arm in (BOTH_ARMS, side) else []
        for side in range(2)
    ]
    return Plan(
        kind=method.plan_kinds(int(memory["plan_kind"])).name.lower(),
        times=[float(time) for time in memory["plan_time"][:knots]],
        left=poses[0],
        right=poses[1],
        target_at_end=_vector(memory["predicted_target"]),
        predicted=_prediction(memory["prediction"]),
        touch=_touch(memory["touch_plan"]),
    )


def _touch(planned: Record) -> PlannedTouch | None:
    if not planned["made"]:
        return None
    (left, right), (left_point, right_point) = planned["side"].tolist(), planned["point"].tolist()
    return PlannedTouch(
        left_side=(_point(left[0]), _point(left[1])),
        right_side=(_point(right[0]), _point(right[1])),
        left_point=_point(left_point),
        right_point=_point(right_point),
        lever=float(planned["lever"]),
        arc_left=float(planned["arc_left"]),
    )


def _point(values: Sequence[float]) -> Vector2:
    x, y = values
    return x, y


def _prediction(expected: Record) -> Prediction | None:
    if not expected["made"]:
        return None
    clearance = float(expected["clearance"])
    return Prediction(
        until=float(expected["until"]),
        force=float(expected["force"]),
        base_rotation=float(expected["base_rotation"]),
        manipulability=float(expected["manipulability"]),
        clearance=clearance if math.isfinite(clearance) else None,
    )


def _estimate(row: Record, config: MissionConfig) -> TargetEstimate | None:
    if config.perception.estimator is not Estimator.MODEL_BASED:
        return None
    return TargetEstimate(
        inertia=float(row["target_perceived_inertia"]),
        inertia_deviation=float(row["target_perceived_inertia_deviation"]),
        twist_deviation=_vector(row["target_perceived_twist_deviation"]),
    )


def _vector(values: FloatArray) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z


def _arm_state(row: Any, arm: int) -> ArmState:
    assert arm < len(ARMS)
    (ax, ay), (bx, by) = row["tip_force"][arm].tolist()
    return ArmState(
        joint_angle=_vector(row["joint_angle"][arm]),
        joint_rate=_vector(row["joint_rate"][arm]),
        commanded_joint_rate=_vector(row["commanded_joint_rate"][arm]),
        mount_angle=float(row["mount_angle"][arm]),
        hand_pose=_vector(row["hand_pose"][arm]),
        hand_twist=_vector(row["hand_twist"][arm]),
        desired_hand_pose=_vector(row["desired_hand_pose"][arm]),
        desired_hand_twist=_vector(row["desired_hand_twist"][arm]),
        hand_wrench=_vector(row["hand_wrench"][arm]),
        tip_force=((ax, ay), (bx, by)),
        wanted_force=float(row["wanted_force"][arm]),
        in_contact=bool(row["hand_wrench"][arm].any()),
        manipulability=float(row["manipulability"][arm]),
    )
