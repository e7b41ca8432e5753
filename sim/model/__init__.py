"""Frames, the robot's chain and inertia, the generalized Jacobian, the target's shape."""
