"""What no text can hold and what JSON can say in two ways, wherever in a request it stands."""

from __future__ import annotations

import json

import pytest

from server.edge import text_checks
from server.edge.text_checks import DEEPEST, LONGEST_NAME, LONGEST_TEXT, fault_of_address, fault_of_body


@pytest.mark.parametrize(
    ("body", "field", "words"),
    [
        (r'{"token": "\ud800"}', "token", "surrogate"),
        (r'{"notes": [{"text": "a"}, {"text": "x\udfff"}]}', "notes.1.text", "surrogate"),
        (r'{"a": {"\ud800": 1}}', r"a.\ud800", "surrogate"),
        (r'{"a": "\u0000"}', "a", "NUL"),
        (r'{"a\u0000": 1}', r"a\x00", "NUL"),
        ('{"seed": 1, "seed": 2}', "", "'seed' is given twice"),
        ('{"a": {"b": 1, "b": 1}}', "a", "twice"),
        ('{"a": NaN}', "a", "NaN"),
        ('{"a": [-Infinity]}', "a.0", "Infinity"),
        ('{"a": 1e999}', "a", "1e999"),
        (json.dumps({"a": 2**63}), "a", "integers"),
        ('{"a": ' + "9" * 5000 + "}", "a", "integers"),
        (json.dumps({"a": "x" * (LONGEST_TEXT + 1)}), "a", str(LONGEST_TEXT)),
        (json.dumps({"x" * (LONGEST_NAME + 1): 1}), None, str(LONGEST_NAME)),
        ('{"a":' * (DEEPEST + 2) + "1" + "}" * (DEEPEST + 2), "", "levels"),
        ("[" * 100_000 + "]" * 100_000, "", "levels"),
        ("[" * 300_000, "", "levels"),
        (json.dumps([0] * 60_000), "", "values"),
    ],
)
def test_what_cannot_be_in_a_body_is_named(body, field, words):
    fault = fault_of_body(body.encode())
    assert words in fault.message
    assert field is None or fault.field == field
    assert len(fault.field) + len(fault.message) < 400


@pytest.mark.parametrize(
    "body",
    ["{}", "null", '"\\ud83d\\ude00 \\n é"', json.dumps({"a": -(2**63) + 1, "b": 1e308, "c": [[]]}), "{", "", "[1,]"],
)
def test_all_else_is_the_operations_to_judge(body):
    assert fault_of_body(body.encode()) is None


@pytest.mark.parametrize("body", [b"\xff\xfe{\x00}\x00", b'{"a": "\xed\xa0\x80"}', b'"\x80"'])
def test_a_body_is_utf_8(body):
    assert "UTF-8" in fault_of_body(body).message
    assert fault_of_body(b"\xef\xbb\xbf{}") is None


def address(path=b"/api/v1/runs", query=b"", headers=()):
    return {"raw_path": path, "query_string": query, "headers": list(headers)}


@pytest.mark.parametrize(
    ("scope", "field"),
    [
        (address(query=b"text=%ed%a0%80"), "text"),
        (address(query=b"limit=1&text=%ff"), "text"),
        (address(query=b"text=%00"), "text"),
        (address(query=b"text=\xff"), "text"),
        (address(query=b"%ff=1"), "\ufffd"),
        (address(query=b"cursor=" + b"x" * 5000), "cursor"),
        (address(path=b"/api/v1/runs/%ed%a0%80"), "path"),
        (address(path=b"/api/v1/presets/a%00b"), "path"),
        (address(headers=[(b"idempotency-key", b"\xed\xa0\x80")]), "idempotency-key"),
        (address(headers=[(b"if-match", b"a\x01")]), "if-match"),
    ],
)
def test_what_cannot_be_in_an_address_or_a_header_is_named(scope, field):
    assert fault_of_address(scope).field == field


def test_an_address_may_be_written_in_any_language():
    fine = address("/api/v1/presets/weich%20é".encode(), b"text=%C3%A9+x&y&=&a=%zz", [(b"cookie", b"\xff")])
    assert fault_of_address(fine) is None


def test_the_largest_body_takes_no_time_to_speak_of(monkeypatch):
    monkeypatch.setattr(text_checks, "MOST_VALUES", 10**9)
    pairs = ",".join(f'"{each}":1' for each in range(80_000))
    assert fault_of_body(("{" + pairs + "}").encode()) is None
    assert "twice" in fault_of_body(("{" + pairs + ',"79999":1}').encode()).message
