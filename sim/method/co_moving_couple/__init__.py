"""Our own method: one touch by both hands that move with the faces, then a closing that turns with the target."""
