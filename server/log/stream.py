"""An MCAP file that grows by whole chunks, and what its summary holds.

Records come from the `mcap` package, but for messages and their indexes: those are filled by numpy, a thousand at
once, because a headless run gives 100 000 ticks a second (docs/decisions/0006-logs.md).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple, Protocol

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from server.versions import becalm_version

MAGIC = b"\x89MCAP0\r\n"
COMPRESSION = "zstd"
DRAFT_BYTES = 2**20
"""Memory that a chunk is drafted in at first; it grows with the longest. Fresh memory for each would cost as much."""

COMPRESSION_LEVEL = 1
"""Higher levels save a tenth of the size for twice the time."""

Bytes = np.ndarray[Any, np.dtype[Any]]

_INDEX_HEAD = struct.Struct("<BQHI")
INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])


class ByteSink(Protocol):
    """Whatever takes bytes in order: a file, or the pieces of a download."""

    def write(self, content: bytes, /) -> Any:
        """Take them all, or raise."""


@cache
def message_dtype(payload: np.dtype[Any]) -> np.dtype[Any]:
    """The layout of a message record whose payload is always of that type."""
    return np.dtype(
        [
            ("opcode", "u1"),
            ("length", "<u8"),
            ("channel", "<u2"),
            ("sequence", "<u4"),
            ("log_time", "<u8"),
            ("publish_time", "<u8"),
            ("data", payload),
        ]
    )


def encoded(*records: McapRecord) -> bytes:
    """Records as they stand in a file."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    content: bytes = builder.end()  # type: ignore[no-untyped-call]
    return content


def _no_statistics() -> Statistics:
    return Statistics(
        attachment_count=0,
        channel_count=0,
        channel_message_counts={},
        chunk_count=0,
        message_count=0,
        message_end_time=0,
        message_start_time=0,
        metadata_count=0,
        schema_count=0,
    )


