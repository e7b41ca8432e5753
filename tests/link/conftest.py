"""A robot in a process of its own, and a console's end that flies it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from server.link.robot_link import LinkSettings, RobotLink
from server.link.session import LinkSession, Transport

from .ends import CONFIG, PATIENT, ROBOT_DEADLINE, Certificates, Flight, Gaps, Robot, becalm, free_endpoint


@pytest.fixture(scope="session")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Certificates:
    """An authority of our own, a robot's and a console's certificate by it, and a stranger's by itself."""
    return Certificates(tmp_path_factory.mktemp("certificates"))


@pytest.fixture(scope="session")
def users(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Files: who may connect, and passwords."""
    folder = tmp_path_factory.mktemp("users")
    for name, content in {"users": "ana:secret\n", "right": "secret\n", "wrong": "guess\n"}.items():
        folder.joinpath(name).write_text(content)
    return {name: folder / name for name in ("users", "right", "wrong")}


@pytest.fixture(scope="package")
def robot(
    tmp_path_factory: pytest.TempPathFactory, certificates: Certificates, users: dict[str, Path]
) -> Iterator[Robot]:
    """One robot for all tests; whatever happens to it, it needs no restart."""
    plain, secured = free_endpoint(), free_endpoint("tls").replace("127.0.0.1", "localhost")
    tls = certificates.of("robot")
    arguments = (
        *("robot", "--listen", plain, "--listen", secured, "--users", str(users["users"])),
        *("--tls-ca", str(tls["tls_ca"])),
        *("--tls-certificate", str(tls["tls_certificate"]), "--tls-key", str(tls["tls_key"])),
        *("--seed", "5", "--clock-offset", "3.5", "--deadline", str(ROBOT_DEADLINE)),
    )
    with becalm(tmp_path_factory.mktemp("robot"), *arguments) as process:
        yield Robot(process, plain, secured, ("--user", "ana", "--password-file", str(users["right"])))


@pytest.fixture(scope="module")
def transport(robot: Robot, users: dict[str, Path]) -> Transport:
    """How a console in this process reaches it."""
    return Transport(connect=(robot.endpoint,), user="ana", password_file=users["right"])


@pytest.fixture(scope="module")
def link(transport: Transport) -> Iterator[RobotLink]:
    """One console's end for all tests of a module: whatever happens to the robot, it needs no restart."""
    RobotLink.warm_up(CONFIG)
    link = RobotLink(LinkSettings(transport=transport, deadline=PATIENT), CONFIG)
    link.start()
    yield link
    link.shutdown()


@pytest.fixture
def fly(robot: Robot, link: RobotLink) -> Iterator[Callable[[], Flight]]:
    """Takes the robot, without faults, for a new mission; the flight ends with the next one or the test.

    The robot is restarted for a test whose forerunners have brought the target to rest or out of reach.
    """
    if not robot.may_be_captured():
        robot.restart()
    flights: list[Flight] = []

    def end() -> None:
        robot.inject_faults()
        if flights:
            flights.pop().end()

    def begin() -> Flight:
        end()
        flights.append(Flight(link))
        return flights[-1]

    yield begin
    end()


@pytest.fixture
def stranger(transport: Transport) -> Iterator[LinkSession]:
    """Another end that is let in, but holds no session."""
    session = LinkSession(transport)
    yield session
    session.close()


@pytest.fixture
def gaps() -> Iterator[Callable[[], float]]:
    """The longest time [s] that a thread of this process waited for the machine, beside what it asked for."""
    with Gaps() as watch:
        yield lambda: watch.longest
