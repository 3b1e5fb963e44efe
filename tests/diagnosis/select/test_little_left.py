"""Where so little of the mismatch is left that only what completes the model is taken, what cannot complete it is not refitted."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import forward_step as module
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.select.remaining import completes, left_to_complete
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag


def times_the_noise(fitted, study, *errors: float):
    """A hypothesis with errors of so many times the noise (root mean square) over the windows of every length."""
    floor = noise_floor(study.problem, study.settings)
    pairs = zip(fitted.fits, errors, strict=True)
    return replace(fitted, fits=tuple(replace(f, mean_square=error**2 * floor) for f, error in pairs))


@pytest.mark.parametrize(("errors", "share"), [((1.3, 1.3), 0.0), ((13.0, 1.0), 0.99), ((1.0, 6.5), 0.96)])
def test_what_has_to_go_is_of_the_length_that_lacks_most(dead_zone_search, errors, share) -> None:
    found, settings = dead_zone_search, dead_zone_search.study.settings
    rest = (1.0,) * (len(found.plain.fits) - 2)
    fitted = times_the_noise(found.plain, found.study, *errors, *rest)
    assert left_to_complete(fitted, settings) == pytest.approx(share, abs=1e-6)
    assert not completes(fitted, settings) or share == 0.0


@pytest.mark.parametrize("little", [True, False])
def test_only_what_promises_half_of_it_is_refitted_there(dead_zone_search, monkeypatch, little) -> None:
    """6.5 times the noise: 96 % have to go. What a search with fewer experiments found is tried whatever it promises."""
    study, model = dead_zone_search.study, dead_zone_search.study.problem.model
    errors = (6.5,) * len(dead_zone_search.plain.fits)
    state = dead_zone_search.state.at(times_the_noise(dead_zone_search.plain, study, *errors))
    drag, dry, bias = (attach(model, "rotor", law) for law in (QuadraticDrag(), CoulombFriction(), ConstantBias()))
    offered = [Candidate(drag, ({},), 0.47), Candidate(dry, ({},), 0.49)]
    known = Candidate(bias, ({},), 0.1, found_before=({},))
    asked: list[Candidate] = []
    monkeypatch.setattr(module, "little_is_left", lambda study, state: little)
    monkeypatch.setattr(module, "_worth_a_refit", lambda *_: offered)
    monkeypatch.setattr(module, "with_found_before", lambda study, state, found, curves: [*found, known])
    for name in ("from_card", "from_motion"):
        monkeypatch.setattr(module, name, lambda study, state, **_: [])
    monkeypatch.setattr(module, "rank", lambda study, current, found: asked.extend(found) or [])
    assert not result_of(forward_step(study, state)).took_one
    assert [k.attachment for k in asked] == ([dry, bias] if little else [drag, dry, bias])
