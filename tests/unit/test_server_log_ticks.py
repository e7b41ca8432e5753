"""Ticks of a log, read by the schema that the log brings along."""

from __future__ import annotations

import numpy as np
import pytest
from mcap.records import Channel, Schema

from server.errors import StoredUnreadable
from server.log.stream import Contents
from server.log.ticks import (
    CDR_TICK,
    TICK_CHANNEL,
    StoredColumn,
    TickLayout,
    field_name,
    layout_in,
    schema_of,
    tick_payloads,
    tick_schema,
)
from sim.capture.tick import COLUMNS, TICK, column_values

OTHER = [
    StoredColumn("phase", "u1", "1"),
    StoredColumn("time", "f8", "s"),
    StoredColumn("charge", "f4", "V"),
    StoredColumn("tick", "i8", "1"),
    StoredColumn("left_hand_wrench_torque", "f8", "N m"),
    StoredColumn("closed", "u1", "1"),
]
"""Some of today's columns in another order, with gaps between them in CDR, and one that nobody knows."""


def _schema(text: str) -> Schema:
    return Schema(id=0, name="becalm_msgs/msg/Tick", encoding="ros2msg", data=text.encode())


def _some_ticks() -> np.ndarray[tuple[int], np.dtype[np.void]]:
    ticks = np.zeros(3, TICK)
    for place, column in enumerate(COLUMNS):
        column_values(ticks, column)[:] = np.arange(3) + place
    return ticks


def test_todays_ticks_come_back_to_the_last_bit() -> None:
    ticks = _some_ticks()
    layout = TickLayout(tick_schema())
    payloads = tick_payloads(ticks)
    assert layout.ticks(payloads.view(f"V{payloads.dtype.itemsize}")).tobytes() == ticks.tobytes()
    assert (layout.absent, layout.further) == ((), ())


def test_columns_in_another_order_are_found_where_cdr_has_them() -> None:
    layout = TickLayout(schema_of(OTHER))
    values = {
        "phase": np.array([3, 4]), "time": np.array([0.5, 0.75]), "charge": np.array([1.5, -2.5]),
        "tick": np.array([-7, 2**40]), "left_hand_wrench_torque": np.array([0.125, -8.0]), "closed": np.array([1, 0]),
    }  # fmt: skip
    payloads = layout.packed(values, 2)
    # By hand: u1 at 0, f8 at 8, f4 at 16, i8 at 24 (a multiple of 8), f8 at 32, u1 at 40; four bytes of head before.
    raw = payloads[1].tobytes()
    assert len(raw) == 4 + 41
    assert raw[:5] == b"\x00\x01\x00\x00\x04"
    assert np.frombuffer(raw[12:20], "<f8")[0] == 0.75
    assert np.frombuffer(raw[20:24], "<f4")[0] == -2.5
    assert np.frombuffer(raw[28:36], "<i8")[0] == 2**40
    assert np.frombuffer(raw[36:44], "<f8")[0] == -8.0
    ticks = layout.ticks(payloads)
    assert ticks["time"].tolist() == [0.5, 0.75]
    assert ticks["tick"].tolist() == [-7, 2**40]
    assert ticks["phase"].tolist() == [3, 4]
    assert ticks["closed"].tolist() == [1, 0]
    assert ticks["hand_wrench"][:, 0, 2].tolist() == [0.125, -8.0]


def test_what_it_lacks_is_filled_and_what_nobody_knows_is_kept() -> None:
    layout = TickLayout(schema_of(OTHER))
    payloads = layout.packed({each.name: np.array([1]) for each in OTHER}, 1)
    ticks = layout.ticks(payloads)
    assert {column.name for column in layout.absent} == {column.name for column in COLUMNS} - {
        "mission.phase", "mission.time", "mission.tick", "mission.closed", "left.hand_wrench.torque"
    }  # fmt: skip
    assert np.isnan(ticks["hand_wrench"][0, 0, 0])
    assert np.isnan(ticks["base_pose"]).all()
    assert ticks["plan"][0] == 0
    assert layout.further == (StoredColumn("charge", "f4", "V"),)
    assert layout.values(payloads, layout.further[0]).tolist() == [1.0]


def test_bytes_at_the_end_that_a_writer_padded_with_do_not_matter() -> None:
    layout = TickLayout(schema_of(OTHER))
    payloads = layout.packed({each.name: np.array([5]) for each in OTHER}, 1)
    padded = np.frombuffer(payloads[0].tobytes() + bytes(7), f"V{payloads.dtype.itemsize + 7}")
    assert layout.ticks(padded).tobytes() == layout.ticks(payloads).tobytes()


def test_messages_shorter_than_their_schema_are_refused() -> None:
    with pytest.raises(StoredUnreadable, match="have 10 bytes, by their schema they have 45"):
        TickLayout(schema_of(OTHER)).ticks(np.zeros(1, "V10"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("int64 tick\nfloat64 time  # [s]\nstring words", "cannot be understood at 'string words'"),
        ("int64 tick\nfloat64 time\nfloat64[3] pose", r"cannot be understood at 'float64\[3\] pose'"),
        ("int64 tick\nfloat64 time\nuint8 tick", "cannot be understood at 'uint8 tick'"),
        ("int64 tick\nfloat64 base_pose_x", "have no mission.time"),
        ("", "have no mission.tick and no mission.time"),
    ],
)
def test_a_schema_that_cannot_be_read_is_said(text: str, message: str) -> None:
    with pytest.raises(StoredUnreadable, match=message):
        TickLayout(_schema(text))


def test_comments_and_units_are_read() -> None:
    layout = TickLayout(
        _schema("# One tick.\n\nint64 tick\nfloat64 time # [s] of the mission\nfloat32 heat  # [J/(s m)]")
    )
    assert layout.further == (StoredColumn("heat", "f4", "J/(s m)"),)


def test_a_log_without_ticks_is_laid_out_as_today() -> None:
    contents = Contents()
    assert layout_in(contents).absent == ()
    contents.schemas[1] = _schema("int64 tick\nfloat64 time")
    contents.channels[TICK_CHANNEL] = Channel(
        id=TICK_CHANNEL, topic="/becalm/tick", message_encoding="cdr", metadata={}, schema_id=1
    )
    assert len(layout_in(contents).absent) == len(COLUMNS) - 2


def test_payloads_of_today_are_as_long_as_their_schema_says() -> None:
    values = {field_name(column): np.zeros(1) for column in COLUMNS}
    assert TickLayout(tick_schema()).packed(values, 1).dtype.itemsize == CDR_TICK.itemsize
