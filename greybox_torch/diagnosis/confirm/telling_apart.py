"""Where the experiments that are chosen with leave a name undecided, one that tells the rivals apart is taken to choose with as well.

"These recordings do not tell them apart" has to be true of all the recordings at hand. Which experiment is taken follows from what the
rivals predict of it, not from which of them it bears out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.promotion import Promotion
from greybox_torch.diagnosis.confirm.standing import refinements, sizes
from greybox_torch.diagnosis.describe.divergence import of_errors
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.flexed import in_its_place
from greybox_torch.diagnosis.select.posterior import are_twins
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.select.undecided import undecided
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def promote_to_tell_apart(
    study: Study, dataset: DataSet, state: SearchState, others: HeldOut, gains: Mapping[str, Gain]
) -> Promotion | None:
    """The data set with the validation experiment among those to choose with on which what was found and a rival lie farthest apart.

    None where every finding is decided, where no experiment would tell, or where no validation experiment would be left.

    Args:
        gains: by effect, on held-out experiments.
    """
    recordings, settings = dataset.validation(), study.settings
    if len(recordings) < 2 or not state.effects:
        return None
    small = refinements(study, state, others, gains, sizes(study, state, gains))
    found: list[tuple[float, int, str]] = []
    own = others.errors(state.current)
    for effect in (e for e in state.effects if e.prefix not in small):
        for law, rival in _instead(study, state, effect):
            apart = [of_errors(*pair) for pair in zip(own, others.errors(rival), strict=False)]
            if apart and max(apart) > settings.telling_divergence:
                why = f"it tells {spoken_at(*law.named[::-1])} from {spoken_at(*effect.named[::-1])}"
                found.append((max(apart), int(np.argmax(apart)), why))
    if not found:
        return None
    _, where, why = max(found)
    return Promotion.of(dataset, recordings[where].name, why, same_effects=True)


def _instead(study: Study, state: SearchState, effect: Attachment) -> Iterator[tuple[Attachment, Hypothesis]]:
    """The rivals of an undecided effect, each with the state's hypothesis with it instead.

    Not what the laws themselves do not tell apart with one input and one output, whatever is recorded.
    """
    done = state.step_beside_others(effect.prefix)
    for rival in undecided(study, state, effect):
        assert done is not None and done.taken is not None
        fitted = None if are_twins(done.taken, rival) else in_its_place(study, state, effect, done, rival)
        if fitted is not None:
            yield rival.candidate.attachment, fitted
