"""What a fit says; the same from a script, the command line and the service."""

from __future__ import annotations

from pydantic import Field

from sim.snapshot import FrozenMessage


class FittedParameter(FrozenMessage):
    """One parameter, and how surely it is known by now."""

    name: str = Field(description="Full path in the configuration, or a name of its own")
    unit: str
    description: str
    nominal: float = Field(description="As configured; the mean of the prior")
    spread: float = Field(description="Standard deviation of the prior")
    value: float = Field(description="Fitted; nominal where the runs do not tell")
    standard_error: float | None = Field(description="Null where the runs do not tell")
    low: float | None = Field(description="Of the 95 % interval")
    high: float | None = Field(description="Likewise")
    told: bool = Field(description="Whether the runs tell it")
    why_not: str | None = Field(description="Why they do not")
    in_configuration: bool = Field(description="Whether a preset can keep it")


class Correlation(FrozenMessage):
    """How the errors of two parameters go together."""

    first: str
    second: str
    correlation: float = Field(ge=-1.0, le=1.0)


class ChannelResidual(FrozenMessage):
    """What is left of one reading of one run."""

    run: str
    name: str = Field(examples=["target.angle", "left.force_x"])
    unit: str
    rms: float = Field(description="Root mean square of what is left, fitted")
    rms_nominal: float = Field(description="The same with nominal values")
    deviation: float = Field(description="Standard deviation that the fit gave this reading")
    time: list[float] = Field(description="Mission times of some of the rows [s]")
    measured: list[float]
    predicted: list[float] = Field(description="Fitted, each stretch from the state that explains it best")


class TouchPrediction(FrozenMessage):
    """The peak force of one touch, foretold from the motion before it and the commands alone."""

    run: str
    time: float = Field(description="When it was felt first [s]")
    arm: str = Field(description="Of the largest measured force")
    measured: float = Field(description="Largest force of a hand in the touch, as read [N]")
    nominal: float = Field(description="Foretold with nominal values [N]")
    fitted: float = Field(description="Foretold with fitted values [N]")


class MissPart(FrozenMessage):
    """What one parameter has of the miss."""

    name: str
    part: float = Field(description="Shapley value: its mean share over all orders of putting parameters right [N]")


class Miss(FrozenMessage):
    """Between what the nominal model says of the hardest touch, and what was measured."""

    run: str
    time: float = Field(description="When it was felt first [s]")
    arm: str
    nominal: float = Field(description="[N]")
    fitted: float = Field(description="[N]")
    measured: float = Field(description="[N]")
    parts: list[MissPart] = Field(description="They sum up to fitted less nominal, the largest first")
    unexplained: float = Field(description="Measured less fitted [N]")
    words: str


class FitResult(FrozenMessage):
    """Which numbers explain the runs."""

    runs: list[str]
    held_out: list[str]
    rows: int = Field(description="Ticks that were explained")
    stretches: int = Field(description="That were flown from states of their own")
    touches: int = Field(description="Of them in which a hand is felt to touch")
    parameters: list[FittedParameter]
    correlations: list[Correlation] = Field(description="Of those that the runs tell")
    indistinct: list[str] = Field(description="What the runs do not tell, or only together, in words")
    channels: list[ChannelResidual]
    touch_predictions: list[TouchPrediction] = Field(description="Of the fitted runs")
    held_out_predictions: list[TouchPrediction]
    miss: Miss | None = Field(description="Null without a touch that can be foretold")
    preset: dict[str, float] = Field(description="Full path to fitted value: what a preset keeps")
    uncertainty: dict[str, float] = Field(
        description="Fields of the rehearsals' uncertainty model, as the fit has them"
    )
    notices: list[str]
    evaluations: int
    wall_time: float = Field(description="[s]")
