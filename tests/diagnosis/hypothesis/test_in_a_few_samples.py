"""Laws that act in next to none of the samples that they were estimated from."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import in_a_few_samples as module
from greybox_torch.diagnosis.hypothesis.in_a_few_samples import acts_in_a_few_samples
from greybox_torch.diagnosis.refit import ranked
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.balance import LinearLeak, ThresholdFlow
from greybox_torch.mechanisms.end_stop import EndStop

SETTINGS = DiagnosisSettings()
LEVELS = np.r_[np.linspace(0.0, 5.0, 1000), np.full(SETTINGS.fewest_samples_of_a_law, 6.0), -1.0]


def asked(stub, monkeypatch, effect: Attachment, signal: str, along: np.ndarray, **values: float) -> bool:
    monkeypatch.setattr(module, "local_signals", lambda *_: {signal: along})
    monkeypatch.setattr(module, "AugmentedModel", stub)
    full = {f"{effect.prefix}.{name}": value for name, value in values.items()}
    fitted = stub(values=lambda: full, model=stub(), fits=[None], simulator=None)
    return acts_in_a_few_samples(fitted, effect, SETTINGS)


@pytest.mark.parametrize(("threshold", "few"), [(5.5, False), (6.0, True), (4.0, False), (6.5, True)])
def test_a_threshold_that_hardly_any_sample_lies_above_is_none(stub, monkeypatch, threshold, few) -> None:
    """Seen: a flow of 1800 per g/L above a level that one sample of 7800 lies above (0.97)."""
    flow = Attachment("growth", ThresholdFlow())
    assert asked(stub, monkeypatch, flow, "level", LEVELS, c=1800.0, threshold=threshold, width=0.0) is few


def test_one_sample_less_is_too_few(stub, monkeypatch) -> None:
    flow, fewer = Attachment("growth", ThresholdFlow()), np.delete(LEVELS, 1000)
    assert asked(stub, monkeypatch, flow, "level", fewer, c=1.0, threshold=5.5, width=0.0)


@pytest.mark.parametrize(("low", "few"), [(0.0, True), (0.5, False)])
def test_stops_at_both_ends_are_counted_together(stub, monkeypatch, low, few) -> None:
    """Below 0 lies a single sample, below 0.5 a tenth of them."""
    stops = Attachment("slide", EndStop(both=True))
    assert asked(stub, monkeypatch, stops, "position", LEVELS, k=1.0, c=0.0, low=low, high=6.0) is few


@pytest.mark.parametrize(("where", "side", "few"), [(5.5, 1.0, False), (-0.5, -1.0, True), (0.5, -1.0, False)])
def test_a_stop_at_one_end_counts_what_lies_beyond_it(stub, monkeypatch, where, side, few) -> None:
    stop = Attachment("slide", EndStop())
    assert asked(stub, monkeypatch, stop, "position", LEVELS, k=1.0, c=0.0, where=where, side=side) is few


@pytest.mark.parametrize(("limit", "softness", "few"), [(5.5, 0.0, False), (6.0, 0.0, True), (6.0, 0.5, False)])
def test_a_limit_that_is_nearly_a_clamp_acts_beyond_it(stub, monkeypatch, limit, softness, few) -> None:
    clamp = Attachment("actuator", TorqueSaturation())
    assert asked(stub, monkeypatch, clamp, "input", LEVELS, limit=limit, softness=softness) is few


def test_such_a_law_says_nothing_of_the_machine(stub, monkeypatch) -> None:
    """The search passes over what is not sound."""
    monkeypatch.setattr(ranked, "degenerate", lambda *a: None)
    monkeypatch.setattr(ranked, "grows_with_speed", lambda *a: False)
    found = stub(candidate=stub(attachment=Attachment("growth", ThresholdFlow())), fitted=stub(values=dict))
    study = stub(surroundings={}, settings=SETTINGS)
    for few in (True, False):
        monkeypatch.setattr(ranked, "acts_in_a_few_samples", lambda *a, few=few: few)
        assert ranked.sound(study, found) is not few


def test_a_law_that_acts_anywhere_is_not_asked(stub, monkeypatch) -> None:
    assert not asked(stub, monkeypatch, Attachment("tank", LinearLeak()), "level", LEVELS, c=1.0, reference=9.0)
