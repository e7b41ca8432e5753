"""`WS /telemetry`: snapshots at the rate that the client asks for, events, and the history on joining."""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
import time
from typing import Annotated, Any

from fastapi import APIRouter, Query, WebSocket, WebSocketDisconnect

from server.api.services import AskerDep, Services, ServicesDep
from server.mission.feed import Feed, Subscriber
from server.settings import TELEMETRY_RATE_LIMITS
from server.versions import becalm_version

SEND_TIME = 20.0
"""A client that takes nothing for this long is let go [s]; its queue has lost its oldest frames long before."""

PREPARING_PERIOD = 1.0
"""Wall time between two messages that the simulation is being prepared [s]."""

LARGEST_MESSAGE = 1024

router = APIRouter()


@router.websocket("/telemetry")
async def telemetry(
    websocket: WebSocket,
    services: ServicesDep,
    asker: AskerDep,
    rate: Annotated[float, Query()] = TELEMETRY_RATE_LIMITS[1],
) -> None:
    """Send until the client leaves or stops taking."""
    await websocket.accept()
    subscriber = services.feed.subscribe(_within_limits(rate), asker)
    sender = asyncio.create_task(_send(websocket, services, subscriber))
    receiver = asyncio.create_task(_receive(websocket, subscriber))
    try:
        await asyncio.wait((sender, receiver), return_when=asyncio.FIRST_COMPLETED)
    finally:
        services.feed.unsubscribe(subscriber)
        for task in (sender, receiver):
            task.cancel()
        await asyncio.gather(sender, receiver, return_exceptions=True)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await websocket.close()


async def _send(websocket: WebSocket, services: Services, subscriber: Subscriber) -> None:
    async def send(text: str) -> None:
        async with asyncio.timeout(SEND_TIME):
            await websocket.send_text(text)

    cut_off = services.feed.cut_off
    hello = {
        "version": becalm_version(),
        "rate": subscriber.rate,
        "service": services.feed.service,
        "service_time": time.monotonic(),
        "cut_off": cut_off and cut_off.model_dump(),
    }
    await send(json.dumps({"type": "hello", **hello}))
    await _send_until_ready(send, services)
    await _send_mission_so_far(send, services.feed, subscriber)
    while True:
        await send((await subscriber.next()).text)


async def _send_until_ready(send: Any, services: Services) -> None:
    while services.feed.latest is None:
        detail = str(services.loop.not_ready())
        await send(json.dumps({"type": "preparing", "status": services.loop.status, "message": detail}))
        await asyncio.sleep(PREPARING_PERIOD)


async def _send_mission_so_far(send: Any, feed: Feed, subscriber: Subscriber) -> None:
    await send('{"type":"history",' + feed.history.encoded() + "}")
    if feed.alarms is not None:
        await send(feed.alarms.text)
    if feed.latest is not None:
        subscriber.show(feed.latest)


async def _receive(websocket: WebSocket, subscriber: Subscriber) -> None:
    while (message := await websocket.receive())["type"] == "websocket.receive":
        _handle_message(message.get("text") or "", subscriber)


def _handle_message(text: str, subscriber: Subscriber) -> None:
    """Do what a client's message says; what is no such message is ignored."""
    try:
        message = json.loads(text[:LARGEST_MESSAGE])
        if message["type"] == "rate":
            subscriber.rate = _within_limits(float(message["rate"]))
        elif message["type"] == "ack":
            subscriber.acknowledge(int(message["tick"]))
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
        return


def _within_limits(rate: float) -> float:
    lowest, highest = TELEMETRY_RATE_LIMITS
    return min(max(rate, lowest), highest) if math.isfinite(rate) else highest
