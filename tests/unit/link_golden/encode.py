"""Writes golden.json: messages of the link as bytes, by an encoder of a few lines that shares no code with Becalm.

CDR as the OMG specifies it (formal/02-06-51, 15.3), little endian: four bytes of encapsulation header, then every
number aligned to its own size from there on; strings and sequences begin with their length, strings end with a zero.
Run it from anywhere: python tests/unit/link_golden/encode.py
"""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path

NAMES = [f"{arm}_joint_{number}" for arm in ("left", "right") for number in (1, 2, 3)]


class Cdr:
    def __init__(self) -> None:
        self.body = b""

    def put(self, form: str, *values: float) -> Cdr:
        size = struct.calcsize(form)
        for value in values:
            self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + form, value)
        return self

    def text(self, words: str) -> Cdr:
        raw = words.encode() + b"\0"
        self.put("I", len(raw))
        self.body += raw
        return self

    def header(self, stamp: int, frame: str) -> Cdr:
        return self.put("i", stamp // 10**9).put("I", stamp % 10**9).text(frame)

    def doubles(self, *values: float) -> Cdr:
        return self.put("I", len(values)).put("d", *values)

    def names(self) -> Cdr:
        self.put("I", len(NAMES))
        for name in NAMES:
            self.text(name)
        return self

    def hex(self) -> str:
        return (b"\x00\x01\x00\x00" + self.body).hex()


STAMP = 1_764_000_000_123_456_789
ANGLES = [0.5, -1.25, -1.5, -0.5, 1.25, 1.5]
RATES = [0.01, -0.02, 0.03, -0.04, 0.05, -0.06]

QUARTER_TURN = (math.sin(math.pi / 4), math.cos(math.pi / 4))

GOLDEN = {
    "joint_states": Cdr().header(STAMP, "testbed.1f").names().doubles(*ANGLES).doubles(*RATES).doubles().hex(),
    "joint_command": Cdr().header(STAMP, "a1b2c3.1@testbed.1f").names().doubles().doubles(*RATES).doubles().hex(),
    "wrench": Cdr().header(STAMP, "left_hand").put("d", 0.25, -0.75, 0, 0, 0, 0.125).hex(),
    "pose": Cdr().header(STAMP, "world").put("d", 0.5, -0.25, 0, 0, 0, *QUARTER_TURN).hex(),
    "twist": Cdr().header(STAMP, "world").put("d", 0.5, -0.25, 0, 0, 0, 1.5).hex(),
    "call": Cdr().header(STAMP, "a1b2c3.1@testbed.1f").hex(),
    "echo": Cdr().header(STAMP, "testbed.1f").put("i", 17).put("I", 250_000_000).text("a1b2c3.1@testbed.1f").hex(),
    "report": Cdr().header(STAMP, "").put("I", 1).put("b", 1).text("stop").text("why not").text("testbed.1f")
    .put("I", 2).text("session").text("a1b2c3.1@testbed.1f").text("stamp").text("17").hex(),
}  # fmt: skip

if __name__ == "__main__":
    Path(__file__).with_name("golden.json").write_text(json.dumps(GOLDEN, indent=1) + "\n")
