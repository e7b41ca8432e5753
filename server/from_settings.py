"""What a service's settings ask for, made: its link, its workers, and whom it lets in."""

from __future__ import annotations

from pydantic import ValidationError

from server.access.attempts import Attempts
from server.access.audit import AuditLog
from server.access.cookie import SessionCookie
from server.access.guard import Access
from server.access.tokens import TokenStore
from server.link.robot_link import LinkSettings, RobotLink
from server.link.zenoh_plant import require_robot_config
from server.settings import Settings
from server.studies.cluster import cluster_workers
from sim.config import MissionConfig
from sim.errors import ConfigError
from sim.study.executors import Workers, local_workers

STUDY_NICENESS = 10
"""Of the processes that fly studies on this machine: the live mission's clock comes first."""


def link_from_settings(settings: Settings, config: MissionConfig) -> RobotLink | None:
    """The console's end of the link, not yet open; None where the simulation is flown.

    Raises:
        ConfigError: there is no endpoint, one is not of the right form, or the control period is not the link's.

    """
    if settings.plant == "simulation":
        return None
    if not settings.connect and not settings.link_listen:
        raise ConfigError(
            "connect = (): plant = 'zenoh' needs to know where the robot is",
            tip="for example --connect tcp/127.0.0.1:7447, after becalm robot --listen tcp/127.0.0.1:7447",
        )
    require_robot_config(config)
    return RobotLink(_link_settings(settings), config)


def _link_settings(settings: Settings) -> LinkSettings:
    transport = {
        "connect": settings.connect,
        "listen": settings.link_listen,
        "user": settings.link_user,
        "password_file": settings.link_password_file,
        "tls_ca": settings.link_tls_ca,
        "tls_certificate": settings.link_tls_certificate,
        "tls_key": settings.link_tls_key,
    }
    try:
        return LinkSettings.model_validate(
            {
                "transport": transport,
                "deadline": settings.link_deadline,
                "detect_freeze": settings.link_detect_freeze,
                "robot": settings.link_robot,
                "world_frame": settings.link_world_frame,
                "left_wrist": settings.link_left_wrist,
                "right_wrist": settings.link_right_wrist,
                "bounds": settings.link_bounds,
            }
        )
    except ValidationError as error:
        each = error.errors(include_url=False)[0]
        field = str(each["loc"][-1] if isinstance(each["loc"][-1], str) else each["loc"][-2]) if each["loc"] else "link"
        raise ConfigError(f"{field} = {each['input']!r}: {each['msg']}", tip="docs/link.md shows endpoints") from None


def workers_from_settings(settings: Settings) -> Workers:
    """What flies studies now.

    Raises:
        WorkersUnavailable: the cluster cannot.

    """
    if settings.scheduler is not None:
        return cluster_workers(settings.scheduler)
    return local_workers(settings.study_workers, STUDY_NICENESS)


def access_from_settings(settings: Settings) -> Access:
    """Whom the service lets in.

    Raises:
        ConfigError: tokens are needed, and there is none.

    """
    folder = settings.data_dir / "access"
    tokens = TokenStore(folder, settings.admin_token_file)
    if settings.tokens_required and not tokens.any_valid:
        raise ConfigError(
            f"host = {settings.host!r}: the service asks for tokens there, and nobody has one",
            tip="becalm token create NAME --role admin makes one; BECALM_REQUIRE_TOKENS=false lets everyone in",
        )
    return Access(tokens, settings.tokens_required, Attempts(), AuditLog(folder / "audit.log"), SessionCookie(folder))
