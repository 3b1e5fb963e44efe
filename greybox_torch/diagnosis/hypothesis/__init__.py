"""A model with some effects attached, fitted to windows and to whole records, and how two of them compare.

For work on the diagnosis itself, as the experiments do it: :func:`hypothesis` fits one to windows of :func:`window_lengths`,
:func:`finish` takes it on to whole records, :func:`noise_floor` is what no fit can go below.
"""

from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, hypothesis, window_lengths
from greybox_torch.diagnosis.hypothesis.noise import noise_floor

__all__ = ["Hypothesis", "finish", "hypothesis", "noise_floor", "window_lengths"]
