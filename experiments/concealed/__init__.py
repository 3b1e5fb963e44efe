"""Concealed effects: machines simulated by code that shares nothing with the package, for blind trials of the diagnosis.

Everything here is NumPy: own equations, own integrator, own friction, feedback and noise.
"""
