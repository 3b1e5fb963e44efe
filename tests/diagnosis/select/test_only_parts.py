"""A search that finds small parts alone ends: what leaves more of the mismatch than any of three effects takes is not found by a fourth."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.diagnosis.select import only_parts as module
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.only_parts import only_parts
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of


def searched(
    monkeypatch, shares: list[float], points: float = 0.5, *, more_is_missing: bool = False
) -> tuple[Any, Any]:
    """A study and the state of its search that took effects with such shares of the mismatch, the fit rising by so many points."""
    left = [1.0 - sum(shares[:n]) for n in range(len(shares) + 1)]
    names = [f"port{n}.law" for n in range(len(shares))]
    models = [SimpleNamespace(fits=n) for n in range(len(shares) + 1)]
    steps = {
        name: SimpleNamespace(parent=models[n], taken=SimpleNamespace(fitted=models[n + 1]))
        for n, name in enumerate(names)
    }
    monkeypatch.setattr(module, "size", lambda plain, without, full, settings: left[without] - left[full])
    monkeypatch.setattr(module, "mismatch_share", lambda model, settings: 0.03 - points / 100.0 * (model.fits > 0))
    study = SimpleNamespace(settings=DiagnosisSettings(), more_is_missing=more_is_missing)
    state = SimpleNamespace(
        effects=tuple(names), prefixes=set(names), plain=models[0], current=models[-1], step_of=steps.get
    )
    return study, state


def test_three_small_laws_that_leave_more_than_any_of_them(monkeypatch) -> None:
    """Seen: a complete tape drive, told after two minutes and four laws, which were all taken back."""
    assert only_parts(*searched(monkeypatch, [0.315, 0.147, 0.078]))


@pytest.mark.parametrize(
    ("shares", "points", "more"),
    [
        ([0.315, 0.147], 0.5, False),
        ([0.5, 0.147, 0.078], 0.5, False),
        ([0.33, 0.33, 0.33], 0.5, False),
        ([0.315, 0.147, 0.078], 2.5, False),
        ([0.315, 0.147, 0.078], 0.5, True),
    ],
    ids=["two alone", "one that is larger", "nothing left", "the fit rises", "free runs show that more is missing"],
)
def test_else_the_search_goes_on(monkeypatch, shares, points, more) -> None:
    assert not only_parts(*searched(monkeypatch, shares, points, more_is_missing=more))


def test_an_effect_whose_step_is_not_on_record_is_no_part(monkeypatch) -> None:
    study, state = searched(monkeypatch, [0.315, 0.147, 0.078])
    state.step_of = {}.get
    assert not only_parts(study, state)


def test_no_step_follows(dead_zone_search, monkeypatch) -> None:
    search = dead_zone_search
    monkeypatch.setattr("greybox_torch.diagnosis.select.forward.only_parts", lambda study, state: True)
    monkeypatch.setattr("greybox_torch.diagnosis.select.forward.forward_step", None)
    start = SearchState(search.plain, search.plain)
    assert result_of(take_effects(search.study, start)) is start
