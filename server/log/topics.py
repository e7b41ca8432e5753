"""What stands in a log: topics, and how ticks become the messages of those that other tools know.

`/becalm/tick` holds every number of every tick (`server.log.ticks`). The other topics show the same run to tools that
know nothing of Becalm. All are ROS 2 messages.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from server.log.ros import Template, header, ros
from server.log.stream import Bytes
from sim.capture.tick import ARMS
from sim.config import MissionConfig
from sim.model.robot import RobotModel, robot_model

STRIDE = 16
"""Ticks between two poses and transforms: 60 a second are enough to watch."""

TICK_TOPIC = "/becalm/tick"
EVENT_TOPIC = "/becalm/event"
LOG_TOPIC = "/rosout"
SCENE_TOPIC = "/scene"

_TRANSFORMS, _JOINT_STATE = "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState"
_WRENCH, _POSE = "geometry_msgs/msg/WrenchStamped", "geometry_msgs/msg/PoseStamped"
_JOINTS = [f"{arm}_joint_{number}" for arm in ARMS for number in (1, 2, 3)]


class Topic(NamedTuple):
    """A topic whose messages follow from ticks."""

    name: str
    schema: str
    stride: int
    """A message every so many ticks."""
    template: Template
    numbers: Callable[[Bytes], Bytes]
    """Of ticks: shape (ticks, numbers)."""


def topics_of(config: MissionConfig, rate: float | None = None) -> list[Topic]:
    """The topics beside `/becalm/tick`, of a robot so configured, each at most at that rate [1/s] if there is one."""
    fewest = 1 if rate is None else max(1, math.ceil(1.0 / (rate * config.control.period) * (1.0 - 1e-9)))
    return [topic._replace(stride=max(topic.stride, fewest)) for topic in _all_topics(robot_model(config.robot))]


def _all_topics(robot: RobotModel) -> list[Topic]:
    return [
        Topic("/tf", _TRANSFORMS, STRIDE, _transforms(), lambda ticks: _transform_numbers(ticks, robot)),
        Topic("/joint_states", _JOINT_STATE, 1, _joint_states(), _joint_numbers),
        *(_wrench_topic(arm) for arm in range(2)),
        _pose_topic("/base/pose", lambda ticks: ticks["base_pose"]),
        _pose_topic("/target/pose", lambda ticks: ticks["target_pose"]),
        _pose_topic("/left_hand/pose", lambda ticks: ticks["hand_pose"][:, 0]),
        _pose_topic("/right_hand/pose", lambda ticks: ticks["hand_pose"][:, 1]),
    ]


def frame_tree() -> list[tuple[str, str]]:
    """(parent, child) of every transform. `*_hand_world_axes` lies at a hand's centre with the world's axes."""
    tree = [("world", "base")]
    for arm in ARMS:
        tree += [("base", f"{arm}_link_1"), (f"{arm}_link_1", f"{arm}_link_2"), (f"{arm}_link_2", f"{arm}_link_3")]
        tree += [("world", f"{arm}_hand"), ("world", f"{arm}_hand_world_axes")]
    return [*tree, ("world", "target")]


def _translations_and_quaternions(poses: Bytes) -> Bytes:
    """Of planar poses, shape (..., 3): shape (..., 7)."""
    numbers = np.zeros((*poses.shape[:-1], 7))
    numbers[..., :2] = poses[..., :2]
    numbers[..., 5], numbers[..., 6] = np.sin(poses[..., 2] / 2), np.cos(poses[..., 2] / 2)
    return numbers


def _transform_numbers(ticks: Bytes, robot: RobotModel) -> Bytes:
    """Of the transforms of `frame_tree`, shape (ticks, 7 times transforms)."""
    poses = np.zeros((len(ticks), len(frame_tree()), 3))
    poses[:, 0], poses[:, -1] = ticks["base_pose"], ticks["target_pose"]
    for arm in range(2):
        links, in_world = poses[:, 1 + 5 * arm : 4 + 5 * arm], poses[:, 4 + 5 * arm : 6 + 5 * arm]
        links[..., 0, :2] = robot.shoulder_in_base[arm]
        links[..., 1:, 1] = robot.link_length[:2]
        links[..., 2] = ticks["joint_angle"][:, arm]
        in_world[:, 0] = ticks["hand_pose"][:, arm]
        in_world[:, 1, :2] = ticks["hand_pose"][:, arm, :2]
    return _translations_and_quaternions(poses).reshape(len(ticks), 7 * len(frame_tree()))


@cache
def _transforms() -> Template:
    def made(numbers: Sequence[float]) -> object:
        transforms = []
        for place, (parent, child) in enumerate(frame_tree()):
            x = numbers[7 * place : 7 * place + 7]
            moved = ros("geometry_msgs/msg/Vector3", *x[:3])
            turned = ros("geometry_msgs/msg/Quaternion", *x[3:])
            transform = ros("geometry_msgs/msg/Transform", moved, turned)
            transforms.append(ros("geometry_msgs/msg/TransformStamped", header(parent), child, transform))
        return ros(_TRANSFORMS, transforms)

    return Template(_TRANSFORMS, 7 * len(frame_tree()), made)


@cache
def _joint_states() -> Template:
    def made(numbers: Sequence[float]) -> object:
        position, velocity = np.array(numbers[:6]), np.array(numbers[6:])
        return ros(_JOINT_STATE, header(""), _JOINTS, position, velocity, np.empty(0))

    return Template(_JOINT_STATE, 12, made)


def _joint_numbers(ticks: Bytes) -> Bytes:
    return np.hstack([ticks["joint_angle"].reshape(-1, 6), ticks["joint_rate"].reshape(-1, 6)])


@cache
def _wrench(arm: int) -> Template:
    def made(numbers: Sequence[float]) -> object:
        force, torque = (ros("geometry_msgs/msg/Vector3", *numbers[i : i + 3]) for i in (0, 3))
        wrench = ros("geometry_msgs/msg/Wrench", force, torque)
        return ros(_WRENCH, header(f"{ARMS[arm]}_hand_world_axes"), wrench)

    return Template(_WRENCH, 6, made)


def _wrench_topic(arm: int) -> Topic:
    """What the target does to a hand, about its centre."""

    def numbers(ticks: Bytes) -> Bytes:
        wrench = np.zeros((len(ticks), 6))
        wrench[:, [0, 1, 5]] = ticks["hand_wrench"][:, arm]
        return wrench

    return Topic(f"/{ARMS[arm]}_hand/wrench", _WRENCH, 1, _wrench(arm), numbers)


@cache
def _pose() -> Template:
    def made(numbers: Sequence[float]) -> object:
        point = ros("geometry_msgs/msg/Point", *numbers[:3])
        turned = ros("geometry_msgs/msg/Quaternion", *numbers[3:])
        return ros(_POSE, header("world"), ros("geometry_msgs/msg/Pose", point, turned))

    return Template(_POSE, 7, made)


def _pose_topic(topic: str, pose: Callable[[Bytes], Bytes]) -> Topic:
    return Topic(topic, _POSE, STRIDE, _pose(), lambda ticks: _translations_and_quaternions(pose(ticks)))
