"""A refit compared with what came before it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged, judged_beside
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


@pytest.fixture
def over(stub):
    """A hypothesis over so many windows of one energy, and with parameters that count as so much worse."""

    def make(windows: int, energy: float, implausible: float = 0.0):
        fit = stub(energies=energy * (1.0 + 0.1 * np.random.default_rng(windows).normal(size=windows)))
        return stub(fits=(fit,), score=np.log(energy) + implausible, implausible=implausible)

    return make


def test_a_step_of_fewer_experiments_gives_way_to_the_model_as_it_stands(over, stub) -> None:
    """Seen: a traceback, "shapes (64,) (128,)", where a second experiment was taken to choose with and the effects stayed."""
    earlier, plain, fitted = over(64, 9.0), over(128, 4.0), over(128, 1.0)
    beside = judged_beside(stub(), earlier, plain, fitted, SETTINGS)
    assert beside.gain == pytest.approx(np.log(4.0)) and beside.significance > 10.0
    own = judged_beside(stub(), over(128, 2.0), plain, fitted, SETTINGS)
    assert own.gain == pytest.approx(np.log(2.0))


def test_what_parameters_far_from_the_card_add_to_a_gain_is_told_apart(over, stub) -> None:
    found = judged(stub(), over(64, 2.0, implausible=0.2), over(64, 1.0), SETTINGS)
    assert found.gain == pytest.approx(np.log(2.0) + 0.2)
    assert found.of_errors == pytest.approx(np.log(2.0))
