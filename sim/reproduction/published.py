"""The paper's parametric study: its 484 cells, its tables as they were printed, and how far ours agree with them.

Uchida, Uno, Yoshida, iSpaRo 2024, Sec. IV. The two tables at hand, m = 0.01 and 0.1 kg, stand in
`data/published_tables.json`; those of m = 0.05 and 0.5 kg are not.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from pydantic import Field

from sim.config import Engine
from sim.errors import ConfigError
from sim.snapshot import FrozenMessage
from sim.study.design import ENGINE, Study, study_of
from sim.study.run import Row

MASS = "published.impedance.mass"
DAMPING = "published.impedance.damping"
STIFFNESS = "published.impedance.stiffness"


REPRODUCTION_ENGINE = Engine.PYMUNK
"""The engine that flies the paper's tables: all that is written about them holds for this plant."""


@cache
def published_study() -> Study:
    """The parametric study of the paper; made on first use, since that runs compiled code."""
    return study_of(
        {
            "name": "published",
            "description": "The parametric study of the paper: virtual mass, damping and stiffness at 1 rad/s",
            "configuration": "published",
            "changes": {ENGINE: REPRODUCTION_ENGINE.value},
            "grid": {
                MASS: [0.01, 0.05, 0.1, 0.5],
                DAMPING: {"from": 0.0, "to": 15.0, "step": 1.5},
                STIFFNESS: {"from": 0.0, "to": 100.0, "step": 10.0},
            },
        }
    )


NAMED_STUDIES: Mapping[str, Callable[[], Study]] = {"published": published_study}

NOT_FLOWN = "none"
"""In place of the class of a cell that could not be flown: it agrees with nothing published."""


def named_study(name: str) -> Study:
    """The study of that name.

    Raises:
        ConfigError: no study has that name.

    """
    try:
        made = NAMED_STUDIES[name]
    except KeyError:
        raise ConfigError(f"study = {name!r} is unknown; there are {', '.join(NAMED_STUDIES)}") from None
    return made()


class PublishedImpedance(NamedTuple):
    """The virtual impedance of a cell of the published study."""

    mass: float
    """[kg]"""
    damping: float
    """[N s/m]"""
    stiffness: float
    """[N/m]"""


class Agreement(FrozenMessage):
    """How far the rows of a study agree with one published table, judged as the paper judges."""

    mass: float = Field(description="Virtual mass of the table [kg]")
    cells: int = Field(description="Cells of the table that the study has flown")
    agreeing: int = Field(description="... whose class is the published one, of five")
    share: float
    kappa: float = Field(description="Cohen's kappa over the classes: 0 as by chance, 1 identical")
    success_agreeing: int = Field(description="... that succeed or fail as published")
    success_share: float
    success_kappa: float = Field(description="Cohen's kappa over success and failure")


@cache
def published_classes() -> Mapping[PublishedImpedance, str]:
    """The class that the paper prints for each cell of its two tables at hand."""
    text = files("sim.reproduction").joinpath("data", "published_tables.json").read_text(encoding="utf-8")
    tables = json.loads(text)
    return {
        PublishedImpedance(float(mass), float(damping), float(stiffness)): printed
        for mass, lines in tables["tables_by_m_im_kg"].items()
        for stiffness, line in zip(tables["k_im_N_per_m"], lines, strict=True)
        for damping, printed in zip(tables["d_im_Ns_per_m"], line, strict=True)
    }


def is_comparable(study: Study) -> bool:
    """Whether this study can be compared with the published tables: a grid over the same three, with detumbling."""
    return set(study.grid) == set(published_study().grid) and study.samples is None and not study.direct


def agreement(rows: Iterable[Row]) -> list[Agreement]:
    """Our classes at the first closure against the published ones, table by table.

    Args:
        rows: of a study over mass, damping and stiffness; a cell that is in no table is ignored.

    """
    printed = published_classes()
    pairs: dict[float, list[tuple[str, str]]] = {}
    for row in rows:
        impedance = PublishedImpedance(row[MASS], row[DAMPING], row[STIFFNESS])
        if impedance in printed:
            ours = row["at_first_closure"] or NOT_FLOWN
            pairs.setdefault(impedance.mass, []).append((ours, printed[impedance]))
    return [_agreement(mass, pairs[mass]) for mass in sorted(pairs)]


def _agreement(mass: float, classes: Sequence[tuple[str, str]]) -> Agreement:
    successes = [(_success(ours), _success(printed)) for ours, printed in classes]
    agreeing, success_agreeing = _agreeing(classes), _agreeing(successes)
    return Agreement(
        mass=mass,
        cells=len(classes),
        agreeing=agreeing,
        share=agreeing / len(classes),
        kappa=cohens_kappa(classes),
        success_agreeing=success_agreeing,
        success_share=success_agreeing / len(classes),
        success_kappa=cohens_kappa(successes),
    )


def _agreeing(pairs: Iterable[tuple[str, str]]) -> int:
    return sum(ours == theirs for ours, theirs in pairs)


def _success(outcome: str) -> str:
    if outcome == NOT_FLOWN:
        return NOT_FLOWN
    return "success" if outcome.startswith("caged") else "failure"


def cohens_kappa(pairs: Sequence[tuple[str, str]]) -> float:
    """Agreement of two judges beyond chance (Cohen 1960): 1 if they always agree, 0 as often as by chance.

    Args:
        pairs: both judges' class of each case; at least one.

    """
    ours, theirs = (Counter(pair[judge] for pair in pairs) for judge in range(2))
    observed = _agreeing(pairs) / len(pairs)
    by_chance = sum(ours[name] * theirs[name] for name in ours) / len(pairs) ** 2
    return 1.0 if by_chance == 1.0 else (observed - by_chance) / (1.0 - by_chance)
