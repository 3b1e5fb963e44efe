"""What a reader is told who sees a low probability beside strong evidence."""

from __future__ import annotations

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.describe.why_limited import why_limited
from greybox_torch.diagnosis.select.all_that_is_left import Limit
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


def test_what_limits_a_finding_is_told_where_it_does() -> None:
    """Seen: the stops of a ball in a tube, 0.50 beside "100 % of the ceiling" and "held out 89 %"."""
    limit, sure = Limit(0.5, "free runs miss 18 %"), Gain(0.89, 0.025)
    assert why_limited(0.97, limit, sure, SETTINGS) == (
        "no more than 0.50 is claimed for this name alone, as free runs miss 18 %",
    )
    assert why_limited(0.45, limit, sure, SETTINGS) == why_limited(0.97, None, None, SETTINGS) == ()
    assert len(why_limited(0.55, limit, Gain(0.17, 0.14), SETTINGS)) == 2
    (nothing,) = why_limited(0.55, None, Gain(-0.17, 0.14), SETTINGS)
    assert "held-out experiments show nothing of it" in nothing
