"""Subscribers: bounded, at their own rate, deaf ones forgotten."""

from __future__ import annotations

import asyncio
import json
from typing import Any, NamedTuple

import pytest

from server.mission.feed import CAPACITY, WINDOW, Feed, FeedMessage, Latest, Subscriber
from server.published import Control, PlantStatus
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.snapshot import Snapshot

RATE = 60.0


class _Snapshot(Latest):
    """A snapshot that is its tick's number and nothing else."""

    def __init__(self, tick: int, made_at: float) -> None:
        self.tick, self.made_at = tick, made_at

    @property
    def text(self) -> str:
        return str(self.tick)


def _snapshot(tick: int, made_at: float | None = None) -> Latest:
    return _Snapshot(tick, tick / RATE if made_at is None else made_at)


def _event(number: int) -> FeedMessage:
    return FeedMessage("event", f"event {number}")


async def _drained(subscriber: Subscriber) -> list[str]:
    texts = []
    try:
        async with asyncio.timeout(0.01):
            while True:
                texts.append((await subscriber.next()).text)
    except TimeoutError:
        return texts


async def test_who_is_slow_is_sent_the_newest_snapshot_only():
    subscriber = Subscriber(RATE)
    for tick in range(10):
        subscriber.offer(_snapshot(tick), tick / RATE)
    assert await _drained(subscriber) == ["9"]
    assert subscriber.lost == 9


async def test_a_snapshot_that_was_overtaken_is_never_sent():
    """Who joins is shown the latest, which may be newer than what is on its way to all."""
    subscriber = Subscriber(RATE)
    subscriber.show(_snapshot(31, made_at=2.0))
    assert await _drained(subscriber) == ["31"]
    subscriber.offer(_snapshot(0, made_at=1.9), 10.0)
    assert await _drained(subscriber) == []
    subscriber.offer(_snapshot(5, made_at=2.1), 20.0)  # a fork goes back in ticks, not in time
    assert await _drained(subscriber) == ["5"]


@pytest.mark.parametrize("rate", [5.0, 20.0, 30.0, 60.0])
async def test_rate(rate):
    subscriber = Subscriber(rate)
    sent = 0
    for tick in range(1, 121):
        subscriber.offer(_snapshot(tick), tick / RATE)
        sent += len(await _drained(subscriber)) if subscriber.waiting else 0
    assert sent == pytest.approx(2 * rate, abs=2)


async def test_events_keep_their_order_and_are_sent_at_any_rate():
    subscriber = Subscriber(1.0)
    for number in range(10):
        subscriber.offer(_event(number), number / RATE)
    assert await _drained(subscriber) == [f"event {number}" for number in range(10)]


async def test_events_are_bounded_and_what_was_missed_is_reported():
    subscriber = Subscriber(RATE)
    subscriber.offer(FeedMessage("reset", "reset"), 0.0)
    for number in range(CAPACITY + 10):
        subscriber.offer(_event(number), 0.0)
    texts = await _drained(subscriber)
    assert json.loads(texts[0]) == {"type": "missed", "events": 11}
    assert texts[1] == "reset"
    assert texts[-1] == f"event {CAPACITY + 9}"
    assert len(texts) == CAPACITY + 1


async def test_one_who_stops_acknowledging_is_sent_the_newest_as_soon_as_it_does():
    subscriber = Subscriber(RATE)
    subscriber.acknowledge(-1)
    sent = []
    for tick in range(50):
        subscriber.offer(_snapshot(tick), tick / RATE)
        sent += await _drained(subscriber) if tick < WINDOW + 3 else []
    assert sent == [str(tick) for tick in range(WINDOW)]
    subscriber.acknowledge(0)
    assert await _drained(subscriber) == ["49"]
    subscriber.offer(_event(1), 1.0)
    assert await _drained(subscriber) == ["event 1"]  # no snapshot holds an event up


async def test_a_reset_forgets_what_was_not_acknowledged_and_what_waits_of_the_old_run():
    subscriber = Subscriber(RATE)
    subscriber.acknowledge(-1)
    for tick in range(1, WINDOW + 3):
        subscriber.offer(_snapshot(tick), tick / RATE)
        await _take_what_waits(subscriber)
    subscriber.offer(FeedMessage("reset", "reset"), 100.0)
    subscriber.offer(_snapshot(0, made_at=100.0), 101.0)
    assert await _drained(subscriber) == ["reset", "0"]


async def _take_what_waits(subscriber: Subscriber) -> None:
    if subscriber.waiting:
        await _drained(subscriber)


async def test_a_snapshot_is_made_once_for_all_who_look_and_for_nobody_else():
    made = []

    class View(NamedTuple):
        flown: Any
        phase: Phase

        def snapshot(self) -> Snapshot:
            made.append(self.flown)
            return Mission(MissionConfig()).snapshot()

    plant = PlantStatus(running=True, speed=1.0, lateness=0.0, real_time_factor=1.0)
    of_service = {
        "made_at": "now", "service_time": 5.0, "robot": None, "run_id": "one", "configuration": "published",
        "plant": plant, "commands": {}, "control": Control(), "arming_needed": (), "armed": None, "problems": (),
    }  # fmt: skip
    latest = Latest(View(Mission(MissionConfig()).flown(), Phase.IDLE), of_service)  # type: ignore[arg-type]
    feed = Feed()
    feed.publish(latest)
    assert (latest.run_id, latest.phase, latest.tick, latest.made_at) == ("one", "idle", 0, 5.0)
    assert made == []
    assert json.loads(latest.text)["run_id"] == latest.snapshot.run_id == "one"
    assert latest.text == '{"type":"snapshot",' + latest.encoded[1:]
    assert len(made) == 1


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
    assert not watchers[0].waiting
