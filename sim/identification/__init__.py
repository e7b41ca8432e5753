"""Identification: which numbers of robot, target and sensors explain a recorded run (docs/fit.md)."""
