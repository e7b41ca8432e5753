"""The whole API against its own document: whatever is sent, the answer is one that the document describes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis.generation import GenerationMode
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from server.settings import Settings


@pytest.fixture(scope="module")
def document(serving, tmp_path_factory):
    with serving(Settings(data_dir=tmp_path_factory.mktemp("data"), configuration="published_figures")) as served:
        yield schemathesis.openapi.from_url(served.api.removesuffix("/api/v1") + "/openapi.json")


PATHS = json.loads((Path(__file__).parents[2] / "web" / "openapi.json").read_text())["paths"]
FITTING = [(path, method, GenerationMode.POSITIVE) for path in PATHS for method in PATHS[path]]
FORBIDDEN = [
    (path, method, GenerationMode.NEGATIVE) for path, method, _ in FITTING if "requestBody" in PATHS[path][method]
]

FORETOLD = [
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
]


@pytest.mark.parametrize(("path", "method", "mode"), FITTING + FORBIDDEN)
def test_every_answer_is_foretold(document, path, method, mode):
    @given(case=document[path][method].as_strategy(generation_mode=mode))
    @settings(
        max_examples=10,
        deadline=None,
        database=None,
        derandomize=True,
        phases=(Phase.explicit, Phase.generate),
        suppress_health_check=list(HealthCheck),
    )
    def check(case: schemathesis.Case) -> None:
        answer = case.call(timeout=180)
        assert answer.status_code != 500, answer.text
        case.validate_response(answer, checks=FORETOLD)

    check()
