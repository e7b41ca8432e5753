"""Parameters kept by name: kept, flown, replaced, removed, and refused where they cannot be."""

from __future__ import annotations

import json

NAN = float("nan")
SOFT = {"configuration": "published_figures", "changes": {"published": {"impedance": {"damping": 0.25}}}}


async def test_a_preset_is_kept_with_who_and_what_it_comes_to_and_removed(console):
    assert (await console.http.get("/presets")).json() == []
    kept = (await console.http.put("/presets/soft hands", json=SOFT)).json()
    assert (kept["preset"]["name"], kept["preset"]["who"]) == ("soft hands", "operator")
    assert kept["config"]["published"]["impedance"]["damping"] == 0.25
    assert (await console.http.get("/presets")).json() == [kept]

    harder = {**SOFT, "changes": {"published": {"impedance": {"damping": 3.0}}}}
    await console.http.put("/presets/soft hands", json=harder)
    await console.http.put("/presets/Another", json=SOFT)
    names = [each["preset"]["name"] for each in (await console.http.get("/presets")).json()]
    assert names == ["Another", "soft hands"]
    changed = await console.http.patch("/mission/config", json=harder["changes"])
    assert changed.json()["config"]["published"]["impedance"]["damping"] == 3.0

    assert (await console.http.delete("/presets/soft hands")).status_code == 204
    gone = await console.http.delete("/presets/soft hands")
    assert gone.status_code == 404
    assert "name = 'soft hands': there is no such preset; known: Another" in gone.json()["detail"]


async def test_what_cannot_be_flown_is_not_kept(console):
    for body, words in (
        ({**SOFT, "changes": {"published": {"impedance": {"mass": -1}}}}, "published.impedance.mass"),
        ({**SOFT, "changes": {"published": {"impedance": {"stifness": 1}}}}, "stifness"),
        ({**SOFT, "configuration": "nowhere"}, "nowhere"),
    ):
        refused = await console.http.put("/presets/broken", json=body)
        assert refused.status_code == 422
        assert words in refused.text
    assert (await console.http.put("/presets/-broken", json=SOFT)).status_code == 422
    assert (await console.http.get("/presets")).json() == []


async def test_a_preset_of_another_version_is_listed_with_the_reason_why_it_cannot_be_flown(console, settings):
    await console.http.put("/presets/old", json=SOFT)
    path = settings.data_dir / "presets.json"
    kept = json.loads(path.read_text())
    kept["presets"][0]["changes"] = {"published": {"impedance": {"springiness": 2.0}}}
    path.write_text(json.dumps(kept))
    [listed] = (await console.http.get("/presets")).json()
    assert listed["config"] is None
    assert "springiness" in listed["refusal"]
    good, odd = kept["presets"][0] | {"name": "good", "changes": {}}, {"name": "odd", "changes": {"a": 1}}
    path.write_text(
        json.dumps({"version": 1, "presets": [odd, 5, good, good | {"name": "nan", "changes": {"a": NAN}}]})
    )
    listed = (await console.http.get("/presets")).json()
    assert [each["name"] for each in listed] == ["odd", "number 2", "good", "nan"]
    assert [each["preset"] is None for each in listed] == [True, True, False, True]
    assert all(each["refusal"] for each in listed if each["preset"] is None)
    await console.http.put("/presets/new", json=SOFT)
    assert (await console.http.delete("/presets/odd")).status_code == 204
    assert sorted(
        str(each["name"] if isinstance(each, dict) else None) for each in json.loads(path.read_text())["presets"]
    ) == ["None", "good", "nan", "new"]
    path.write_text("{")
    damaged = await console.http.get("/presets")
    assert damaged.status_code == 409
    assert "presets.json is damaged" in damaged.json()["detail"]
