"""What the console shows of the link; the body of `GET /api/v1/link`."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Literal

import numpy as np
from pydantic import Field

from server.link import contract
from server.link.contract import Channel
from server.link.reception import JUDGED, NEEDED, name_of
from server.link.reports import parse_count
from server.link.robot_link import RobotLink
from server.link.streams import HISTORY_STEP
from server.published import RobotData
from sim.snapshot import FrozenMessage

QUANTILES_OF = 10.0
"""Round trips of the last seconds that quantiles are taken of [s]."""


class StreamStatus(FrozenMessage):
    """How one of the robot's streams arrives; rate, jitter and loss over the last two seconds."""

    key: str = Field(description="Key expression", examples=["becalm/joint_states"])
    name: str = Field(description="For people", examples=["joint states"])
    message: str = Field(description="ROS 2 type", examples=["sensor_msgs/msg/JointState"])
    nominal_rate: float = Field(description="By the contract [Hz]")
    rate: float = Field(description="Arrivals a second [Hz]")
    age: float | None = Field(description="Since the last arrival [s]; null before the first")
    jitter: float | None = Field(description="Standard deviation of the delay [s]; null with fewer than two arrivals")
    loss: float | None = Field(description="Part that did not arrive, 0 to 1, by the stamps; null likewise")
    received: int = Field(description="Since the service began")
    lost: int = Field(description="Since the service began, by the stamps")
    needed: bool = Field(description="Whether the mission holds without it")
    late: bool = Field(description="Whether its age is beyond the deadline")
    refused: int = Field(description="Since the service began: came and was not believed")
    last_refusal: str = Field(description="Why; empty: none yet", examples=["not finite: force.x = nan"])
    refusal_age: float | None = Field(description="Since that [s]; null: none yet")


class RefusedMessages(FrozenMessage):
    """What came beside the streams and was not believed: modes, heartbeats that came back, acknowledgements."""

    key: str = Field(description="Key expression", examples=["becalm/robot/mode"])
    name: str = Field(description="For people", examples=["robot mode"])
    refused: int = Field(description="Since the service began")
    last_refusal: str = Field(description="Why")
    refusal_age: float = Field(description="Since that [s]")


class Quantiles(FrozenMessage):
    """Of a time over the last seconds."""

    p50: float = Field(description="Median [s]")
    p99: float = Field(description="99 % quantile [s]")


class RobotReport(FrozenMessage):
    """What the robot last reported of itself."""

    age: float = Field(description="Since it did [s]")
    mode: Literal["waiting", "following", "holding", "stopped"] | None = Field(
        description="waiting: nobody holds it; following: joint commands of its session; holding: heartbeat or joint "
        "commands were late; stopped: a STOP came; null: a word that the contract does not know"
    )
    why: str = Field(description="Of that mode; empty while it follows")
    contract: str = Field(description="Version that it speaks")
    session: str = Field(description="Which it follows; empty: none yet")
    tared: bool = Field(description="Whether its wrist sensors have been tared since it was started")
    commands: int = Field(description="Joint commands that it followed")
    refused: int = Field(description="Joint commands and requests that it refused, whoever sent them")
    last_refusal: str = Field(description="Who and why; empty: none yet")


class StopStatus(FrozenMessage):
    """The last STOP that went to the robot."""

    age: float = Field(description="Since it was sent [s]")
    acknowledged_after: float | None = Field(description="Until the robot's acknowledgement [s]; null: none yet")


class LatencyPoint(FrozenMessage):
    """The worst of a fifth of a second; null where none was."""

    ago: float = Field(description="How long ago [s]")
    round_trip: float | None = Field(description="Of a heartbeat [s]")
    command_age: float | None = Field(description="99 % quantile, as the robot reported it then [s]")


class LinkStatus(FrozenMessage):
    """The link as it is now. In simulation there is none: `plant` says so, and the rest is empty."""

    plant: Literal["simulation", "zenoh"]
    connected: bool = Field(description="Whether any other end is there, robot or router")
    endpoints: tuple[str, ...] = Field(description="Where the robot is looked for")
    contract: str = Field(description="Version that the console speaks")
    deadline: float | None = Field(description="Age at which a needed stream is late [s]")
    contact_threshold: float | None = Field(description="Wrist force that counts as contact [N]")
    session: str = Field(description="The console's own; empty: none yet")
    holder: str = Field(description="Session that the robot follows; empty: none, or not known")
    held: bool = Field(description="Whether the robot follows the console's own session")
    robot_identity: str = Field(description="Of the robot at the other end; empty: none was heard")
    other_robots: tuple[str, ...] = Field(description="Robots heard beside it: while there are any, nothing is flown")
    robot: RobotReport | None = Field(description="Null before the robot was heard")
    streams: tuple[StreamStatus, ...]
    refused_messages: tuple[RefusedMessages, ...] = Field(description="Of other messages of the robot's; empty: none")
    clock_offset: float | None = Field(description="Robot's clock less console's [s]; null before a round trip")
    round_trip: Quantiles | None = Field(description="Of a heartbeat to the robot and back")
    command_age: Quantiles | None = Field(
        description="From the joint state that a joint command answers to its arrival at the robot"
    )
    latency: tuple[LatencyPoint, ...] = Field(description="Of the last minute, the oldest first")
    stop: StopStatus | None = Field(description="Null: none was sent")
    problem: str | None = Field(description="Why the robot cannot be flown now; null: it can")


