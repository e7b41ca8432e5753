"""Rehearsal: many flights from one state, each with its own draw of what is not known for sure."""
