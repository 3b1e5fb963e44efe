"""Dry friction that is stiff gets the steps that it needs, and no more where they bring little."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction


@pytest.mark.parametrize(("promise", "begun_with"), [(0.9, [1, 8, 8]), (0.2, [1, 1])])
def test_dry_friction_that_comes_to_less_than_promised_is_tried_in_finer_steps(
    dead_zone_search, monkeypatch, promise: float, begun_with: list[int]
) -> None:
    """Seen: the packing of a valve sampled at 500 Hz; in steps of a sample its tangents grew, and a ripple over the position was told."""
    study, current, substeps = dead_zone_search.study, dead_zone_search.state.current, []
    dry = attach(study.problem.model, "rotor", CoulombFriction())
    start = {f"{dry.prefix}.{name}": value for name, value in (("F_c", 0.1), ("v_0", 0.05))}

    def fit(study: Any, effects: Any, starts: Any, *, simulator: Any, at: Any = None, **how: Any) -> Any:
        assert not effects or simulator.substeps == effects[-1].substeps
        substeps.append(simulator.substeps)
        better = 0.8 if simulator.substeps == 1 else 0.1
        fits = current.fits[1:2] if at else current.fits
        return replace(current, fits=tuple(replace(f, mean_square=better * f.mean_square) for f in fits))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    candidate = Candidate(dry, (start,), promise, steps=current.fits[1].windows.steps)
    (ranked,) = rank(study, current, [candidate])
    assert substeps == begun_with
    assert ranked.candidate.attachment.substeps == begun_with[-1]


def test_finer_steps_are_kept_only_where_they_bring_much(dead_zone_search, monkeypatch) -> None:
    """Seen: a positioning stage (EMPS), whose friction is not stiff; with eight times the steps for next to nothing it did not end."""
    study, current = dead_zone_search.study, dead_zone_search.state.current
    dry = attach(study.problem.model, "rotor", CoulombFriction())
    start = {f"{dry.prefix}.{name}": value for name, value in (("F_c", 0.1), ("v_0", 0.05))}

    def fit(*given: Any, simulator: Any, at: Any = None, **how: Any) -> Any:
        better = 0.8 if simulator.substeps == 1 else 0.75
        fits = current.fits[1:2] if at else current.fits
        return replace(current, fits=tuple(replace(f, mean_square=better * f.mean_square) for f in fits))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    (ranked,) = rank(study, current, [Candidate(dry, (start,), 0.9, steps=current.fits[1].windows.steps)])
    assert ranked.candidate.attachment.substeps == 1
