"""The configuration over REST: read, changed while flying, refused by field, value and bound."""

from __future__ import annotations

import asyncio

import pytest

from sim.config import PARAMETERS
from sim.configurations import NAMED_CONFIGURATIONS

DAMPING = {"published": {"impedance": {"damping": 3.0}}}


async def test_live_parameter_changes_while_a_mission_flies(console):
    await console.granted("capture")
    run_id = (await console.snapshot())["run_id"]
    answer = await console.http.patch("/mission/config", json=DAMPING)
    body = answer.json()
    assert answer.status_code == 200
    assert body["name"] == "published_figures (edited)"
    assert body["edited"] == {"published.impedance.damping": {"from": 0.1, "to": 3.0}}
    assert body == (await console.http.get("/mission/config")).json()
    snapshot = await console.snapshot()
    assert snapshot["phase"] == "detumbling"
    assert snapshot["run_id"] == run_id


async def test_other_parameter_takes_a_new_mission_while_idle(console):
    before = (await console.snapshot())["run_id"]
    answer = await console.http.patch("/mission/config", json={"target": {"initial_spin": 0.7}})
    assert answer.status_code == 200
    snapshot = await console.snapshot()
    assert snapshot["run_id"] != before
    assert snapshot["spin"] == pytest.approx(0.7)


async def test_other_parameter_is_refused_while_a_mission_is_under_way(console):
    await console.granted("capture")
    answer = await console.http.patch("/mission/config", json={"target": {"mass": 3.0}})
    assert answer.status_code == 409
    assert "target.mass" in answer.json()["detail"]
    assert "reset" in answer.json()["tip"]


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ('{"target": {"mass": -1}}', "target.mass", ["-1", "greater than 0", "kg"]),
        ('{"target": {"mass": NaN}}', "target.mass", ["NaN", "number"]),
        ('{"target": {"masss": 1}}', "target.masss", ["target.mass?"]),
        ('{"simulation": {"time_step": 3e-4}}', "simulation.time_step", ["0.0003", "control.period"]),
        ('{"target": {"initial_y": 0.1}}', "target.initial_x", ["overlaps", "base"]),
        ('{"published": {"impedance": 3}}', "published.impedance", ["3"]),
        ('{"contact": {"corner": "round"}}', "contact.corner", ["face", "radial"]),
    ],
)
async def test_bad_value_is_named_and_nothing_changes(console, changes, field, words):
    before = (await console.http.get("/mission/config")).json()
    answer = await console.http.patch("/mission/config", content=changes, headers={"content-type": "application/json"})
    problem = answer.json()
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert problem["errors"][0]["field"] == field
    for word in words:
        assert word in problem["detail"]
    assert (await console.http.get("/mission/config")).json() == before


async def test_all_or_nothing(console):
    changes = {"published": {"impedance": {"damping": 3.0, "stiffness": -1.0}}}
    assert (await console.http.patch("/mission/config", json=changes)).status_code == 422
    assert (await console.http.get("/mission/config")).json()["edited"] == {}


async def test_what_cannot_be_never_reaches_the_mission_thread(console, monkeypatch):
    """To check and to explain it may take long, and a mission flies meanwhile."""
    asked = []
    monkeypatch.setattr(console.services.loop, "ask", asked.append)
    for changes in ({f"stranger_{number}": 1.0 for number in range(2000)}, {"target": {"mass": -1}}):
        answer = await console.http.patch("/mission/config", json=changes)
        assert answer.status_code == 422
        assert len(answer.content) < 10_000
    assert asked == []


async def test_changes_at_once_all_hold_though_each_was_checked_against_another(console):
    """What was checked against parameters that are no longer in force is checked again, not laid over the others'."""
    changes = [{"damping": 3.0}, {"stiffness": 20.0}, {"mass": 0.3}]
    asked = [console.http.patch("/mission/config", json={"published": {"impedance": each}}) for each in changes]
    assert [answer.status_code for answer in await asyncio.gather(*asked)] == [200, 200, 200]
    impedance = (await console.http.get("/mission/config")).json()["config"]["published"]["impedance"]
    assert (impedance["damping"], impedance["stiffness"], impedance["mass"]) == (3.0, 20.0, 0.3)


async def test_schema_tells_everything_about_every_parameter(console):
    body = (await console.http.get("/mission/config/schema")).json()
    by_path = {parameter["path"]: parameter for parameter in body["parameters"]}
    assert set(by_path) == set(PARAMETERS)
    damping = by_path["published.impedance.damping"]
    assert damping["unit"] == "N s/m"
    assert damping["live"]
    assert damping["minimum"] == 0
    assert damping["default"] == 1.5
    assert by_path["target.mass"]["exclusive_minimum"] == 1e-3
    assert by_path["contact.corner"]["choices"] == ["face", "radial"]
    assert by_path["method"]["choice_titles"].keys() == set(by_path["method"]["choices"])
    assert "Uchida" in by_path["method"]["choice_titles"]["published"]
    assert by_path["contact.corner"]["choice_titles"] == {}
    vertices = by_path["target.vertices"]
    assert (vertices["type"], vertices["fewest"], vertices["most"]) == ("points", 3, 12)
    assert (vertices["minimum"], vertices["maximum"], vertices["choices"]) == (-10, 10, None)
    assert vertices["default"][1] == [0.14, 0.0]
    assert all(parameter["source"] for parameter in by_path.values())


async def test_a_list_of_points_is_changed_whole_and_told_as_a_change(console):
    points = [[0, 0], [0.2, 0], [0, 0.1]]
    body = (await console.http.patch("/mission/config", json={"target": {"vertices": points}})).json()
    assert body["config"]["target"]["vertices"] == points
    assert body["edited"]["target.vertices"]["to"] == points


@pytest.mark.parametrize(
    ("vertices", "field", "words"),
    [
        ([[0, 0], [0, 0.1], [0.1, 0]], "target.vertices", "clockwise"),
        ([[0, 0], [0.1, 0], [0, 11]], "target.vertices.2.1", "less than or equal to 10 [m]"),
        (True, "target.vertices", "array"),
    ],
)
async def test_points_that_cannot_be_are_refused_by_field(console, vertices, field, words):
    answer = await console.http.patch("/mission/config", json={"target": {"vertices": vertices}})
    assert answer.status_code == 422
    found = answer.json()["errors"]
    assert [each["field"] for each in found] == [field]
    assert words in found[0]["message"]


async def test_named_configurations(console):
    configurations = (await console.http.get("/configurations")).json()
    assert {each["name"] for each in configurations} == set(NAMED_CONFIGURATIONS)
    assert all(each["description"] for each in configurations)
