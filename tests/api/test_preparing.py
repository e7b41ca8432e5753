"""A mission of another engine is prepared by a process beside the service while the present one flies."""

from __future__ import annotations

import asyncio

PATIENCE = 180.0

REDUCED = {"simulation": {"engine": "reduced"}}


async def test_a_reset_to_another_engine_waits_for_its_preparation_and_keeps_its_arming(console):
    run = (await console.snapshot())["run_id"]
    arming = await console.http.post("/mission/arming", json={"command": "reset", "changes": REDUCED})
    token = arming.json()["token"]
    for brought in ({}, {"arming": token}):
        refused = await console.command("reset", changes=REDUCED, **brought)
        assert refused.status_code == 503
        assert "simulation.engine = reduced is being prepared" in refused.json()["detail"]
        assert "Retry-After" in refused.headers
    assert (await console.snapshot())["armed"] is not None
    async with asyncio.timeout(PATIENCE):
        while (answer := await console.command("reset", changes=REDUCED)).status_code == 503:
            await asyncio.sleep(0.1)
    assert answer.status_code == 200, answer.text
    assert (await console.snapshot())["run_id"] != run
