"""A robot in a process of its own, and a console's end that flies it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from ends import CONFIG, DEADLINE, Flight, Robot, becalm, free_endpoint

from server.link.robot_link import LinkSettings, RobotLink
from server.link.session import Transport


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    endpoint = free_endpoint()
    arguments = ("robot", "--listen", endpoint, "--seed", "5", "--clock-offset", "3.5", "--deadline", str(DEADLINE))
    with becalm(tmp_path_factory.mktemp("robot"), *arguments) as process:
        yield Robot(process, endpoint)


@pytest.fixture(scope="module")
def link(robot: Robot) -> Iterator[RobotLink]:
    """One console's end for all tests: whatever happens to the robot, it needs no restart."""
    RobotLink.warm_up(CONFIG)
    transport = Transport(connect=(robot.endpoint,))
    link = RobotLink(LinkSettings(transport=transport, deadline=DEADLINE), CONFIG)
    link.start()
    yield link
    link.shutdown()


@pytest.fixture
def fly(robot: Robot, link: RobotLink) -> Iterator[Callable[[], Flight]]:
    """Takes the robot, without faults, for a new mission; the flight ends with the test."""
    flights: list[Flight] = []

    def begin() -> Flight:
        flights.append(Flight(link))
        return flights[-1]

    robot.suffer()
    yield begin
    for flight in flights:
        flight.end()
    robot.suffer()
