"""What a choice between hypotheses is decided by."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.significance import white_samples
from greybox_torch.diagnosis.select import choice
from greybox_torch.diagnosis.select.choice import price_in_likelihood
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias

SETTINGS = DiagnosisSettings()


def test_every_further_parameter_has_the_price_of_schwarz(motor_data, motor, begun) -> None:
    search = begun(motor_data(torque=lambda q, v: 0.2, noise=0.1), motor)
    curve = search.refitted((attach(motor, "rotor", ConstantBias()),), search.plain)
    assert price_in_likelihood(search.plain, curve, SETTINGS) == pytest.approx(
        0.5 * np.log(white_samples(curve, SETTINGS))
    )
    assert price_in_likelihood(curve, curve, SETTINGS) == 0.0


@pytest.mark.parametrize(("parent", "lacks"), [(1e4, True), (10.0, False)])
def test_a_law_that_another_contains_lacks_little_beside_what_was_missing_before_it(monkeypatch, parent, lacks) -> None:
    """Seen: a reducer's Stribeck friction, told as Coulomb friction (0.85): little beside the wind on the antenna, found before."""
    monkeypatch.setattr(choice, "size", lambda whole, without, full, settings: (without - full) / whole)
    simpler, better = SimpleNamespace(fits=0.6), SimpleNamespace(fits=0.01)
    assert choice._lacks_little(SimpleNamespace(fits=parent), simpler, better, SETTINGS) is lacks  # type: ignore[arg-type]
