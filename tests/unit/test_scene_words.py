"""What browsers say to a scene: their own camera passes, whatever else there is does not."""

from __future__ import annotations

import math

import msgspec
import pytest
import viser._messages as viser_messages

from benchmarks.loads import CAMERA
from server.pages.scene_words import FARTHEST, LARGEST, accepted_camera


def said(**changes):
    return msgspec.msgpack.encode(CAMERA | changes)


def test_a_camera_is_what_viser_reads():
    told = viser_messages.Message.deserialize(accepted_camera(said()) or b"")
    assert isinstance(told, viser_messages.ViewerCameraMessage)
    assert told.position == (1.0, -2.0, 3.0)
    assert (told.image_width, told.image_height, told.fov) == (900, 420, 0.45)


def test_every_field_of_visers_camera_is_known():
    """A new version of viser that says more of it would be dropped here, and cameras would not frame the window."""
    assert set(CAMERA) - {"type"} == set(viser_messages.ViewerCameraMessage.__dataclass_fields__)


def test_no_other_message_of_visers_passes():
    kinds = viser_messages.Message._subclass_from_type_string()
    assert len(kinds) > 50
    for kind in kinds.keys() - {"ViewerCameraMessage"}:
        assert accepted_camera(said(type=kind)) is None
        assert accepted_camera(msgspec.msgpack.encode({"type": kind})) is None


@pytest.mark.parametrize("field", ["wxyz", "position", "look_at", "up_direction"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e308, 2 * FARTHEST, "1", None, [1.0]])
def test_numbers_that_no_camera_has_do_not_pass(field, value):
    assert accepted_camera(said(**{field: [value, *CAMERA[field][1:]]})) is None


@pytest.mark.parametrize(
    "changes",
    [
        {"fov": math.nan},
        {"fov": 0.0},
        {"fov": math.pi},
        {"near": math.nan},
        {"far": math.inf},
        {"image_height": 0},
        {"image_width": -900},
        {"image_width": 10**9},
        {"image_width": 2**70 // 2**8},
        {"position": [0.0, 0.0]},
        {"position": [0.0] * 100},
        {"position": 1.0},
        {"more": "x"},
        {"type": None},
    ],
)
def test_what_is_not_quite_a_camera_does_not_pass(changes):
    assert accepted_camera(said(**changes)) is None


@pytest.mark.parametrize(
    "message",
    [
        None,
        "text",
        b"",
        b"rubbish",
        b"\xc1",
        b"\x91" * 2000,
        said()[:-1],
        said(up_direction=[0.0, b"x" * LARGEST]),
    ],
)
def test_what_is_no_message_at_all_does_not_pass(message):
    assert accepted_camera(message) is None
