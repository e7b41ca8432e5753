"""What a log truly holds: read from its summary if it was closed, else record by record up to the last whole chunk."""

from __future__ import annotations

import io
import logging
import os
import struct
import zlib
from collections.abc import Iterator
from functools import cache
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Footer,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

from server.log.stream import COMPRESSION, INDEX_ENTRY, MAGIC, Bytes, Contents, message_dtype

_RECORD_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQII")
_INDEX_HEAD = struct.Struct("<HI")
_MESSAGE_HEAD = message_dtype(np.dtype("V1")).itemsize - 1 - _RECORD_HEAD.size
_ALIKE = _RECORD_HEAD.size + 2
"""Bytes by which a message is known as of one length and channel with another."""
_FOOTER_SIZE = _RECORD_HEAD.size + 20 + len(MAGIC)
_LARGEST_RECORD = 2**31

log = logging.getLogger(__name__)


class Scanned(NamedTuple):
    """A log as it was found."""

    contents: Contents
    intact: int
    """Bytes from the start that are whole records."""
    closed: bool
    """Whether it ends with its summary."""


def scan(file: BinaryIO) -> Scanned:
    """What the file holds. A torn or damaged one is read as far as it is whole; nothing is raised."""
    size = file.seek(0, os.SEEK_END)
    try:
        contents = _summary(file, size)
    except Exception:  # bytes of any kind may stand where a summary should
        contents = None
    if contents is not None:
        return Scanned(contents, size, True)
    walker = _Walker(file, size)
    try:
        walker.walk()
    except Exception:
        log.warning("a log is damaged after %d bytes", walker.intact, exc_info=True)
    return Scanned(walker.contents, walker.intact, False)


def chunk_data(file: BinaryIO, index: ChunkIndex) -> bytes:
    """The records within a chunk; empty, and a warning, if it is damaged."""
    try:
        file.seek(index.chunk_start_offset + _RECORD_HEAD.size)
        content = file.read(index.chunk_length - _RECORD_HEAD.size)
        return _unpacked(content)
    except Exception as error:
        log.warning("a chunk at %d is damaged and left out: %s", index.chunk_start_offset, error)
        return b""


def payloads(data: bytes, channel: int) -> Bytes:
    """The payloads of a channel's messages within a chunk, as long as the first of them; others are left out."""
    found: list[Bytes] = []
    place = 0
    while place + _RECORD_HEAD.size <= len(data):
        opcode, length = _RECORD_HEAD.unpack_from(data, place)
        if opcode != Opcode.MESSAGE or length < _MESSAGE_HEAD:
            place += _RECORD_HEAD.size + length
            continue
        records = _run(data, place, _message_dtype(length - _MESSAGE_HEAD))
        if len(records) == 0:  # cut off
            break
        place += records.nbytes
        if records["channel"][0] == channel and (not found or found[0].dtype == records["data"].dtype):
            found.append(records["data"])
    if len(found) == 1:
        return found[0]
    return np.concatenate(found) if found else np.empty(0, "V1")


@cache
def _message_dtype(size: int) -> np.dtype[Any]:
    """Of a message whose payload has so many bytes."""
    return message_dtype(np.dtype(f"V{size}"))


def _run(data: bytes, place: int, layout: np.dtype[Any]) -> Bytes:
    """The message at that place, and those of the same channel and length that follow it without another between."""
    head, size = data[place : place + _ALIKE], layout.itemsize
    most, count, window = (len(data) - place) // size, 1, 8
    # Logs of 0.1.0 have one message of each channel by turns: those must not pay for looking at many.
    while count < most and data.startswith(head, place + count * size):
        following = np.frombuffer(data, layout, min(window, most - count), place + count * size)
        alike = (following["length"] == layout.itemsize - _RECORD_HEAD.size) & (following["opcode"] == Opcode.MESSAGE)
        alike &= following["channel"] == int.from_bytes(head[_RECORD_HEAD.size :], "little")
        if not alike.all():
            count += int(np.argmin(alike))
            break
        count, window = count + len(following), 8 * window
    return np.frombuffer(data, layout, min(count, most), place)


def _unpacked(chunk: bytes) -> bytes:
    _, _, size, crc, name = _CHUNK_HEAD.unpack_from(chunk)
    start = _CHUNK_HEAD.size + name + 8
    compression = chunk[_CHUNK_HEAD.size : start - 8].decode()
    if compression != COMPRESSION:
        raise ValueError(f"compression {compression!r} is unknown")
    data = zstandard.decompress(chunk[start:], max_output_size=size)
    if zlib.crc32(data) != crc:
        raise ValueError("its checksum does not fit")
    return data


