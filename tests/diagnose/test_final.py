"""The final fits on whole records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnose.candidates import attach
from greybox_torch.diagnose.final import _from_the_card, finish
from greybox_torch.mechanisms.forces import ConstantBias


@pytest.fixture(scope="module")
def search(motor_data, motor, begun):
    found = begun(motor_data(torque=lambda q, v: 0.05, noise=0.02), motor)
    found.current = found._refitted((attach(motor, "rotor", ConstantBias()),), found.plain)
    return found


def lost(hypothesis, name: str):
    """The hypothesis as if windows had led to where whole records overflow."""
    fits = []
    for fit in hypothesis.fits:
        values = fit.problem.values.copy()
        values[fit.problem.names.index(name)] = 1e-9
        fits.append(replace(fit, problem=fit.problem.with_values(values)))
    return replace(hypothesis, fits=tuple(fits))


def test_the_card_has_the_machine_and_the_windows_have_the_effect(search) -> None:
    """Only what the machine has itself begins anew: an effect's size on the card is none."""
    begins, windows = _from_the_card(search.current), search.current.values()
    values = dict(zip(begins.names, begins.values, strict=True))
    assert values["rotor.constant_bias.bias"] == windows["rotor.constant_bias.bias"] == pytest.approx(0.05, rel=0.05)
    card = dict(zip(search.problem.names, search.problem.values, strict=True))
    assert {n: values[n] for n in card} == card and card != {n: windows[n] for n in card}


def test_where_windows_led_astray_the_card_is_a_beginning(search) -> None:
    right, astray = finish(search.current, 1), finish(lost(search.current, "J"), 1)
    assert astray.uncertainty is not None
    assert np.allclose(astray.problem.values, right.problem.values, rtol=1e-3)