NO_LINK = LinkStatus(
    plant="simulation",
    connected=False,
    endpoints=(),
    contract=contract.VERSION,
    deadline=None,
    contact_threshold=None,
    session="",
    holder="",
    held=False,
    robot_identity="",
    other_robots=(),
    robot=None,
    streams=(),
    refused_messages=(),
    clock_offset=None,
    round_trip=None,
    command_age=None,
    latency=(),
    stop=None,
    problem=None,
)
"""In simulation."""


def status_of(link: RobotLink) -> LinkStatus:
    """The link as it is now; for any thread."""
    now = time.monotonic()
    settings, robot = link.settings, _robot(link, now)
    holder = robot.session if robot is not None else ""
    connected = link.connected
    return LinkStatus(
        plant="zenoh",
        connected=connected,
        endpoints=(*settings.transport.connect, *settings.transport.listen),
        contract=contract.VERSION,
        deadline=settings.deadline,
        contact_threshold=link.contact_threshold,
        session=link.session,
        holder=holder,
        held=bool(holder) and holder == link.session and robot is not None and robot.mode == "following",
        robot_identity=link.identity.robot,
        other_robots=link.identity.others(now),
        robot=robot,
        streams=tuple(_stream(link, channel, now) for channel in contract.STREAMS),
        refused_messages=tuple(_refused(link, now)),
        clock_offset=link.other_clock.offset,
        round_trip=_round_trip(link, now),
        command_age=_command_age(link),
        latency=_latency(link, now),
        stop=_stop(link, now),
        problem=_problem(link) if connected else "no other end of the link is connected",
    )


def _problem(link: RobotLink) -> str | None:
    """Why the robot cannot be flown, in words."""
    trouble = link.trouble()
    return None if trouble is None else trouble.message


def robot_data(link: RobotLink, now: float) -> RobotData:
    """How old what a mission needs of the robot is at that monotonic time [s]; for any thread."""
    ages = {name_of(channel): link.streams[channel.key].age(now) for channel in NEEDED}
    oldest = max(ages, key=lambda name: math.inf if (age := ages[name]) is None else age)
    return RobotData(silent_for=link.age(now), oldest=ages[oldest], stream=oldest)


def _stream(link: RobotLink, channel: Channel, now: float) -> StreamStatus:
    stream, refusals = link.streams[channel.key], link.reception.refusals[channel.key]
    rate, jitter, loss = stream.measured(now)
    age = stream.age(now)
    return StreamStatus(
        key=channel.key,
        name=name_of(channel),
        message=channel.message,
        nominal_rate=stream.rate,
        rate=rate,
        age=age,
        jitter=jitter,
        loss=loss,
        received=stream.received,
        lost=stream.lost,
        needed=channel in NEEDED,
        late=age is None or age > link.settings.deadline,
        refused=refusals.count,
        last_refusal=refusals.reason,
        refusal_age=refusals.age(now),
    )


def _refused(link: RobotLink, now: float) -> Iterator[RefusedMessages]:
    for channel in JUDGED:
        refusals = link.reception.refusals[channel.key]
        age = refusals.age(now)
        if channel not in contract.STREAMS and age is not None:
            yield RefusedMessages(
                key=channel.key,
                name=name_of(channel),
                refused=refusals.count,
                last_refusal=refusals.reason,
                refusal_age=age,
            )


def _robot(link: RobotLink, now: float) -> RobotReport | None:
    reports = link.reports
    if reports.latest is None:
        return None
    values, mode = reports.latest.values, reports.mode
    return RobotReport(
        age=now - reports.at,
        mode=None if mode is None else mode.value,
        why=values.get("why", ""),
        contract=values.get("contract", ""),
        session=values.get("session", ""),
        tared=values.get("tared") == "true",
        commands=parse_count(values.get("commands", "")) or 0,
        refused=parse_count(values.get("refused", "")) or 0,
        last_refusal=values.get("last_refusal", ""),
    )


def _round_trip(link: RobotLink, now: float) -> Quantiles | None:
    durations = [trip.duration for trip in link.other_clock.trips(now - QUANTILES_OF)]
    if not durations:
        return None
    p50, p99 = np.quantile(np.array(durations), (0.5, 0.99)).tolist()
    return Quantiles(p50=p50, p99=p99)


def _command_age(link: RobotLink) -> Quantiles | None:
    quantiles = link.reports.joint_command_ages
    return None if quantiles is None else Quantiles(p50=quantiles[0], p99=quantiles[1])


def _latency(link: RobotLink, now: float) -> tuple[LatencyPoint, ...]:
    trips, ages = link.other_clock.worst.ago(now), link.reports.joint_command_age.ago(now)
    return tuple(
        LatencyPoint(ago=step * HISTORY_STEP, round_trip=trips.get(step), command_age=ages.get(step))
        for step in range(max([*trips, *ages], default=-1), -1, -1)
    )


def _stop(link: RobotLink, now: float) -> StopStatus | None:
    stop = link.stop_sent
    if stop is None:
        return None
    return StopStatus(age=now - stop.sent_at, acknowledged_after=link.stop_acknowledged_after)
