"""The live mission: one thread that flies it, what may be asked of it, and what it publishes."""
