"""`becalm robot`: the emulated robot in a process of its own, with its REST on a second port."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

import click
import uvicorn
from pydantic import BaseModel, ValidationError

from becalm.sockets import bound_socket
from becalm.typed import read_number
from server.link.faults import Faults
from server.link.imperfections import Imperfections
from server.link.robot_emulator import RobotEmulator, RobotSettings
from server.link.robot_rest import create_robot_app
from server.process.realtime import schedule_realtime, shorten_switch_interval
from sim.capture.mission import prepare
from sim.errors import ConfigError

REST_HOST = "127.0.0.1"

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True)
class TimedFault:
    """A fault from the command line: NAME=VALUE, or NAME=VALUE@SECONDS after the start."""

    name: str
    value: str
    after: float


def parse_fault(text: str) -> TimedFault:
    """A fault as it is typed.

    Raises:
        ConfigError: not of that form.

    """
    assignment, _, after = text.partition("@")
    name, equals, value = assignment.partition("=")
    try:
        seconds = read_number(after) if after else 0.0
    except ConfigError:
        seconds = -1.0
    if not equals or name not in (*Faults.model_fields, "hang", "restart") or not 0.0 <= seconds < 1e6:
        names = ", ".join((*Faults.model_fields, "hang", "restart"))
        raise ConfigError(f"--fault {text}: it is NAME=VALUE or NAME=VALUE@SECONDS, NAME one of {names}")
    _revised(Faults(), TimedFault(name, value, seconds))
    return TimedFault(name, value, seconds)


def imperfections(settings: tuple[str, ...]) -> Imperfections:
    """The default imperfections with these changes, each NAME=VALUE; `none=true` begins with a perfect testbed.

    Raises:
        ConfigError: an invalid name or value.

    """
    changes = dict(text.partition("=")[::2] for text in settings)
    if changes.pop("none", None):
        changes = {**dict.fromkeys(Imperfections.model_fields, "0"), **changes}
    return _validated(Imperfections, changes, "--imperfection")


def robot_settings(**chosen: Any) -> RobotSettings:
    """What an emulated robot is.

    Raises:
        ConfigError: an invalid value.

    """
    return _validated(RobotSettings, chosen, "--")


def run_robot(
    settings: RobotSettings, rest_port: int, faults: tuple[TimedFault, ...], *, realtime: bool = False
) -> None:
    """Be the robot until the process is asked to end.

    Raises:
        ConfigError: the link cannot be opened, or real time is not available.
        AddressInUse: the REST port is taken.

    """
    logging.basicConfig(stream=sys.stderr, level=logging.INFO, format="%(asctime)s %(message)s")
    logging.getLogger("httpx").setLevel(logging.WARNING)
    shorten_switch_interval()
    if realtime:
        schedule_realtime()
    prepare(settings.config)
    emulator = RobotEmulator(settings)
    signal.signal(signal.SIGTERM, lambda *_: emulator.shutdown())
    signal.signal(signal.SIGINT, lambda *_: emulator.shutdown())
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # as `nohup` has it
        signal.signal(signal.SIGHUP, lambda *_: emulator.shutdown())
    with _rest(emulator, rest_port) as port, _timed(emulator, faults):
        _announce_when_ready(emulator, settings, port)
        emulator.run()
    if emulator.left_open:  # zenoh would wait for it once more at the exit of the process
        logging.shutdown()
        sys.stdout.flush()
        os._exit(0)


def _announce_when_ready(emulator: RobotEmulator, settings: RobotSettings, port: int) -> None:
    where = ", ".join((*settings.transport.listen, *settings.transport.connect))

    def announce() -> None:
        emulator.ready.wait()
        click.echo(f"The robot is ready at {where}; faults at http://{REST_HOST}:{port}/docs  (end it with Ctrl-C)")

    threading.Thread(target=announce, daemon=True).start()


@contextlib.contextmanager
def _rest(emulator: RobotEmulator, port: int) -> Iterator[int]:
    with bound_socket(REST_HOST, port) as bound:
        server = uvicorn.Server(uvicorn.Config(create_robot_app(emulator), log_level="warning"))
        server.install_signal_handlers = lambda: None  # type: ignore[attr-defined]  # the main thread has its own
        thread = threading.Thread(target=server.run, kwargs={"sockets": [bound]}, daemon=True)
        thread.start()
        try:
            yield bound.getsockname()[1]
        finally:
            server.should_exit = True
            thread.join(2.0)


@contextlib.contextmanager
def _timed(emulator: RobotEmulator, faults: tuple[TimedFault, ...]) -> Iterator[None]:
    timers = [threading.Timer(fault.after, _apply, (emulator, fault)) for fault in faults if fault.after > 0.0]
    for fault in faults:
        if fault.after == 0.0:
            _apply(emulator, fault)
    for timer in timers:
        timer.daemon = True
        timer.start()
    try:
        yield
    finally:
        for timer in timers:
            timer.cancel()


def _apply(emulator: RobotEmulator, fault: TimedFault) -> None:
    if fault.name == "hang":
        emulator.hang(read_number(fault.value))
    elif fault.name == "restart":
        emulator.restart(read_number(fault.value))
    else:
        emulator.inject_faults(_revised(emulator.faults, fault))


def _revised(faults: Faults, fault: TimedFault) -> Faults:
    if fault.name in ("hang", "restart"):
        try:
            read_number(fault.value)
        except ConfigError as error:
            raise ConfigError(f"--fault {fault.name}={fault.value}: its value is a time [s]; {error}") from None
        return faults
    return _validated(Faults, {**faults.model_dump(), fault.name: fault.value}, "--fault")


def _validated(model: type[Model], values: dict[str, Any], option: str) -> Model:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        each = error.errors(include_url=False)[0]
        where = ".".join(map(str, each["loc"]))
        names = ", ".join(model.model_fields)
        raise ConfigError(f"{option} {where}={each['input']}: {each['msg']}", tip=f"there are {names}") from None
