from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.systems.load import load_model


@pytest.fixture(scope="package")
def rubbing(sled_run, begun, machines: Path):
    """A sled with a Coulomb friction of 1.5 N that its model lacks, before the first look."""
    return begun(sled_run(lambda q, v: -1.5 * np.tanh(v / 0.02)), load_model(f"{machines / 'sled.py'}:Sled"))


@pytest.fixture(scope="package")
def whole(sled_run, begun, machines: Path):
    """A sled whose model lacks nothing, before the first look; the force has noise."""
    return begun(sled_run(noise=1e-4), load_model(f"{machines / 'sled.py'}:Sled"))
