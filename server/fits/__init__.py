"""Fits: which numbers explain a recorded run, worked out by the worker of rehearsals, and their reports."""
