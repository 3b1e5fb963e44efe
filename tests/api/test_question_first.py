"""When a diagnosis asks about channels, and that the question leads where it explains far more."""

from __future__ import annotations

import importlib
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.api.short_refits import Asked
from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.pipeline import Diagnosis
from tests.diagnosis.test_slip_first import ASKED, CURVE, LEAD, verdict

diagnosing = importlib.import_module("greybox_torch.api.diagnose")
MODEL: Any = SimpleNamespace(all_ports=())

AT_ITS_BOUND = Estimate("m", "kg", 1.0, (0.1, None), (0.1, None), (True, True))
FRICTION = replace(CURVE, port="carriage", mechanism="coulomb_friction")


@pytest.mark.parametrize("at_bound", [True, False])
def test_beside_a_good_fit_it_is_asked_where_a_parameter_is_at_its_bound(at_bound: bool, monkeypatch) -> None:
    """Seen: rpm read as rad/s, told as friction (98.3 %) with a carriage of 0.1 kg at its bound, and nothing asked."""
    calls = []
    monkeypatch.setattr(diagnosing, "asked_where_poor", lambda *given: calls.append(given) or Asked(ASKED, 99.5, LEAD))
    found = replace(verdict(98.3, FRICTION, before=20.0), parameters=(AT_ITS_BOUND,) if at_bound else ())
    before = Diagnosis(found, None, {}, {}, [])  # pyright: ignore[reportArgumentType]
    told = diagnosing._with_question(before, None, MODEL, "cpu", print, Deadline.after(60.0)).verdict
    assert len(calls) == at_bound
    assert told.sentence.startswith(f"{LEAD}, a short refit leaves far less") is at_bound
    assert told.confidence == (0.5 if at_bound else 0.97)
