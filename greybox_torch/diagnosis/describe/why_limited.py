"""Why no more is claimed for a finding than it is told with, where its rivals alone leave it more."""

from __future__ import annotations

from greybox_torch.diagnosis.confirm.beyond_chance import within_chance
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.select.all_that_is_left import Limit
from greybox_torch.diagnosis.settings import DiagnosisSettings


def why_limited(
    probability: float, limit: Limit | None, gain: Gain | None, settings: DiagnosisSettings
) -> tuple[str, ...]:
    """Clauses for a reader who sees a low probability beside strong evidence; none where nothing limits it.

    Seen: the stops of a ball in a tube, told with 0.50 beside "100 % of the ceiling" and "held out 89 %", and nothing that said why.

    Args:
        probability: of the finding, before ``limit``.
        gain: what it gains on held-out experiments.
    """
    told = []
    if within_chance(gain, settings):
        assert gain is not None
        away = (
            f"put it {gain.errors_away:.1f} standard errors from none" if gain.errors_away > 0 else "show nothing of it"
        )
        told.append(
            f"its probability allows for chance, as held-out experiments {away}, where "
            f"{settings.held_out_beyond_chance:.3g} standard errors are beyond chance"
        )
    if limit is not None and limit.highest < probability:
        told.append(f"no more than {limit.highest:.2f} is claimed for this name alone, as {limit.why}")
    return tuple(told)
