"""Effects tried without."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.refit.rank import RankedCandidate
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import backward
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction, StribeckFriction


def test_what_the_newest_effect_was_compared_with_is_not_refitted(dead_zone_search, monkeypatch) -> None:
    """Unless the hypothesis is no longer the one that was taken."""
    study, plain = dead_zone_search.study, dead_zone_search.plain
    old, new = Attachment("rotor", CoulombFriction()), Attachment("load", StribeckFriction())
    parent = replace(plain, effects=(old,), fits=tuple(replace(f, mean_square=9 * f.mean_square) for f in plain.fits))
    both = replace(plain, effects=(old, new))
    step = SelectionStep((), parent, (), RankedCandidate(Candidate(new, ({},), 1.0), both, 1.0, 9.0))
    monkeypatch.setattr(backward, "window_significance", lambda *_: 9.0)
    monkeypatch.setattr(backward, "absorbed", lambda *_: None)
    refits = []

    def refitted(study, rest, *_):
        refits.append(rest)
        return replace(parent, effects=rest)

    monkeypatch.setattr(backward, "refitted", refitted)
    state = result_of(drop_superfluous(study, SearchState(plain, both, (step,))))
    assert state.without[new.prefix] is parent
    assert refits == [(new,)]
    refits.clear()
    result_of(drop_superfluous(study, SearchState(plain, replace(both), (step,))))
    assert sorted(refits, key=str) == sorted([(old,), (new,)], key=str)
