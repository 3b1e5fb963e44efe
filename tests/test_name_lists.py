"""Names listed in a sentence, and how many more there are."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.name_lists import further, listed


@given(st.integers(1, 10**6), st.sampled_from(["row", "experiment"]))
def test_how_many_more(count: int, noun: str) -> None:
    """Seen: "(and 1 more rows)"."""
    told = further(count, noun)
    assert told.startswith(f"{count} more {noun}") and told.endswith("s") == (count != 1)


def test_listed() -> None:
    assert [listed(["a"]), listed(["a", "b"]), listed(["a", "b", "c"], "or")] == ["a", "a and b", "a, b or c"]
