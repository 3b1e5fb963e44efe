"""The second way of a search: from an effect that explains short windows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from greybox_torch.diagnosis.select import explore
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep


@pytest.mark.parametrize(
    ("beside", "taken", "accepted"),
    [
        (("friction",), None, True),
        ((), None, False),
        ((), False, True),
        ((), True, False),
        (("friction",), True, False),
    ],
    ids=["needed no more", "nothing led to", "chosen again", "a curve instead", "a curve beside"],
)
def test_what_a_given_effect_led_to_stands_where_it_is_chosen_again_or_needed_no_more(
    monkeypatch: pytest.MonkeyPatch, stub: Any, beside: tuple[str, ...], taken: bool | None, accepted: bool
) -> None:
    """Seen: from hysteresis at a gearbox to dry friction at the arm, which left noise alone, and was thrown out with its beginning.

    Args:
        beside: what the given effect led to.
        taken: what the last step takes, a curve or a name; None: nothing.
    """
    given, others = stub(prefix="given"), tuple(stub(prefix=name) for name in beside)
    plain = stub(effects=(), score=0.0)
    start = SearchState(plain, plain)
    first = start.at(stub(effects=(stub(prefix="first"),), score=-1.0))

    def refitted(study: Any, effects: Any, *_: Any) -> Any:
        return stub(effects=effects, score=-2.0)

    def took(study: Any, state: SearchState) -> Iterator[SearchState]:
        yield from ()
        led_to = stub(effects=(given, *others), score=-1.9)
        return replace(state.at(led_to), steps=(*state.steps, *(stub(taken=e) for e in others)))

    def once_more(study: Any, state: SearchState) -> Iterator[SearchState]:
        yield from ()
        curve = stub(unknown=taken)
        step = SelectionStep((), state.current, (curve,), None if taken is None else curve)
        current = state.current if taken is None else stub(effects=(*others, given), score=-2.1)
        return replace(state.at(current), steps=(*state.steps, step))

    for name, stage in (("refitted", refitted), ("take_effects", took), ("forward_step", once_more)):
        monkeypatch.setattr(explore, name, stage)
    found, stands = explore._from_given(stub(), start, first, stub(attachment=given, starts=()))
    assert stands is accepted
    if accepted:
        assert [e.prefix for e in found.effects] == [*beside, *([] if taken is None else ["given"])]
