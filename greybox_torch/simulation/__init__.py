"""Simulating: a model on records, whole or cut into windows, with the derivatives of its states.

For work on the engine itself, as the experiments do it; :func:`greybox_torch.simulate` is what users call. A :class:`Simulator` is a model
with what its derivatives are taken by; a :class:`Pass` is what one of its runs is asked for.
"""

from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import DEFAULT, SimulationOptions, Simulator
from greybox_torch.simulation.windows import Windows, cut, whole_records

__all__ = ["DEFAULT", "Pass", "Records", "SimulationOptions", "Simulator", "Windows", "cut", "whole_records"]
