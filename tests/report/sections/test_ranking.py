"""What the screen saw, as a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.sections.ranking import Ranking


def test_an_effect_that_was_chosen_later_was_refitted(of_kind: Callable[[str], Verdict]) -> None:
    """Seen: "torque ripple at drum, chosen" beside "not refitted"; it was, beside the friction that the first step had taken."""
    rows = (
        ("gear_spring", "backlash", 0.44, None),
        ("motor", "gravity", 0.1, None),
        ("motor", "constant_bias", 0.2, 0.7),
    )
    ranked = Ranking.of(replace(of_kind("found"), ranking=rows))
    assert ranked is not None
    assert [row.removed for row in ranked.rows] == ["refitted later, beside others", "not refitted", "50 %"]


@pytest.mark.parametrize(
    ("others", "told"),
    [
        (
            [("motor", "stribeck_friction", 0.4, 9.5)],
            ["Stribeck friction at motor removed more than Coulomb friction at motor, which it contains"],
        ),
        (
            [("arm", "stribeck_friction", 0.4, 9.5)],
            ["Stribeck friction at arm removed more than Coulomb friction at motor: it is not"],
        ),
        (
            [("motor", "stribeck_friction", 0.4, 9.5), ("motor", "unknown", 0.4, 9.5)],
            [
                "Stribeck friction at motor removed more",
                "An unknown effect at motor removed more as well: it is not the error alone",
            ],
        ),
        (
            [("motor", "stribeck_friction", 0.4, 6.91), ("motor", "unknown", 0.5, None), ("arm", "gravity", 0.5, 0.1)],
            [],
        ),
    ],
)
def test_why_what_removed_more_was_not_chosen(of_kind: Callable[[str], Verdict], others: list, told: list[str]) -> None:
    """Seen: Coulomb friction (chosen), 99.9 %, above Stribeck friction, 100.0 %, and not a word on it."""
    found = of_kind("found")
    friction = replace(found.effects[0], port="motor", mechanism="coulomb_friction")
    rows = (("motor", "coulomb_friction", 0.5, 6.9), *others)
    ranked = Ranking.of(replace(found, effects=(friction,), ranking=rows))
    assert ranked is not None
    assert bool(ranked.passed_over) is bool(told)
    assert all(sentence in ranked.passed_over for sentence in told)
