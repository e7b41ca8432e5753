"""`becalm.Client` against a running service; the samples of README and docs are run as they stand there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pyarrow.parquet
import pytest

import becalm

ROOT = Path(__file__).parents[2]


def sample(document: str, heading: str) -> str:
    """The first Python sample below a heading."""
    section = (ROOT / document).read_text().split(f"## {heading}\n", 1)[1]
    found = re.search(r"```python\n(.*?)```", section, re.DOTALL)
    assert found is not None
    return found[1]


@pytest.fixture
def address(served, monkeypatch):
    monkeypatch.setenv("BECALM_ADDRESS", served.api.removesuffix("/api/v1"))
    return served


@pytest.mark.usefixtures("address")
def test_the_readmes_ten_lines(capsys):
    names: dict[str, Any] = {}
    exec(sample("README.md", "From a script"), names)
    ticks, snapshot = names["ticks"], names["snapshot"]
    assert snapshot.outcome is not None
    assert snapshot.outcome.outcome.value in capsys.readouterr().out
    assert len(ticks) > 5000
    assert ticks.attrs["units"]["right.hand_wrench.x"] == "N"
    with becalm.Client() as service:
        assert service.config().config.published.impedance.damping == 3.0


@pytest.mark.usefixtures("address")
def test_runs_and_studies_as_the_api_page_shows(capsys):
    exec(sample("docs/api.md", "From Python"), {})
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[:3]] == ["finished"] * 3
    assert "outcome" in printed[3]


@pytest.mark.usefixtures("address")
def test_a_refusal_says_what_the_service_said():
    with becalm.Client() as service:
        with pytest.raises(becalm.ServiceRefused, match="release is refused in phase idle") as refused:
            service.command("release")
        assert refused.value.status == 409
        with pytest.raises(becalm.ServiceRefused) as invalid:
            service.change({"published": {"impedance": {"damping": -3}}})
        assert invalid.value.errors[0]["field"] == "published.impedance.damping"
        assert "lists" in invalid.value.tip or "list" in invalid.value.tip
        with pytest.raises(becalm.ServiceRefused) as unknown:
            service.run("20261122T113000123-4f9a2c/../x")
        assert unknown.value.status == 404


def test_nobody_there():
    with becalm.Client("http://127.0.0.1:9") as service:
        with pytest.raises(becalm.ServiceUnreachable, match=re.escape("http://127.0.0.1:9")):
            service.mission()
        with pytest.raises(becalm.ServiceUnreachable):
            next(service.watch())


@pytest.mark.usefixtures("address")
async def test_awaited_it_does_the_same(tmp_path):
    async with becalm.AsyncClient() as service:
        run = await service.start_run("published", direct=True, idempotency_key="once")
        again = await service.start_run("published", direct=True, idempotency_key="once")
        assert run.id == again.id
        flown = await service.finished_run(run.id)
        assert flown.status == "finished"
        await service.download(run.id, tmp_path / "log.parquet")
        assert pyarrow.parquet.read_metadata(tmp_path / "log.parquet").num_rows == flown.ticks
        assert [each.id async for each in service.runs(kind="scripted", limit=1)] == [run.id]
        await service.command("run", speed=0)
        await service.command("direct_cage")
        phases = {snapshot.phase async for snapshot in service.watch(rate=60)}
        assert "holding" in {str(phase) for phase in phases}
        await service.delete_run(run.id)


@pytest.mark.usefixtures("address")
def test_a_rehearsal_and_an_atlas_as_their_page_shows(capsys):
    pytest.importorskip("pandas")
    exec(sample("docs/rehearsal.md", "From a script"), {})
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[:2]] == ["caged", "caged"]
    assert any(line.split()[0] in ("better", "worse", "same") for line in printed[2:])
    exec(sample("docs/rehearsal.md", "Atlas"), {})
    cells = [tuple(map(int, line.split()[:2])) for line in capsys.readouterr().out.splitlines()]
    assert sorted(cells) == [(x, y) for x in range(4) for y in range(4)]
    with becalm.Client() as service:
        assert service.look_ahead().go_odds == 0.9
        assert service.foreseen(service.mission().run_id) is None, "nothing has begun yet"
        begun = service.start_rehearsal(futures=2000)
        assert service.cancel_rehearsal(begun.id).status == "cancelled"
