"""What is said of effects that windows bear out and free runs cannot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.diagnosis.confirm.beyond_free_runs import said_of_windows
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.settings import DiagnosisSettings


def states(*prefixes: str) -> Any:
    effects = [
        SimpleNamespace(prefix=p, port=p.split(".")[0], mechanism=SimpleNamespace(name=p.split(".")[1]))
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