def _summary(file: BinaryIO, size: int) -> Contents | None:
    """What the summary says; None if the file does not end with one."""
    if size < _FOOTER_SIZE + len(MAGIC):
        return None
    file.seek(size - _FOOTER_SIZE)
    ending = file.read(_FOOTER_SIZE)
    if not ending.endswith(MAGIC) or ending[0] != Opcode.FOOTER:
        return None
    footer = Footer.read(ReadDataStream(io.BytesIO(ending[_RECORD_HEAD.size :])))
    file.seek(footer.summary_start)
    summary = file.read(size - _FOOTER_SIZE - footer.summary_start)
    head = ending[: _RECORD_HEAD.size + 16]
    if zlib.crc32(head, zlib.crc32(summary)) != footer.summary_crc:
        return None
    contents = Contents()
    for opcode, record in _records(summary):
        _take(contents, opcode, record)
    return contents


def _records(content: bytes) -> Iterator[tuple[int, bytes]]:
    place = 0
    while place < len(content):
        opcode, length = _RECORD_HEAD.unpack_from(content, place)
        place += _RECORD_HEAD.size
        yield opcode, content[place : place + length]
        place += length


def _take(contents: Contents, opcode: int, record: bytes) -> None:
    """Add one record of a summary."""
    stream = ReadDataStream(io.BytesIO(record))
    if opcode == Opcode.SCHEMA:
        schema = Schema.read(stream)
        contents.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        channel = Channel.read(stream)
        contents.channels[channel.id] = channel
    elif opcode == Opcode.STATISTICS:
        contents.statistics = Statistics.read(stream)
    elif opcode == Opcode.CHUNK_INDEX:
        contents.chunks.append(ChunkIndex.read(stream))
    elif opcode == Opcode.ATTACHMENT_INDEX:
        contents.attachments.append(AttachmentIndex.read(stream))
    elif opcode == Opcode.METADATA_INDEX:
        contents.metadata.append(MetadataIndex.read(stream))


class _Walker:
    """Goes through a file that was never closed; `contents` and `intact` are right at every moment."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        self._file, self._size = file, size
        self.contents = Contents()
        self.intact = 0

    def walk(self) -> None:
        """Go as far as the records are whole."""
        self._file.seek(0)
        if self._file.read(len(MAGIC)) != MAGIC:
            return
        self.intact = len(MAGIC)
        while (head := self._head(self.intact)) is not None:
            opcode, length = head
            end = self.intact + _RECORD_HEAD.size + length
            if opcode == Opcode.CHUNK:
                if not self._take_chunk(end):
                    return
                continue
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return
            self._take_record(opcode, self._file.read(length), length)
            self.intact = end

    def _head(self, place: int) -> tuple[int, int] | None:
        """Opcode and length of the record at that byte, if it is whole; the file stands at its content then."""
        self._file.seek(place)
        head = self._file.read(_RECORD_HEAD.size)
        if len(head) < _RECORD_HEAD.size:
            return None
        opcode, length = _RECORD_HEAD.unpack(head)
        whole = 0 < opcode <= Opcode.DATA_END and length < _LARGEST_RECORD
        return (opcode, length) if whole and place + _RECORD_HEAD.size + length <= self._size else None

    def _take_record(self, opcode: int, record: bytes, length: int) -> None:
        stream = ReadDataStream(io.BytesIO(record))
        if opcode == Opcode.ATTACHMENT:
            found = Attachment.read(stream)
            self.contents.attachments.append(
                AttachmentIndex(
                    offset=self.intact, length=_RECORD_HEAD.size + length, create_time=found.create_time,
                    log_time=found.log_time, data_size=len(found.data), name=found.name, media_type=found.media_type,
                )
            )  # fmt: skip
        elif opcode == Opcode.METADATA:
            name = Metadata.read(stream).name
            self.contents.metadata.append(MetadataIndex(offset=self.intact, length=9 + length, name=name))
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            _take(self.contents, opcode, record)

    def _take_chunk(self, end: int) -> bool:
        """Take a chunk with the indexes that follow it; False if it, or one of them, is not whole."""
        start = self.intact
        first, last, size, _, name = _CHUNK_HEAD.unpack(self._file.read(_CHUNK_HEAD.size))
        compressed = end - start - _RECORD_HEAD.size - _CHUNK_HEAD.size - name - 8
        place, offsets, counts = end, {}, {}
        while (head := self._head(place)) is not None and head[0] == Opcode.MESSAGE_INDEX:
            channel, length = _INDEX_HEAD.unpack(self._file.read(_INDEX_HEAD.size))
            offsets[channel], counts[channel] = place, length // INDEX_ENTRY.itemsize
            place += _RECORD_HEAD.size + head[1]
        index = ChunkIndex(
            chunk_length=end - start, chunk_start_offset=start, compression=COMPRESSION, compressed_size=compressed,
            message_start_time=first, message_end_time=last, message_index_length=place - end,
            message_index_offsets=offsets, uncompressed_size=size,
        )  # fmt: skip
        if place == self._size or self._head(place) is None:  # the last one: its indexes may have been cut off
            self._file.seek(start + _RECORD_HEAD.size)
            data = _unpacked(self._file.read(end - start - _RECORD_HEAD.size))
            if sum(counts.values()) != sum(opcode == Opcode.MESSAGE for opcode, _ in _records(data)):
                return False
        self.contents.count_chunk(index, counts)
        self.intact = place
        return True
