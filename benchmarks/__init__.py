"""Figures of mission.md as ratios and shares, by hand: `python -m benchmarks.simulation`."""
