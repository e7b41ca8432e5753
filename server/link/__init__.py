"""The robot at the other end of zenoh: contract, bytes, the console's end and an emulator of the robot's."""
