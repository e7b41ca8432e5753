"""What stands in a log: topics, and how ticks become the messages of those that other tools know.

`/becalm/tick` holds every number of every tick (`server.log.ticks`). The other topics show the same run to tools that
know nothing of Becalm. All are ROS 2 messages.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from server.log.ros import Template, header, ros
from server.log.stream import Bytes
from sim.capture.tick import ARMS
from sim.config import MissionConfig
from sim.model.robot import robot_model

STRIDE = 16
"""Ticks between two poses and transforms: 60 a second are enough to watch."""

TICK_TOPIC = "/becalm/tick"
EVENT_TOPIC = "/becalm/event"
LOG_TOPIC = "/rosout"
SCENE_TOPIC = "/scene"

_JOINTS = [f"{arm}_joint_{number}" for arm in ARMS for number in (1, 2, 3)]


class Topic(NamedTuple):
    """A topic whose messages follow from ticks."""

    name: str
    schema: str
    stride: int
    template: Template
    numbers: Callable[[Bytes], Bytes]
    """Of ticks: shape (ticks, numbers)."""


def topics_of(config: MissionConfig) -> list[Topic]:
    """The topics beside `/becalm/tick`, of a robot so configured."""
    return [
        Topic("/tf", "tf2_msgs/msg/TFMessage", STRIDE, _transforms(), lambda ticks: _transform_numbers(ticks, config)),
        Topic("/joint_states", "sensor_msgs/msg/JointState", 1, _joint_states(), _joint_numbers),
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


def _placed(x: Bytes | float, y: Bytes | float, angle: Bytes | float, count: int) -> Bytes:
    """Translation and quaternion of planar poses, shape (count, 7)."""
    numbers = np.zeros((count, 7))
    numbers[:, 0], numbers[:, 1] = x, y
    numbers[:, 5], numbers[:, 6] = np.sin(np.asarray(angle) / 2), np.cos(np.asarray(angle) / 2)
    return numbers


def _of_pose(pose: Bytes) -> Bytes:
    return _placed(pose[:, 0], pose[:, 1], pose[:, 2], len(pose))


def _transform_numbers(ticks: Bytes, config: MissionConfig) -> Bytes:
    robot, count = robot_model(config.robot), len(ticks)
    parts = [_of_pose(ticks["base_pose"])]
    for arm in range(2):
        joint, hand = ticks["joint_angle"][:, arm], ticks["hand_pose"][:, arm]
        shoulder = robot.shoulder_in_base[arm]
        parts.append(_placed(shoulder[0], shoulder[1], joint[:, 0], count))
        parts += [_placed(0.0, robot.link_length[link - 1], joint[:, link], count) for link in (1, 2)]
        parts += [_of_pose(hand), _placed(hand[:, 0], hand[:, 1], 0.0, count)]
    return np.hstack([*parts, _of_pose(ticks["target_pose"])])


def _transforms() -> Template:
    def made(numbers: Sequence[float]) -> object:
        transforms = []
        for place, (parent, child) in enumerate(frame_tree()):
            x = numbers[7 * place : 7 * place + 7]
            moved = ros("geometry_msgs/msg/Vector3", *x[:3])
            turned = ros("geometry_msgs/msg/Quaternion", *x[3:])
            transform = ros("geometry_msgs/msg/Transform", moved, turned)
            transforms.append(ros("geometry_msgs/msg/TransformStamped", header(parent), child, transform))
        return ros("tf2_msgs/msg/TFMessage", transforms)

    return Template("tf2_msgs/msg/TFMessage", 7 * len(frame_tree()), made)


def _joint_states() -> Template:
    def made(numbers: Sequence[float]) -> object:
        position, velocity = np.array(numbers[:6]), np.array(numbers[6:])
        return ros("sensor_msgs/msg/JointState", header(""), _JOINTS, position, velocity, np.empty(0))

    return Template("sensor_msgs/msg/JointState", 12, made)


def _joint_numbers(ticks: Bytes) -> Bytes:
    return np.hstack([ticks["joint_angle"].reshape(-1, 6), ticks["joint_rate"].reshape(-1, 6)])


def _wrench_topic(arm: int) -> Topic:
    """What the target does to a hand, about its centre."""

    def made(numbers: Sequence[float]) -> object:
        force, torque = (ros("geometry_msgs/msg/Vector3", *numbers[i : i + 3]) for i in (0, 3))
        wrench = ros("geometry_msgs/msg/Wrench", force, torque)
        return ros("geometry_msgs/msg/WrenchStamped", header(f"{ARMS[arm]}_hand_world_axes"), wrench)

    def numbers(ticks: Bytes) -> Bytes:
        wrench = np.zeros((len(ticks), 6))
        wrench[:, [0, 1, 5]] = ticks["hand_wrench"][:, arm]
        return wrench

    name = "geometry_msgs/msg/WrenchStamped"
    return Topic(f"/{ARMS[arm]}_hand/wrench", name, 1, Template(name, 6, made), numbers)


def _pose_topic(topic: str, pose: Callable[[Bytes], Bytes]) -> Topic:
    def made(numbers: Sequence[float]) -> object:
        point = ros("geometry_msgs/msg/Point", *numbers[:3])
        turned = ros("geometry_msgs/msg/Quaternion", *numbers[3:])
        return ros("geometry_msgs/msg/PoseStamped", header("world"), ros("geometry_msgs/msg/Pose", point, turned))

    name = "geometry_msgs/msg/PoseStamped"
    return Topic(topic, name, STRIDE, Template(name, 7, made), lambda ticks: _of_pose(pose(ticks)))
