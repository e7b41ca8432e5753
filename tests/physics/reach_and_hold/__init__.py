"""A second, deliberately small method: both hands reach back a little, hold still, and that is reported."""
