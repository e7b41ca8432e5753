"""The capture itself: models, contact, control, caging. Knows nothing of networks or screens."""
