"""What held-out experiments do not exercise, those that chose it have to say the size of."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import exercised, take_back
from greybox_torch.diagnosis.confirm.exercised import hardly_exercised
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.settings import DiagnosisSettings

WITHOUT, FULL = "without the stop", "with the stop"


@pytest.fixture
def asked(stub, monkeypatch):
    """Asks about a stop that changes the mean squared error by so much where it was chosen, and so much elsewhere, at two lengths."""

    def windows(errors: tuple[float, float]):
        return [stub(energies=np.full(4, 25.0 * e), problem=stub(samples=100)) for e in errors]

    def ask(chosen_with: tuple[float, float], held_out: tuple[float, float], share: float = 0.05, effects: int = 2):
        on_estimation = {WITHOUT: tuple(1.0 + c for c in chosen_with), FULL: (1.0, 1.0)}
        without = stub(name=WITHOUT, simulator=stub(with_substeps=lambda count: count))
        current = stub(name=FULL, simulator=without.simulator, values=dict)
        monkeypatch.setattr(exercised, "held_out_fits", lambda h, *rest: windows(on_estimation[h.name]))
        settings = DiagnosisSettings()
        study = stub(settings=settings, options=stub(substeps=1), problem=None, budget=None)
        full = tuple(windows((1.0, 1.0)))
        others = stub(
            study=study,
            fits_at=lambda hypothesis, values: windows(tuple(1.0 + c for c in held_out)),
            fits=lambda hypothesis: full,
        )
        state = stub(plain="plain", current=current, effects=("",) * effects, without={"motor.end_stop": without})
        monkeypatch.setattr(take_back, "gain", lambda before, after: Gain(share, 0.01))
        monkeypatch.setattr(take_back, "size", lambda *args: 2e-4)
        monkeypatch.setattr(take_back, "timelines", lambda *args: ())
        (found,) = take_back.held_out_gains(state, others).values()
        there = tuple(others.fits_at(without, {}))
        return hardly_exercised(study, state, "motor.end_stop", there, full), found.untouched

    return ask


@pytest.mark.parametrize(
    ("chosen_with", "held_out", "hardly"),
    [
        ((0.5, 0.2), (0.0, 0.0), True),
        ((0.5, 0.2), (0.002, -0.1), True),
        ((0.5, 0.2), (0.0, 0.1), False),
        ((0.0, 0.0), (0.0, 0.0), False),
    ],
)
def test_what_is_reached_once_is_as_large_as_where_it_is_reached_often(asked, chosen_with, held_out, hardly) -> None:
    """Seen: a motor's stop, 10 % of the mismatch where it was chosen and 0.02 % elsewhere, was told as too small for a finding."""
    assert asked(chosen_with, held_out) == (hardly, hardly)


def test_it_is_asked_beside_others_alone_and_where_it_does_no_harm(asked) -> None:
    """What is all that was found, and shows nothing elsewhere, may be a disturbance of the one experiment."""
    assert asked((0.5, 0.2), (0.0, 0.0), effects=1) == (True, False)
    assert asked((0.5, 0.2), (0.0, 0.0), share=-0.05) == (True, False)
