from __future__ import annotations

from greybox_torch.estimate.brief_lists import brief_pairs, brief_sentences
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.identifiability_sentences import Direction, sentence
from greybox_torch.name_lists import brief


def unmoved(name: str) -> Unidentifiable:
    step = Direction((name,), (1.0,), (True,))
    return Unidentifiable("unmoved", (name,), (1.0,), sentence("unmoved", step))


def weak(name: str, deviation: float) -> Unidentifiable:
    step = Direction((name,), (1.0,), (True,))
    return Unidentifiable("weak", (name,), (1.0,), sentence("weak", step, deviation=deviation))


def test_findings_that_are_alike_are_one() -> None:
    told = brief_sentences([unmoved("a"), weak("c", 1.5), unmoved("b"), weak("d", 20.0)])
    assert told == [
        "a and b: of each, nothing in these recordings depends on it; fix it, or record an experiment in which it acts",
        "weakly determined, with standard deviations of so many times their values: c 1.5, d 20; "
        "fix them, or record experiments in which they act more",
    ]


def test_lists_with_names_in_common_are_one() -> None:
    """Seen: "m_p and m_p: of each, cannot be told apart", where two lists began alike, and a third one besides."""
    lists = [["a", "b", "c", "d", "e", "f"], ["x", "y"], ["a", "b", "c", "d", "e", "g"], ["b", "h"]]
    steps = [Direction(tuple(names), (1.0,) * len(names), (True,) * len(names)) for names in lists]
    found = [Unidentifiable("start", s.names, s.changes, sentence("start", s)) for s in steps]
    whole = Direction(tuple("abcdefgh"), (1.0,) * 8, (True,) * 8)
    assert brief_sentences(found) == [found[1].sentence, sentence("start", whole)]


def test_one_finding_is_told_as_it_is() -> None:
    assert brief_sentences([unmoved("a")]) == [unmoved("a").sentence]
    assert brief_sentences([weak("a", 2.0)]) == [weak("a", 2.0).sentence]
    assert brief_sentences([]) == []


def test_of_many_the_first_are_told() -> None:
    steps = [Direction((f"a{k}", f"b{k}"), (1.0, 1.0), (True, True), "factor") for k in range(8)]
    found = [Unidentifiable("together", s.names, s.changes, sentence("together", s)) for s in steps]
    told = brief_sentences(found)
    assert told[:5] == [one.sentence for one in found[:5]]
    assert told[5:] == ["and 3 more findings of this kind, all of them in the JSON of the result"]


def test_start_states_of_several_experiments_are_one_entry() -> None:
    names = ["J", *[f"speed at the start of '{k}'" for k in range(7)], "angle at the start of 'a'"]
    assert brief(names) == "J, speed at the start of 7 experiments and angle at the start of 'a'"
    assert brief([f"p{k}" for k in range(20)]) == "p0, p1, p2, p3, p4 and 15 more"
    assert brief(["a", "b"]) == "a and b"


def test_changes_are_not_listed_without_end() -> None:
    step = Direction(tuple(f"p{k}" for k in range(9)), (1.0,) * 9, (True,) * 9)
    told = sentence("weak", step, deviation=2.0)
    assert told.startswith("p0, p1, p2, p3, p4 and 4 more: hardly told apart (raising p0 by 100 %")
    assert "p3 by 100 % and the others to match shows" in told
    assert len(told) < 300


def test_correlated_pairs_are_grouped() -> None:
    pairs = [("a", "b", 0.99), ("d", "e", -0.985), ("b", "c", -0.97), ("a", "c", -0.96)]
    assert brief_pairs(pairs) == "d and e -0.985; a, b and c (at least 0.960)"
