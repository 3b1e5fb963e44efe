"""The namespace that equations read: by attribute and by item, whatever the names are, and read-only."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.errors import UserError
from greybox_torch.model.signals import Signals

METHODS = ("items", "keys", "values", "get", "replaced")
NAMES = st.one_of(
    st.sampled_from([*METHODS, "_kind", "_values", "rail.coulomb"]), st.from_regex(r"[a-z]{1,8}", fullmatch=True)
)


@given(st.dictionaries(NAMES, st.floats(allow_nan=False), max_size=6))
def test_every_name_is_read_by_item_and_a_name_that_is_no_method_by_attribute(values: dict[str, float]) -> None:
    signals = Signals("parameter", values)
    assert dict(signals.items()) == values and len(signals) == len(values)
    for name, value in values.items():
        assert signals[name] == value
        if name not in METHODS and not name.startswith("_"):
            assert getattr(signals, name) == value
    assert dict(signals.replaced(more=1.0)) == {**values, "more": 1.0}


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(UserError, match=r"the state 'sped' .did you mean .speed.*declared: speed"):
        _ = Signals("state", {"speed": torch.tensor(1.0)}).sped


def test_nothing_can_be_set() -> None:
    signals = Signals("state", {"speed": 1.0})
    with pytest.raises(AttributeError, match="the state 'speed' is set"):
        signals.speed = 2.0
    assert signals.speed == 1.0
