"""Rehearsals, atlases and the look-ahead: queued, flown by a worker beside the service, and kept for a while."""
