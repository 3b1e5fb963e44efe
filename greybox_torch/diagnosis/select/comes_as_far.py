"""Whether a hypothesis with less in it is as good as the one with more."""

from __future__ import annotations

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import window_significance
from greybox_torch.diagnosis.refit.likelihood import needed_by_likelihood
from greybox_torch.diagnosis.select.choice import least_gain
from greybox_torch.diagnosis.study import Study


def comes_as_far(study: Study, less: Hypothesis, more: Hypothesis) -> bool:
    """Whether a hypothesis without an effect, or with a law in a plainer form, is as good as the one with it.

    Where windows are too few to say, the likelihood of whole records does, as where the effect was taken. Seen: the cogging of a stage,
    taken by that and dropped by windows (2.9 standard errors), which removed 61 % of what its friction left; then that was no longer right.
    """
    settings = study.settings
    if less.score - more.score < least_gain(more, settings):
        return True
    by_chance = window_significance(less, more, settings) < settings.least_significance
    curves = any(e.mechanism.free for e in more.effects)
    return by_chance and (curves or not needed_by_likelihood(less, more, settings))
