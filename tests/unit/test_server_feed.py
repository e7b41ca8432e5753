"""Subscribers: bounded, at their own rate, deaf ones forgotten."""

from __future__ import annotations

import asyncio

import pytest

from server.feed import CAPACITY, UNACKNOWLEDGED_LIMIT, Feed, Frame, Subscriber

RATE = 60.0


def _snapshot(tick: int) -> Frame:
    return Frame("snapshot", str(tick), tick)


async def _drained(subscriber: Subscriber) -> list[str]:
    texts = []
    try:
        async with asyncio.timeout(0.01):
            while True:
                texts.append((await subscriber.next()).text)
    except TimeoutError:
        return texts


async def test_slow_subscriber_loses_the_oldest():
    subscriber = Subscriber(RATE)
    for tick in range(CAPACITY + 10):
        subscriber.offer(_snapshot(tick), tick / RATE)
    texts = await _drained(subscriber)
    assert len(texts) == CAPACITY
    assert texts[0] == "10"
    assert texts[-1] == str(CAPACITY + 9)


@pytest.mark.parametrize("rate", [5.0, 20.0, 30.0, 60.0])
async def test_rate(rate):
    subscriber = Subscriber(rate)
    sent = 0
    for tick in range(120):
        subscriber.offer(_snapshot(tick), tick / RATE)
        sent += len(subscriber._frames)
        subscriber._frames.clear()
    assert sent == pytest.approx(2 * rate, abs=2)


async def test_events_are_sent_at_any_rate():
    subscriber = Subscriber(1.0)
    for tick in range(10):
        subscriber.offer(Frame("event", str(tick)), tick / RATE)
    assert len(await _drained(subscriber)) == 10


async def test_one_who_stops_acknowledging_is_sent_no_snapshots_until_it_does():
    subscriber = Subscriber(RATE)
    subscriber.acknowledge(-1)
    for tick in range(UNACKNOWLEDGED_LIMIT + 50):
        subscriber.offer(_snapshot(tick), tick / RATE)
        await _take_what_waits(subscriber)
    assert not subscriber._frames
    subscriber.offer(_snapshot(999), 999.0)
    assert not subscriber._frames
    subscriber.acknowledge(UNACKNOWLEDGED_LIMIT)
    subscriber.offer(_snapshot(1000), 1000.0)
    assert (await subscriber.next()).tick == 1000


async def _take_what_waits(subscriber: Subscriber) -> None:
    while subscriber._frames:
        await subscriber.next()


async def test_a_reset_forgets_what_was_not_acknowledged():
    subscriber = Subscriber(RATE)
    subscriber.acknowledge(-1)
    for tick in range(UNACKNOWLEDGED_LIMIT):
        subscriber.offer(_snapshot(tick), tick / RATE)
        await _take_what_waits(subscriber)
    subscriber.offer(Frame("reset", "reset"), 100.0)
    subscriber.offer(_snapshot(0), 101.0)
    assert await _drained(subscriber) == ["reset", "0"]


async def test_feed_reaches_every_subscriber_from_another_thread():
    feed = Feed()
    feed.attach(asyncio.get_running_loop())
    watchers = [feed.subscribe(RATE) for _ in range(3)]
    await asyncio.to_thread(feed.begin, "20200101T000000000-abcdef")
    async with asyncio.timeout(10):
        assert {(await watcher.next()).kind for watcher in watchers} == {"reset"}
    feed.unsubscribe(watchers[0])
    await asyncio.to_thread(feed.begin, "20200101T000000000-abcdef")
    async with asyncio.timeout(10):
        await watchers[1].next()
    assert not watchers[0]._frames


async def test_snapshots_from_before_a_reset_hold_nobody_up_after_it():
    """What waited when the mission began anew is sent too, but is never acknowledged by the new mission's ticks."""
    subscriber = Subscriber(RATE)
    subscriber.offer(_snapshot(10_000), 0.0)
    await subscriber.next()
    subscriber.acknowledge(10_000)
    subscriber.offer(_snapshot(10_001), 1.0)
    subscriber.offer(Frame("reset", "reset", 0), 1.0)
    sent = []
    for tick in range(2 * UNACKNOWLEDGED_LIMIT):
        subscriber.offer(_snapshot(tick), 2.0 + tick / RATE)
        sent += await _drained(subscriber)
        subscriber.acknowledge(tick)
    assert sent[-1] == str(2 * UNACKNOWLEDGED_LIMIT - 1)
