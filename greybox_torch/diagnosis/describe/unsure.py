"""What would explain much of the mismatch and is not sure: to be told where nothing is found."""

from __future__ import annotations

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.significance import too_few_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings

MUCH = 0.5
"""Share of the mean squared error that a candidate has to remove to be told."""


def unsure_candidate(state: SearchState, settings: DiagnosisSettings) -> str:
    """A clause on the candidate that would explain most of the model's error and was not taken as it is not sure; "" where none would.

    Seen: "No law of the library explains it", and four lines below that gravity would lower the error by 89 % (2.4 standard errors).
    """
    tried = [r for step in state.steps if step.taken is None and not step.parent.effects for r in step.ranked]
    unsure = [r for r in tried if r.removed >= MUCH and r.significance <= settings.least_significance]
    best = max(unsure, key=lambda r: r.removed, default=None)
    if best is None:
        return ""
    attachment = best.candidate.attachment
    sure = (
        "there are too few windows to be sure"
        if too_few_windows(best.fitted, settings)
        else f"by only {best.significance:.1f} times its standard error, where {settings.least_significance:.3g} are required"
    )
    named, lowered = spoken_at(attachment.mechanism.name, attachment.port), digits(100 * best.removed)
    return f"{named} would lower its mean square by {lowered} %, but {sure}; more windows or longer records would tell"
