"""The log of a run: one MCAP file, written while the run happens and read at any moment of it."""
