"""What is said of effects that windows bear out and free runs cannot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import greybox_torch.diagnosis.confirm.beyond_free_runs as beyond
from greybox_torch.diagnosis.confirm.beyond_free_runs import said_of_the_curve, said_of_windows
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.settings import DiagnosisSettings


def states(*prefixes: str) -> Any:
    effects = [
        SimpleNamespace(prefix=p, port=p.split(".")[0], mechanism=SimpleNamespace(name=p.split(".")[1], free=False))
        for p in prefixes
    ]
    return SimpleNamespace(effects=effects, prefixes=prefixes)


def judged(*fits: float) -> Any:
    scores = [SimpleNamespace(fit=fit, role="validation") for fit in fits]
    return SimpleNamespace(refit=SimpleNamespace(scores=[SimpleNamespace(fit=90.0, role="estimation"), *scores]))


@pytest.mark.parametrize(
    ("fits", "gain", "said"),
    [
        ((-727.8, -696.7), Gain(0.9994, 0.0002), True),
        ((95.0, 80.0), Gain(0.9994, 0.0002), False),  # free runs that follow have the last word
        ((-727.8,), Gain(0.3, 0.2), False),  # windows do not bear it out either
        ((), Gain(0.9994, 0.0002), False),
    ],
)
def test_it_is_said_where_windows_bear_an_effect_out_and_all_free_runs_are_lost(fits, gain, said) -> None:
    name = "joint.coulomb_friction"
    told = said_of_windows(
        states(name, "joint.end_stop"), states("joint.end_stop"), {name: gain}, judged(*fits), DiagnosisSettings()
    )
    assert len(told) == said
    assert not said or told[0].startswith("Coulomb friction at joint removes 99.9 % of the held-out squared error")


@pytest.mark.parametrize(("fit", "after", "said"), [(-22.0, 0.4, True), (60.0, 0.4, False), (-22.0, 1.0, False)])
def test_it_is_said_of_a_curve_of_which_no_names_lasted(monkeypatch, fit: float, after: float, said: bool) -> None:
    """A multicopter whose battery sags, beside one that free runs follow, and a curve that windows do not bear out."""
    curve: Any = SimpleNamespace(port="actuator", mechanism=SimpleNamespace(name="unknown_fading", free=True))
    best = SimpleNamespace(candidate=SimpleNamespace(attachment=curve), fitted=after)
    monkeypatch.setattr(beyond, "first_with_curves", lambda study, state: SimpleNamespace(parent=1.0))
    monkeypatch.setattr(beyond, "curves_of", lambda study, step: [best])
    energies = np.linspace(0.5, 1.5, 20)
    windows = SimpleNamespace(steps=20)
    others: Any = SimpleNamespace(fits=lambda by: (SimpleNamespace(energies=by * energies, windows=windows),))
    study: Any = SimpleNamespace(settings=DiagnosisSettings())
    told = said_of_the_curve(study, states(), others, judged(fit))
    assert len(told) == said
    assert not said or told[0].startswith("An unknown effect at actuator removes 60 % of the held-out squared error")
    assert said_of_the_curve(study, states(), None, judged(fit)) == ()
