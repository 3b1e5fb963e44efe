"""Which trials are refitted in full."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.shortlist import shortlist
from greybox_torch.diagnosis.select.offered import screen_scores


def refitted_in_full(found: Any, **settings: float) -> list[str]:
    """What :func:`rank` refits in full of the named candidates that the screen passes on."""
    told: list[str] = []
    study = replace(found.study, report=told.append, settings=replace(found.study.settings, **settings))
    screened = screen_scores(study, found.state, curves=False, fine=False)
    told.clear()
    rank(study, found.state.current, shortlist(study, screened, found.state.current.fits))
    return [text for text in told if text.endswith("in full")]


def test_far_behind_the_best_trial_none_is_refitted_unless_the_best_do_not_pay(dead_zone_search) -> None:
    everyone = refitted_in_full(dead_zone_search, finalist_share=0.0)
    near = refitted_in_full(dead_zone_search, finalist_share=0.9)
    assert near[0] == "refitting actuator.actuator_deadzone in full"
    assert 0 < len(near) < len(everyone)
    unsure = refitted_in_full(dead_zone_search, finalist_share=0.9, least_significance=1e9)
    assert sorted(unsure) == sorted(everyone)
