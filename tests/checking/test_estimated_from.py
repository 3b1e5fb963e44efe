"""A card without an experiment to estimate from is told where it is looked at."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import greybox_torch as gt
from greybox_torch.systems.load import load_model


def test_all_validation(machines: Path) -> None:
    rotor = load_model(f"{machines / 'small.py'}:Rotor")
    wave: np.ndarray = np.sin(0.1 * np.arange(40))
    run = gt.Recording.from_arrays("run", {"voltage": wave, "speed": wave}, sample_time=0.01, role="validation")
    data = gt.DataSet([run])
    told = 'no experiment has the role "estimation"'
    (found,) = [one for one in gt.check(rotor, data).findings if one.topic == "card"]
    assert told in found.found and found.write == 'role = "estimation" for at least one'
    assert any(told in str(one) for one in gt.inspect(data, rotor).warnings)
