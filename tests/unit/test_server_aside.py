"""Work beside the service: what it gives and refuses, its bounds, and that it ends with who asked."""

from __future__ import annotations

import asyncio
import os
import signal
import time

import pytest

from server.errors import ServiceBusy
from server.process import aside
from server.process.aside import Aside, PiecesLost
from sim.errors import RunNotFound

PATIENCE = 120.0
"""Bound on every wait [s]."""


def refuse():
    raise RunNotFound("run x is not here", tip="GET /runs lists them")


def die():
    os.kill(os.getpid(), signal.SIGKILL)


def wait_until(path):
    while not path.exists():
        time.sleep(0.01)
    return path.name


def niceness():
    return os.nice(0)


def counted(count):
    for number in range(count):
        yield b"%06d" % number


def refused_pieces():
    raise RunNotFound("run x is not here")
    yield b""


def dying_pieces():
    yield b"a"
    die()


def told_pieces(path):
    """Endless; tells in a file how many pieces were made."""
    number = 0
    while True:
        number += 1
        path.write_text(str(number))
        yield b"x" * 100_000


@pytest.fixture
async def beside():
    beside = Aside()
    yield beside
    beside.shutdown()


async def until(fits):
    async with asyncio.timeout(PATIENCE):
        while not fits():
            await asyncio.sleep(0.01)


class TestAnswers:
    async def test_come_from_another_process_that_gives_way(self, beside):
        assert await beside.answer(os.getpid) != os.getpid()
        assert await beside.answer(niceness) == os.nice(0) + aside.NICENESS

    async def test_a_refusal_is_the_one_of_who_refuses(self, beside):
        with pytest.raises(RunNotFound, match="run x is not here") as refused:
            await beside.answer(refuse)
        assert refused.value.tip == "GET /runs lists them"

    async def test_a_process_that_is_lost_costs_who_asked_and_nobody_after(self, beside):
        with pytest.raises(ServiceBusy, match="lost"):
            await beside.answer(die)
        assert await beside.answer(len, "abc") == 3

    async def test_more_than_may_wait_are_asked_to_come_again(self, beside, monkeypatch, tmp_path):
        monkeypatch.setattr(aside, "WAITING", 2)
        gate = tmp_path / "gate"
        asked = [asyncio.create_task(beside.answer(wait_until, gate)) for _ in range(aside.ANSWERS_AT_ONCE + 2)]
        await until(lambda: beside.waiting == 2)
        with pytest.raises(ServiceBusy, match="2 requests"):
            await beside.answer(len, "abc")
        gate.touch()
        assert await asyncio.gather(*asked) == ["gate"] * 4
        assert beside.waiting == 0


class TestStreams:
    async def test_give_every_piece_in_its_order(self, beside):
        stream = await beside.stream(counted, 1000)
        assert [piece async for piece in stream] == list(counted(1000))
        stream.close()

    async def test_nothing_is_a_stream_too(self, beside):
        stream = await beside.stream(counted, 0)
        assert [piece async for piece in stream] == []
        stream.close()

    async def test_a_refusal_comes_before_anything_is_sent(self, beside):
        with pytest.raises(RunNotFound):
            await beside.stream(refused_pieces)
        assert [piece async for piece in await beside.stream(counted, 1)] == [b"000000"]

    async def test_what_is_cut_off_is_not_taken_for_whole(self, beside):
        stream = await beside.stream(dying_pieces)
        with pytest.raises(PiecesLost):
            _ = [piece async for piece in stream]
        stream.close()

    async def test_who_takes_nothing_stops_it_and_closing_ends_it(self, beside, tmp_path):
        made = tmp_path / "made"
        stream = await beside.stream(told_pieces, made)
        await until(lambda: made.exists() and made.read_text())
        process = stream._process
        assert int(made.read_text()) < 10
        stream.close()
        await asyncio.to_thread(process.join, PATIENCE)
        assert int(made.read_text()) < 10
        assert process.exitcode != 0

    async def test_one_that_is_just_being_started_is_ended_too(self, beside, monkeypatch, tmp_path):
        start = aside.CONTEXT.Process.start

        def started_while_the_service_ends(process):
            beside.end_soon()
            start(process)

        monkeypatch.setattr(aside.CONTEXT.Process, "start", started_while_the_service_ends)
        with pytest.raises(ServiceBusy):
            await beside.stream(told_pieces, tmp_path / "told")

    async def test_a_place_is_free_again_once_closed(self, beside, tmp_path):
        open_ones = [await beside.stream(told_pieces, tmp_path / str(each)) for each in range(aside.STREAMS_AT_ONCE)]
        following = asyncio.create_task(beside.stream(counted, 1))
        await until(lambda: beside.waiting == 1)
        open_ones[0].close()
        open_ones[0].close()  # once more frees no other
        assert [piece async for piece in await following] == [b"000000"]
        for each in open_ones:
            each.close()
