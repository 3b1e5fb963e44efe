"""The size of a law that a free curve, which joined it later, could draw as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.unknown import Unknown


@pytest.fixture
def with_curve(dead_zone_search):
    """Sizes beside one another of a law, taken first, and a curve: the law leaves 5 % of the error, the curve 2 %, both leave 1 %."""
    found = dead_zone_search

    def leaving(error: float, *effects):
        windows = (
            replace(
                f, energies=np.full_like(f.energies, error * np.sum(~np.isnan(f.problem.records.y)) / len(f.energies))
            )
            for f in found.plain.fits
        )
        return replace(found.plain, fits=tuple(windows), effects=effects)

    def make(mechanism, *, curve_first: bool = False):
        law, curve = (attach(found.study.problem.model, "rotor", m) for m in (mechanism, Unknown("speed", 6)))
        plain, both = leaving(1.0), leaving(0.01, law, curve)
        without = {law.prefix: leaving(0.02, curve), curve.prefix: leaving(0.05, law)}
        parent, fitted = (without[law.prefix], both) if curve_first else (plain, without[curve.prefix])
        taken = judged(Candidate(law, (), 0.5), parent, fitted, found.study.settings)
        step = SelectionStep((), parent, (taken,), taken)
        state = replace(found.state.at(both), plain=plain, steps=(step,), without=without)
        return sizes(found.study, state, {}), law.prefix, curve.prefix

    return make


def test_it_has_what_it_brought_before_the_curve_joined_it(with_curve) -> None:
    """Seen: the offset of an amplifier, 95 % of a circuit's mismatch, a refinement of 1 % beside a curve (0.97)."""
    by_effect, law, curve = with_curve(CoulombFriction())
    assert by_effect[law] == pytest.approx(0.95, rel=0.01)
    assert by_effect[curve] == pytest.approx(0.04, rel=0.05)


def test_beside_a_curve_that_was_there_first_it_is_what_that_lacks(with_curve) -> None:
    by_effect, law, _ = with_curve(CoulombFriction(), curve_first=True)
    assert by_effect[law] == pytest.approx(0.01, rel=0.05)


def test_a_law_that_no_curve_draws_is_what_leaving_it_out_brings_back(with_curve) -> None:
    by_effect, law, _ = with_curve(AdditionalMode())
    assert by_effect[law] == pytest.approx(0.01, rel=0.05)
