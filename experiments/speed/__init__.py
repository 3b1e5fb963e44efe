"""How fast the engine is beside the tools that a user would otherwise take, measured on the robot arm: `make bench`."""
