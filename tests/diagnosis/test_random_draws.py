"""Diagnoses of random small machines, drives, noise and spoiled records: no traceback, no contradiction, "nothing" on complete models."""

from __future__ import annotations

import importlib.util
import json
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from greybox_torch.diagnosis.contradictions import contradictions
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.files import json_text
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import load_model

DRAWS, PART = 300, 20
LIMIT = 0.03
"""Seconds after which the search of a draw stops: what is asked here holds of every answer, that of a stopped search included."""

NOISE = (0.003, 0.01, 0.03, 0.1)
"""Of the draws that are searched to the end, in units of what the machine reaches."""
COMPLETE = len(NOISE)


@pytest.fixture(scope="module")
def draws() -> ModuleType:
    """`random_draws.py` beside this file."""
    spec = importlib.util.spec_from_file_location("random_draws", Path(__file__).with_name("random_draws.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look their own module up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def models(draws: ModuleType, machines: Path) -> dict[str, GreyBoxModel]:
    return {m.name: load_model(f"{machines / 'small.py'}:{m.name}") for m in draws.MACHINES}


@pytest.mark.parametrize("first", range(0, DRAWS, PART))
def test_random_draws(first: int, draws: ModuleType, models: dict[str, GreyBoxModel]) -> None:
    wrong, answered = [], 0
    for seed in range(first, first + PART):
        drawn = draws.draw(seed, 80, 160)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                verdict = diagnose(drawn.data(), models[drawn.machine.name], time_limit=LIMIT).verdict
        except (UserError, NumericalError) as error:
            if "short" not in drawn.flaws:
                wrong.append(f"{drawn}: {error}")
            continue
        answered += 1
        said = json.loads(json_text(verdict.as_json()))
        wrong += [f"{drawn}: {what}" for what in contradictions(said)]
        if drawn.complete and said["mismatch"]:
            wrong.append(f"{drawn}: {verdict.sentence}")
    assert not wrong, "\n".join(wrong)
    assert answered > PART // 2


def test_draws_hold_what_they_say(draws: ModuleType) -> None:
    """All machines, effects, drives and flaws occur among them, and the machine without effect settles where its equation says."""
    drawn = [draws.draw(seed, 80, 160) for seed in range(DRAWS)]
    assert {d.machine.name for d in drawn} == {m.name for m in draws.MACHINES}
    assert {d.effect for d in drawn} == set(draws.EFFECTS) and sum(d.complete for d in drawn) > 60
    assert {k for d in drawn for k in d.drives} == set(draws.DRIVES)
    assert {f for d in drawn for f in d.flaws} == set(draws.FLAWS)
    rotor = draws.MACHINES[0]
    speed = draws.integrated(rotor, np.ones((1, 800)), np.zeros(1), "none")[:, 0]
    assert speed == pytest.approx(2.0 * (1.0 - np.exp(-2.5 * 0.01 * np.arange(800))), abs=1e-8)


@pytest.mark.parametrize("name", ["Rotor", "Slide", "Tank", "Cart", "WarmRotor"])
def test_nothing_is_missing_from_complete_models(name: str, draws: ModuleType, models: dict[str, GreyBoxModel]) -> None:
    """The search goes to its end, and claims nothing."""
    own = (d for d in (draws.draw(seed, 100, 200) for seed in range(1000, 1100)) if d.machine.name == name)
    long = [d for d in own if "short" not in d.flaws][:COMPLETE]
    drawn = [
        replace(d, effect="none", flaws=d.flaws & {"gaps", "lone gap", "far"}, noise=noise)
        for d, noise in zip(long, NOISE, strict=True)
    ]
    for one in drawn:
        verdict = diagnose(one.data(), models[name]).verdict
        assert verdict.complete and not verdict.mismatch, f"{one}: {verdict.sentence}"
        assert contradictions(verdict.as_json()) == [] and verdict.sentence.startswith("Nothing is missing")
