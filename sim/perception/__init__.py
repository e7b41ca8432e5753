"""What the controller knows of the truth: sensor noise, and contact as the wrists tell it."""
