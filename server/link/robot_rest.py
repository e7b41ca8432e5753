"""Faults on demand: the REST of the emulated robot, which no real robot has."""

from __future__ import annotations

from fastapi import FastAPI, HTTPException
from pydantic import BaseModel, ConfigDict, Field

from server.access.origin import SameOrigin
from server.edge import problem_json
from server.edge.authority import LOOPBACK_NAMES
from server.edge.bodies import JsonBodies
from server.edge.methods import HeadAsGet
from server.edge.values import Integer, Number
from server.link.faults import Faults
from server.link.robot_emulator import RobotEmulator, RobotStatus


class Hang(BaseModel):
    """Neither listen nor speak for a while."""

    model_config = ConfigDict(extra="forbid")

    duration: Number = Field(gt=0, le=3600, description="How long [s]")


class Restart(BaseModel):
    """Lose everything and come back, the plant as at the start."""

    model_config = ConfigDict(extra="forbid")

    pause: Number = Field(0.5, ge=0, le=3600, description="How long it is away [s]")
    seed: Integer | None = Field(
        None, ge=0, description="Of the random numbers from then on; the present one if left out"
    )


def create_robot_app(emulator: RobotEmulator) -> FastAPI:
    """The REST of that emulator."""
    app = FastAPI(title="Becalm's emulated robot", description="Only the emulator has it. SI units and radians.")
    problem_json.install(app)
    app.add_middleware(HeadAsGet)
    app.add_middleware(JsonBodies)
    app.add_middleware(SameOrigin, hosts=LOOPBACK_NAMES)  # a page elsewhere may move this robot as little as a real one

    @app.get("/status")
    def status() -> RobotStatus:
        """What the emulator knows of itself, the true state of the plant included."""
        known = emulator.status()
        if known is None:
            raise HTTPException(503, "the emulator is starting")
        return known

    @app.get("/faults")
    def faults() -> Faults:
        """The faults in force."""
        return emulator.faults

    @app.put("/faults")
    def inject_faults(body: Faults) -> Faults:
        """Have these faults from now on; what is left out is in order again."""
        emulator.inject_faults(body)
        return body

    @app.post("/hang", status_code=202)
    def hang(body: Hang) -> Hang:
        """Neither listen nor speak for a while; the plant floats on."""
        emulator.hang(body.duration)
        return body

    @app.post("/restart", status_code=202)
    def restart(body: Restart) -> Restart:
        """Lose everything and come back after a pause, the plant as at the start."""
        emulator.restart(body.pause, body.seed)
        return body

    return app
