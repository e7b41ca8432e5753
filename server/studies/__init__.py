"""Studies that are queued, flown and kept."""
