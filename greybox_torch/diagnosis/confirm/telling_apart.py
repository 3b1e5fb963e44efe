"""Where the experiments that are chosen with leave a name undecided, one that tells the rivals apart is taken to choose with as well.

"These recordings do not tell them apart" has to be true of all the recordings at hand. Which experiment is taken follows from what the
rivals predict of it, not from which of them it bears out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.promotion import Promotion
from greybox_torch.diagnosis.confirm.standing import findings
from greybox_torch.diagnosis.hypothesis.divergence import of_errors
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
    recordings = dataset.validation()
    if len(recordings) < 2 or not state.effects:
        return None
    found = findings(study, state, others, gains)
    asked = [(effect, *one) for effect in found for one in _instead(study, state, effect)]
    own = others.errors(state.current) if asked else ()
    told = [(*_farthest_apart(own, others.errors(rival)), effect, law) for effect, law, rival in asked]
    most, where, effect, law = max(told, key=lambda one: one[0], default=(0.0, 0, None, None))
    if effect is None or law is None or most <= study.settings.telling_divergence:
        return None
    why = f"it tells {spoken_at(*law.named[::-1])} from {spoken_at(*effect.named[::-1])}"
    return Promotion.of(dataset, recordings[where].name, why, same_effects=True)


def _farthest_apart(own: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> tuple[float, int]:
    """The largest log-likelihood ratio of two hypotheses on one experiment, and on which, from what each leaves of every experiment
    (n_y, N); zero where one cannot be simulated.
    """
    apart = [of_errors(*pair) for pair in zip(own, others, strict=False)]
    return max(apart, default=0.0), int(np.argmax(apart)) if apart else 0


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
