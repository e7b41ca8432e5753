"""A mission from its first plan to locked arms, and the judgement of how it ended."""
