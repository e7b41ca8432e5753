"""What is kept: recorded runs and presets, and how they are read, listed, exported, played back and removed."""
