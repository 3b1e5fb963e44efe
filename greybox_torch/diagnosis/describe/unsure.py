"""What would explain much and is no finding: of the whole mismatch where nothing is found, and of what is left beside what was found."""

from __future__ import annotations

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.significance import too_few_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.remaining import leaves_little
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study

MUCH = 0.5
"""Share of the mean squared error that a candidate has to remove to be told."""

MUCH_OF_THE_REST = 0.2
"""The same of what is left beside what was found."""


def best_further(study: Study, state: SearchState) -> str:
    """A clause on the best candidate beside all that was found, which would lower the error beyond chance; "" where none would by much.

    Seen: a lag of an inverter that would lower the error by 51 % (16.5 standard errors), and the advice to look for a load.
    """
    beside = (s for s in reversed(state.steps) if {e.prefix for e in s.parent.effects} == state.prefixes)
    last = next(beside, None) if state.effects else None
    if last is None or last.taken is not None or not last.ranked:
        return ""
    best = last.ranked[0]
    if best.removed < MUCH_OF_THE_REST or best.significance <= study.settings.least_significance:
        return ""
    named = spoken_at(best.candidate.attachment.mechanism.name, best.candidate.attachment.port)
    told = f"{named} would take up {digits(100 * best.removed)} % of it over windows ({best.significance:.1f} standard errors)"
    if not leaves_little(study, state.plain, last.parent):
        return f"{told}, and was not taken"
    return f"{told}, and was not taken: {of_little(study.settings)}"


def of_little(settings: DiagnosisSettings) -> str:
    """Why what lowers the error significantly was not taken where little was left, a sentence without its capital and full stop."""
    return (
        f"less than {100 * settings.least_size:.2g} % of the mismatch was left, and there a further effect is a finding only if nothing "
        "but noise remains with it"
    )


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
