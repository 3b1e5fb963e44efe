"""Of a model that leaves little more than noise a search ends where what was found is a small part of that."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.select import forward as module
from greybox_torch.diagnosis.select.forward import take_effects
from greybox_torch.diagnosis.select.remaining import little_things_are_missing
from greybox_torch.diagnosis.stopping import result_of
from tests.diagnosis.select.test_little_left import times_the_noise


@pytest.mark.parametrize(
    ("before", "after", "little"),
    [
        (2.0, 1.87, True),  # 17 % of what is beyond the noise
        (2.0, 1.6, False),  # 48 %
        (6.0, 5.6, False),  # much is missing
        (2.0, 2.0, True),
    ],
)
def test_little_is_missing_and_little_of_that_was_found(dead_zone_search, stub, before, after, little) -> None:
    """Seen: a complete robot's wrist, 2 times the noise: four laws of 10 % each, no answer after 124 s; now 38."""
    study = dead_zone_search.study
    plain, current = (times_the_noise(dead_zone_search.plain, study, *[e] * 3) for e in (before, after))
    state = stub(effects=("lag",), plain=plain, current=current)
    assert little_things_are_missing(study, state) is little
    assert not little_things_are_missing(study, stub(effects=(), plain=plain, current=plain)), "nothing was looked for"
    assert not little_things_are_missing(replace(study, more_is_missing=True), state), "free runs show more"


@pytest.mark.parametrize("curves", [True, False])
def test_then_no_further_step_is_made_but_for_names_in_the_place_of_a_curve(
    dead_zone_search, monkeypatch, curves: bool
) -> None:
    asked: list[bool] = []

    def step(study, state, *, curves, **rest):
        asked.append(curves)
        yield from ()
        return replace(state, steps=())

    monkeypatch.setattr(module, "little_things_are_missing", lambda study, state: True)
    monkeypatch.setattr(module, "_done", lambda study, state: False)
    monkeypatch.setattr(module, "forward_step", step)
    result_of(take_effects(dead_zone_search.study, dead_zone_search.state, curves=curves))
    assert asked == ([] if curves else [False])
