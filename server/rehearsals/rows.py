"""The futures of a rehearsal as a table: a row each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pyarrow as pa

from sim.rehearsal.futures import Flown
from sim.rehearsal.summary import BANDED, MEASURE_WORDS, measured
from sim.rehearsal.uncertainty import DRAWN
from sim.tabular import parquet

_DOUBLE = pa.float64()


def as_parquet(flown: Mapping[str, Sequence[Flown]]) -> bytes:
    """A Parquet file: case, future, seed, outcome, whether it was caged, every measure and every number drawn.

    Each column carries its unit and what it is.
    """
    schema = pa.schema(
        [
            pa.field("case", pa.string()),
            pa.field("future", pa.int64()),
            pa.field("seed", pa.int64()),
            pa.field("outcome", pa.string()),
            pa.field("caged", pa.bool_()),
            *(_column(name, *MEASURE_WORDS[name]) for name in BANDED),
            *(_column(f"drawn.{each.name}", each.unit, each.description) for each in DRAWN),
            pa.field("error", pa.string()),
        ]
    )
    rows = [_row(case, each) for case, futures in flown.items() for each in futures]
    return b"".join(parquet(schema, [pa.RecordBatch.from_pylist(rows, schema)]))


def _column(name: str, unit: str, description: str) -> pa.Field:
    return pa.field(name, _DOUBLE, metadata={"unit": unit, "description": description})


def _row(case: str, flown: Flown) -> dict[str, object]:
    return {
        "case": case,
        "future": flown.drawn.future,
        "seed": flown.drawn.seed,
        "outcome": flown.outcome.outcome.value,
        "caged": flown.outcome.caged,
        **{name: measured(flown, name) for name in BANDED},
        **{f"drawn.{name}": value for name, value in flown.drawn.values.items()},
        "error": flown.error,
    }
