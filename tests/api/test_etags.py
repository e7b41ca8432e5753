"""Whatever may be kept by who asks has a name, and is not sent again to who knows it."""

from __future__ import annotations

import pytest

PATHS = (
    "/mission/config",
    "/mission/config/schema",
    "/configurations",
    "/presets",
    "/runs",
    "/runs/{run}",
    "/runs/{run}/ticks?points=20",
    "/runs/{run}/events",
    "/studies",
    "/studies/published/tables",
    "/studies/{study}",
    "/studies/{study}/rows",
)


@pytest.fixture
async def names(console):
    """A run and a study, both ended."""
    run = (await console.http.post("/runs", json={"configuration": "published", "direct": True})).json()["id"]
    await console.until_run(run, "finished")
    definition = {"grid": {"target.mass": [2.0]}, "direct": True}
    study = (await console.http.post("/studies", json={"study": definition})).json()["id"]
    await console.http.post(f"/studies/{study}/cancel")
    while (await console.http.get(f"/studies/{study}")).json()["status"] not in ("finished", "cancelled"):
        pass
    return {"run": run, "study": study}


async def test_what_is_known_is_not_sent_again(console, names):
    for path in PATHS:
        address = path.format(**names)
        first = await console.http.get(address)
        assert first.status_code == 200, (address, first.text)
        tag = first.headers["etag"]
        for known in (tag, f'"other", {tag}', f"W/{tag}", "*"):
            again = await console.http.get(address, headers={"If-None-Match": known})
            assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag), (address, known)
        other = await console.http.get(address, headers={"If-None-Match": '"other"'})
        assert (other.status_code, other.content) == (200, first.content), address


async def test_a_change_has_another_name(console):
    before = (await console.http.get("/mission/config")).headers["etag"]
    await console.http.patch("/mission/config", json={"published": {"impedance": {"damping": 3.0}}})
    changed = await console.http.get("/mission/config", headers={"If-None-Match": before})
    assert changed.status_code == 200
    assert changed.headers["etag"] != before
