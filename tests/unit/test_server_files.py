"""Small files: replaced whole whoever writes at the same time, read so that any damage is said in words."""

from __future__ import annotations

import json
import os
import threading

import pytest

from server.errors import StoredUnreadable
from server.files import read_document, replace_file
from server.library.record import Remarks


def test_writers_at_once_leave_the_whole_content_of_one(tmp_path):
    path = tmp_path / "remarks.json"
    contents = [bytes([65 + number]) * 100_000 for number in range(8)]
    writers = [threading.Thread(target=replace_file, args=(path, content)) for content in contents]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert path.read_bytes() in contents
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_written_leaves_the_old_content_and_no_draft(tmp_path, monkeypatch):
    path = tmp_path / "remarks.json"
    path.write_text("old")
    monkeypatch.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        replace_file(path, b"new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_the_mode_is_that_of_the_first_moment(tmp_path):
    replace_file(tmp_path / "tokens.json", b"{}", mode=0o600)
    assert (tmp_path / "tokens.json").stat().st_mode & 0o777 == 0o600


DAMAGES = {
    "empty": (lambda path: path.write_bytes(b""), "EOF"),
    "no JSON": (lambda path: path.write_bytes(b"\x89PNG"), "damaged"),
    "no UTF-8": (lambda path: path.write_bytes(b'{"starred": "\xff"}'), "damaged"),
    "lone surrogate": (lambda path: path.write_bytes(b'{"notes": [{"text": "\\ud800"}]}'), "hex escape"),
    "deep": (lambda path: path.write_bytes(b'{"notes": ' + b"[" * 100_000), "recursion"),
    "of another type": (lambda path: path.write_bytes(b"[1]"), "damaged or of another version"),
    "unknown field": (lambda path: path.write_bytes(json.dumps({"a\n" + "b" * 900: 1}).encode()), r"a\\nbbb"),
    "too large": (lambda path: os.truncate(os.open(path, os.O_CREAT | os.O_RDWR), 20_000_000), "more than"),
    "a folder": (lambda path: path.mkdir(), "not a regular file"),
    "a pipe": (os.mkfifo, "not a regular file"),
    "a dangling link": (lambda path: path.symlink_to("nowhere"), "leads nowhere"),
    "a looping link": (lambda path: path.symlink_to(path.name), "symbolic links"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_any_damage_is_told_in_one_short_line(tmp_path, damage):
    path = tmp_path / "remarks.json"
    spoil, says = DAMAGES[damage]
    spoil(path)
    with pytest.raises(StoredUnreadable, match=says) as told:
        read_document(path, Remarks)
    assert str(told.value).startswith("remarks.json ")
    assert len(str(told.value).splitlines()) == 1
    assert len(str(told.value)) < 300
    assert told.value.tip


def test_what_is_not_there_is_not_damaged(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_document(tmp_path / "remarks.json", Remarks)