@dataclass
class Contents:
    """What stands in a file: enough to write its summary."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    chunks: list[ChunkIndex] = field(default_factory=list)
    attachments: list[AttachmentIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    statistics: Statistics = field(default_factory=_no_statistics)

    def count_chunk(self, index: ChunkIndex, counts: Mapping[int, int]) -> None:
        """Take note of a chunk with that many messages of each channel."""
        known, total = self.statistics, sum(counts.values())
        if total:
            first = index.message_start_time
            known.message_start_time = min(known.message_start_time, first) if known.message_count else first
            known.message_end_time = max(known.message_end_time, index.message_end_time)
        known.message_count += total
        for channel, count in counts.items():
            known.channel_message_counts[channel] = known.channel_message_counts.get(channel, 0) + count
        self.chunks.append(index)

    def ending(self, position: int) -> bytes:
        """Everything that follows the data when they end at that byte: summary, footer, magic."""
        self._count()
        end = encoded(DataEnd(0))
        start = position + len(end)
        summary, offsets = bytearray(), []
        for opcode, group in self._groups():
            content = encoded(*group)
            if content:
                offsets.append(SummaryOffset(opcode, start + len(summary), len(content)))
            summary += content
        offset_start = start + len(summary)
        summary += encoded(*offsets)
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        footer = encoded(Footer(start, offset_start, zlib.crc32(head, zlib.crc32(summary))))
        return end + bytes(summary) + footer + MAGIC

    def _count(self) -> None:
        known = self.statistics
        known.schema_count, known.channel_count = len(self.schemas), len(self.channels)
        known.chunk_count = len(self.chunks)
        known.attachment_count, known.metadata_count = len(self.attachments), len(self.metadata)

    def _groups(self) -> list[tuple[Opcode, list[Any]]]:
        return [
            (Opcode.SCHEMA, list(self.schemas.values())),
            (Opcode.CHANNEL, list(self.channels.values())),
            (Opcode.STATISTICS, [self.statistics]),
            (Opcode.CHUNK_INDEX, self.chunks),
            (Opcode.ATTACHMENT_INDEX, self.attachments),
            (Opcode.METADATA_INDEX, self.metadata),
        ]


class _Placed(NamedTuple):
    """Messages of one channel in the chunk under way."""

    channel: int
    entries: Bytes
    """Array of `INDEX_ENTRY`."""


class McapStream:
    """Writes one MCAP file from its first byte on. A chunk reaches the sink whole, with its indexes, in one write."""

    def __init__(self, sink: ByteSink) -> None:
        self._sink = sink
        self._compressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)
        self._draft = np.empty(DRAFT_BYTES, np.uint8)
        self._placed: list[_Placed] = []
        self.pending = 0
        """Bytes of messages that wait for their chunk to be closed."""
        self.position = 0
        self.contents = Contents()
        self._write(MAGIC + encoded(Header(profile="ros2", library=f"becalm {becalm_version()}")))

    def channel(self, topic: str, message_encoding: str, schema: Schema, metadata: Mapping[str, str]) -> int:
        """Open a channel; its number. The schema's own number is given here."""
        contents = self.contents
        known = next((each for each in contents.schemas.values() if each.name == schema.name), None)
        if known is None:
            known = Schema(id=len(contents.schemas) + 1, name=schema.name, encoding=schema.encoding, data=schema.data)
            contents.schemas[known.id] = known
            self._write(encoded(known))
        number = len(contents.channels) + 1
        channel = Channel(
            id=number, topic=topic, message_encoding=message_encoding, schema_id=known.id, metadata=dict(metadata)
        )
        contents.channels[number] = channel
        self._write(encoded(channel))
        return number

    def add(self, channel: int, sequences: Bytes, log_times: Bytes, payloads: Bytes) -> Bytes:
        """Put messages of one channel into the chunk under way.

        Args:
            channel: its number.
            sequences: numbers of the messages, shape (messages,).
            log_times: shape (messages,) [ns].
            payloads: of one void type, which is copied byte by byte; shape (messages,), or () for one of all.

        Returns:
            The payloads as they stand in the chunk, shape (messages,); what is changed in them until the next call
            will be written.

        """
        records = self._drafted(len(log_times), message_dtype(payloads.dtype))
        records["opcode"] = Opcode.MESSAGE
        records["length"] = records.dtype.itemsize - 9
        records["channel"], records["sequence"] = channel, sequences
        records["log_time"] = records["publish_time"] = log_times
        data: Bytes = records["data"]
        data[:] = payloads
        if len(records):
            entries = np.empty(len(records), INDEX_ENTRY)
            entries["log_time"] = log_times
            entries["offset"] = self.pending + records.dtype.itemsize * np.arange(len(records))
            self._placed.append(_Placed(channel, entries))
            self.pending += records.nbytes
        return data

    def _drafted(self, count: int, layout: np.dtype[Any]) -> Bytes:
        """Room for so many records after those that wait."""
        end = self.pending + count * layout.itemsize
        if end > len(self._draft):
            longer = np.empty(max(end, 2 * len(self._draft)), np.uint8)
            longer[: self.pending] = self._draft[: self.pending]
            self._draft = longer
        return self._draft[self.pending : end].view(layout)

    def add_one(self, channel: int, log_time: int, content: bytes) -> None:
        """Put a single message into the chunk under way."""
        payload = np.array([content], f"V{len(content)}")
        self.add(channel, np.zeros(1, np.uint32), np.array([log_time], np.uint64), payload)

    def close_chunk(self) -> None:
        """Write what waits as a chunk with its indexes, if anything does."""
        if not self.pending:
            return
        data, placed = self._draft[: self.pending].data, self._placed
        self._placed, self.pending = [], 0
        by_channel = {
            number: np.concatenate([each.entries for each in placed if each.channel == number])
            for number in dict.fromkeys(each.channel for each in placed)
        }
        first = min(int(entries["log_time"].min()) for entries in by_channel.values())
        last = max(int(entries["log_time"].max()) for entries in by_channel.values())
        compressed = self._compressor.compress(data)
        chunk = encoded(
            Chunk(
                compression=COMPRESSION,
                data=compressed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=zlib.crc32(data),
                uncompressed_size=len(data),
            )
        )
        indexes, offsets = bytearray(), {}
        for number, entries in by_channel.items():
            offsets[number] = self.position + len(chunk) + len(indexes)
            indexes += _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + entries.nbytes, number, entries.nbytes)
            indexes += entries.tobytes()
        index = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=self.position,
            compression=COMPRESSION,
            compressed_size=len(compressed),
            message_end_time=last,
            message_index_length=len(indexes),
            message_index_offsets=offsets,
            message_start_time=first,
            uncompressed_size=len(data),
        )
        self._write(chunk + bytes(indexes))
        self.contents.count_chunk(index, {number: len(entries) for number, entries in by_channel.items()})

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        content = encoded(Metadata(name=name, metadata=dict(values)))
        self.contents.metadata.append(MetadataIndex(offset=self.position, length=len(content), name=name))
        self._write(content)

    def attach(self, name: str, media_type: str, time: int, data: bytes) -> None:
        """Write an attachment."""
        content = encoded(Attachment(create_time=time, log_time=time, name=name, media_type=media_type, data=data))
        index = AttachmentIndex(
            offset=self.position,
            length=len(content),
            create_time=time,
            log_time=time,
            data_size=len(data),
            name=name,
            media_type=media_type,
        )
        self.contents.attachments.append(index)
        self._write(content)

    def end(self) -> None:
        """Write the last chunk and the summary; the file is complete."""
        self.close_chunk()
        self._write(self.contents.ending(self.position))

    def _write(self, content: bytes) -> None:
        self._sink.write(content)
        self.position += len(content)
