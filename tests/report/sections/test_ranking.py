"""What the screen saw, as a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

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
