"""The bytes of the link, against golden ones that tests/unit/link_golden/encode.py wrote."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from server.link import contract, wire
from server.log.ros import ros, serialized

STAMP = 1_764_000_000_123_456_789
ANGLE = np.array([[0.5, -1.25, -1.5], [-0.5, 1.25, 1.5]])
RATE = np.array([[0.01, -0.02, 0.03], [-0.04, 0.05, -0.06]])
ROUNDING = 1e-15
ROBOT = "testbed.1f"
SESSION = "a1b2c3.1@testbed.1f"

MESSAGES = {
    "joint_states": (wire.encode_joints, wire.decode_joints, wire.JointSample(STAMP, ANGLE, RATE, ROBOT)),
    "joint_command": (wire.encode_joint_command, wire.decode_joint_command, wire.JointCommand(STAMP, SESSION, RATE)),
    "wrench": (
        wire.encode_wrench,
        wire.decode_wrench,
        wire.PlaneSample(STAMP, "left_hand", np.array([0.25, -0.75, 0.125])),
    ),
    "pose": (
        wire.encode_pose,
        wire.decode_pose,
        wire.PlaneSample(STAMP, "world", np.array([0.5, -0.25, math.pi / 2])),
    ),
    "twist": (wire.encode_twist, wire.decode_twist, wire.PlaneSample(STAMP, "world", np.array([0.5, -0.25, 1.5]))),
    "call": (wire.encode_call, wire.decode_call, wire.RobotCall(STAMP, SESSION)),
    "echo": (wire.encode_echo, wire.decode_echo, wire.Echo(STAMP, 17_250_000_000, SESSION, ROBOT)),
    "report": (
        wire.encode_report,
        wire.decode_report,
        wire.StatusReport(STAMP, ROBOT, "stop", False, "why not", {"session": SESSION, "stamp": "17"}),
    ),
}
GOLDEN = json.loads(Path(__file__).with_name("link_golden").joinpath("golden.json").read_text())


def test_there_are_golden_bytes_for_every_message():
    assert GOLDEN.keys() == MESSAGES.keys()


@pytest.mark.parametrize("name", MESSAGES)
def test_encodes_as_the_golden_bytes(name):
    encode, _, message = cast(tuple[Any, Any, Any], MESSAGES[name])
    assert encode(message).hex() == GOLDEN[name]


@pytest.mark.parametrize("name", MESSAGES)
def test_decodes_the_golden_bytes(name):
    _, decode, message = cast(tuple[Any, Any, Any], MESSAGES[name])
    for read, meant in zip(decode(bytes.fromhex(GOLDEN[name])), message, strict=True):
        if isinstance(meant, np.ndarray):
            np.testing.assert_allclose(read, meant, rtol=0, atol=ROUNDING)
        else:
            assert read == meant


@pytest.mark.parametrize("name", MESSAGES)
def test_bytes_cut_short_are_refused(name):
    _, decode, _ = MESSAGES[name]
    with pytest.raises(wire.WireError):
        decode(bytes.fromhex(GOLDEN[name])[:-9])


def test_joints_may_come_in_any_order():
    names = list(reversed(contract.JOINT_NAMES))
    message = ros(
        "sensor_msgs/msg/JointState",
        wire._header(STAMP, ROBOT),
        names,
        ANGLE.ravel()[::-1].copy(),
        RATE.ravel()[::-1].copy(),
        np.empty(0),
    )
    sample = wire.decode_joints(serialized(message, "sensor_msgs/msg/JointState"))
    np.testing.assert_array_equal(sample.angle, ANGLE)
    np.testing.assert_array_equal(sample.rate, RATE)


def test_a_joint_that_is_missing_is_named():
    header = wire._header(STAMP, "")
    message = ros("sensor_msgs/msg/JointState", header, ["elbow"], np.zeros(1), np.zeros(1), np.empty(0))
    with pytest.raises(wire.WireError, match="left_joint_1"):
        wire.decode_joints(serialized(message, "sensor_msgs/msg/JointState"))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_not_finite_are_refused(bad):
    rate = RATE.copy()
    rate[1, 2] = bad
    with pytest.raises(wire.WireError, match="finite"):
        wire.decode_joint_command(wire.encode_joint_command(wire.JointCommand(STAMP, "a", rate)))
    with pytest.raises(wire.WireError, match="finite"):
        wire.decode_twist(wire.encode_twist(wire.PlaneSample(STAMP, "world", np.array([0.0, bad, 0.0]))))


@pytest.mark.parametrize("angle", [-3.1, -0.5, 0.0, 0.3, 3.1])
def test_angles_survive_as_quaternions(angle):
    sample = wire.PlaneSample(STAMP, "world", np.array([0.0, 0.0, angle]))
    assert wire.decode_pose(wire.encode_pose(sample)).value[2] == pytest.approx(angle, abs=ROUNDING)


def test_the_table_in_the_docs_is_the_contract():
    text = Path(__file__).parents[2].joinpath("docs", "link.md").read_text()
    for channel in contract.CHANNELS:
        assert wire.described(channel) in text
    assert f"version {contract.VERSION}" in text
