"""What somebody asked for that takes a while: done piece by piece by a worker process beside the live mission."""
