"""Limits of signals, and what has gone beyond them: seen, acknowledged, shelved, kept."""
