"""A law that ends worse than the model without it was led into another valley."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.screen.shortlist import shortlist
from greybox_torch.diagnosis.select.offered import screen_scores


@pytest.mark.parametrize(("ends", "again", "gains"), [(1.5, 0.8, True), (1.5, 2.0, False), (0.9, None, True)])
def test_a_refit_in_full_that_ends_worse_than_without_the_effect_begins_again_from_there(
    dead_zone_search, monkeypatch, ends: float, again: float | None, gains: bool
) -> None:
    """Seen: the second loss of two real heaters: -0.23 from where its trial led, 0.65 from the model with the first one."""
    found, asked, current = dead_zone_search, [], dead_zone_search.state.current
    (one, *_) = shortlist(found.study, screen_scores(found.study, found.state, curves=False, fine=False), current.fits)

    def fit(study: Any, effects: Any, starts: Any, *given: Any, at: Any = None, **how: Any) -> Any:
        if at:
            return replace(current, fits=tuple(replace(f, mean_square=0.8 * f.mean_square) for f in current.fits[1:2]))
        asked.append((starts[0], how.get("beside"), how.get("absent")))
        times = ends if len(asked) == 1 else again
        return replace(current, fits=tuple(replace(f, mean_square=times * f.mean_square) for f in current.fits))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.laws_behind_curve", lambda *_: [])
    candidate = replace(one, absent={"size": 0.0}, steps=current.fits[1].windows.steps)
    (ranked,) = rank(found.study, current, [candidate])
    assert (ranked.gain > 0) is gains
    assert len(asked) == (1 if again is None else 2)
    if again is not None:
        begun, beside, absent = asked[-1]
        assert beside is current and absent == {"size": 0.0}
        assert begun == {**current.values(), "size": 0.0}
