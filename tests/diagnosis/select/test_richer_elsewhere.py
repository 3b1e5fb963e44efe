"""A richer form that is another law is asked at joined bodies, too."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.select import forward
from greybox_torch.diagnosis.stopping import result_of


@pytest.mark.parametrize(("form", "asked"), [(("motor", "presliding"), True), (("motor", "coulomb"), False)])
def test_another_law_is_asked_at_joined_bodies(monkeypatch, stub, form, asked) -> None:
    """Seen: the bristles of an arm's bearing, told at the gear in front of it (0.97)."""

    def state(named: tuple[str, str]) -> Any:
        return stub(steps=(stub(taken=stub(candidate=stub(attachment=stub(named=named)))),))

    before, richer, moved = state(("motor", "coulomb")), state(form), state(("load", "presliding"))

    def with_richer_form(study: Any, given: Any) -> Any:
        assert given is before
        yield richer
        return richer

    monkeypatch.setattr(forward, "with_richer_form", with_richer_form)
    monkeypatch.setattr(forward, "at_joined_bodies", lambda study, given: moved if given is richer else None)
    assert result_of(forward._in_richer_form(stub(), before)) is (moved if asked else richer)
