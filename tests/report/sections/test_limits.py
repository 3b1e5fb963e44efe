from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.sections.limits import Limits


def test_says_how_much_could_hide_and_what_would_show_it(of_kind: Callable[[str], Verdict]) -> None:
    limits = Limits.of(of_kind("nothing"))
    assert limits is not None
    size, band = limits.sentences
    assert size.startswith("The error that remains in motor speed is 0.05")
    assert "rad/s (root mean square), 0.7 % of the measured signal's own variation" in size
    assert "motor speed does not stand out from the error" in band
    assert [(s.mechanism, s.port) for s in limits.suggestions] == [
        ("backlash", "gear_spring"),
        ("Coulomb friction", "motor"),
    ]
    assert "slow reversals" in limits.suggestions[1].experiment


def test_mechanisms_of_the_user_may_suggest_nothing(of_kind: Callable[[str], Verdict]) -> None:
    verdict = replace(of_kind("nothing"), ranking=(("motor", "my_own_law", 0.1, None),))
    limits = Limits.of(verdict)
    assert limits is not None
    assert limits.suggestions == ()


def test_a_large_error_is_not_passed_over(with_traces: Callable[..., Verdict]) -> None:
    found = with_traces(("A", "estimation", 0.05), ("B", "validation", 3.0))
    limits = Limits.of(replace(found, effects=()))
    assert limits is not None
    assert limits.sentences[0].startswith(
        "The error in motor speed is large all the same, up to 30 % of the signal's variation"
    )
    assert limits.sentences[1].startswith("It is 35 times larger in the validation experiments")
    alike = with_traces(("A", "estimation", 3.0), ("B", "validation", 3.0))
    again = Limits.of(replace(alike, effects=()))
    assert again is not None
    assert sum("large" in sentence for sentence in again.sentences) == 1


def test_only_where_nothing_is_missing(of_kind: Callable[[str], Verdict]) -> None:
    assert Limits.of(of_kind("found")) is None
