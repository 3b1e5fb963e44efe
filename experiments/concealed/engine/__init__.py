"""Machines simulated by MuJoCo: physics, and an engine, that nobody here wrote."""
