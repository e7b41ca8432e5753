"""How well the first touch alone predicts a capture: the collision models against the flights, cell by cell."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from pydantic import Field

from sim.capture.events import Ticks
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.reproduction.experiments import succeeded
from sim.reproduction.first_touch import (
    Residual,
    TouchState,
    collision,
    damping_ratio,
    effective_mass,
    lever_of,
    planar_touch,
)
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, cohens_kappa
from sim.snapshot import FrozenMessage
from sim.study.run import Row


class Prediction(NamedTuple):
    """A cell, what its first touch left, and what the models predict that it leaves."""

    row: Row
    measured: Residual
    planar: Residual
    closed_form: Residual
    ratio: float
    """Damping ratio of the hand against the target's effective mass."""

    @property
    def success(self) -> bool:
        """Whether the paper would call the cell a success."""
        return succeeded(self.row)


class PredictionScore(FrozenMessage):
    """How well the planar model predicts spin, drift and success."""

    cells: int
    spin_error: float = Field(description="Median difference of the residual spin from that in flight [rad/s]")
    spin_error_90: float = Field(description="... that nine in ten cells stay below [rad/s]")
    spin_correlation: float
    drift_error: float = Field(description="Median difference of the drift [m/s]")
    drift_correlation: float
    drift_bound: float = Field(description="Drift above which a capture fails [m/s]; fitted to the drifts in flight")
    kappa_measured: float = Field(description="Success as predicted from spin and drift in flight, against the outcome")
    kappa_planar: float = Field(description="... from those of the planar model")
    kappa_closed_form: float = Field(description="... from those of the collision in closed form")
    share_planar: float = Field(description="Cells whose success or failure the planar model predicts")
    kappa_spin_only: float = Field(description="By the spin of the planar model alone, without a fitted bound")


def touch_state(config: MissionConfig, ticks: Ticks) -> TouchState:
    """Hand and target at the first contact of a capture.

    Raises:
        ValueError: no tip touches in these ticks.

    """
    touching = ticks["tip_contact"].any(axis=(1, 2))
    if not touching.any():
        raise ValueError("no tip touches the target in these ticks")
    tick = ticks[int(np.argmax(touching))]
    arm = int(np.argmax(tick["tip_contact"].any(axis=1)))
    offset = config.robot.arm.hand.tip_offset
    return TouchState(
        tick["hand_pose"][arm].copy(),
        np.array([-offset, offset]),
        tick["target_pose"].copy(),
        tick["target_twist"].copy(),
    )


def predictions(config: MissionConfig, state: TouchState, rows: Sequence[Row]) -> list[Prediction]:
    """Both models for every row whose capture had a first touch."""
    lever, spin = lever_of(state, config), float(state.target_twist[2])
    carried = effective_mass(config.target.mass, config.target.inertia, lever)
    cells = []
    for row in rows:
        if row["spin_after_first_touch"] is None:
            continue
        impedance = {path: row[path] for path in (MASS, DAMPING, STIFFNESS)}
        own = revised(config, nested(impedance))
        measured = Residual(row["spin_after_first_touch"], row["drift_after_first_touch"], math.nan)
        ratio = damping_ratio(row[DAMPING], row[STIFFNESS], carried + row[MASS])
        cells.append(Prediction(row, measured, planar_touch(own, state), collision(own, lever, spin), ratio))
    return cells


def predicts_success(config: MissionConfig, left: Residual, drift_bound: float) -> bool:
    """Whether a capture is predicted to succeed, by what its first touch leaves.

    It is not if the spin lies between the planner's slow spin and the threshold of detumbling, where the
    hands wait for a corner, nor if the target drifts faster than the bound.
    """
    caging = config.published.caging
    return not caging.slow_spin < abs(left.spin) < caging.spin_threshold and left.drift <= drift_bound


def prediction_score(config: MissionConfig, cells: Sequence[Prediction]) -> PredictionScore:
    """The models' errors, and how well the predicted success agrees with the outcomes."""
    spin, drift = _values(cells, 0), _values(cells, 1)
    bound = _drift_bound(config, cells)
    planar = [(cell.success, predicts_success(config, cell.planar, bound)) for cell in cells]
    return PredictionScore(
        cells=len(cells),
        spin_error=float(np.median(np.abs(spin[0] - spin[1]))),
        spin_error_90=float(np.quantile(np.abs(spin[0] - spin[1]), 0.9)),
        spin_correlation=_correlation(*spin),
        drift_error=float(np.median(np.abs(drift[0] - drift[1]))),
        drift_correlation=_correlation(*drift),
        drift_bound=bound,
        kappa_measured=_kappa(config, cells, "measured", bound),
        kappa_planar=_kappa(config, cells, "planar", bound),
        kappa_closed_form=_kappa(config, cells, "closed_form", bound),
        share_planar=sum(one == other for one, other in planar) / len(planar),
        kappa_spin_only=_kappa(config, cells, "planar", math.inf),
    )


def _values(cells: Sequence[Prediction], place: int) -> FloatArray:
    """In flight and by the planar model: spin (0) or drift (1), shape (2, cells)."""
    return np.array([[cell.measured[place], cell.planar[place]] for cell in cells]).T


def _correlation(ones: FloatArray, others: FloatArray) -> float:
    """Pearson's coefficient."""
    return float(np.asarray(np.corrcoef(ones, others))[0, 1])


def _kappa(config: MissionConfig, cells: Sequence[Prediction], by: str, bound: float) -> float:
    pairs = [(str(cell.success), str(predicts_success(config, getattr(cell, by), bound))) for cell in cells]
    return cohens_kappa(pairs)


def _drift_bound(config: MissionConfig, cells: Sequence[Prediction]) -> float:
    """The drift in flight that separates success from failure best; midway between two cells."""
    drifts = np.unique([cell.measured.drift for cell in cells])
    bounds = [*(0.5 * (drifts[1:] + drifts[:-1])), drifts[-1]]
    return float(max(bounds, key=lambda bound: _kappa(config, cells, "measured", float(bound))))
