"""`/session`: who one is, and signing in and out on the console's page."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from server.access.guard import holder_of, unknown_token
from server.access.roles import Role
from server.access.tokens import Holder
from server.api.services import ServicesDep
from server.edge.problem_json import responses

router = APIRouter(prefix="/session", tags=["access"])


class Session(BaseModel):
    """Who asks."""

    token_needed: bool = Field(description="False where everyone who reaches the service may do everything")
    name: str | None = Field(description="Of the token; null if none was shown, or none that holds", examples=["ana"])
    role: Role | None = Field(description="What that name may do", examples=["operator"])


class SignIn(BaseModel):
    """A token, to be kept by the browser."""

    model_config = ConfigDict(extra="forbid")

    token: Annotated[str, Field(min_length=1, max_length=200, description="As `becalm token create` printed it")]


@router.get("")
async def session(services: ServicesDep, request: Request) -> Session:
    """Who the token belongs to that this request shows."""
    return _session(services, holder_of(request))


@router.post("", response_model=Session, responses=responses(422))
async def sign_in(services: ServicesDep, request: Request, response: Response, body: SignIn) -> Session | Response:
    """Keep a token in a cookie that scripts of the page cannot read and other sites cannot use."""
    holder = services.access.tokens.holder_of(body.token)
    if holder is None:
        return unknown_token(services.access, request.scope, body.token).answer
    services.access.cookie.keep(request, response, body.token)
    return _session(services, holder)


@router.delete("", status_code=204)
async def sign_out(services: ServicesDep, request: Request) -> Response:
    """Forget the token; it stays valid for those who have it."""
    response = Response(status_code=204)
    services.access.cookie.forget(request, response)
    return response


def _session(services: ServicesDep, holder: Holder | None) -> Session:
    return Session(
        token_needed=services.access.required,
        name=None if holder is None else holder.name,
        role=None if holder is None else holder.role,
    )
