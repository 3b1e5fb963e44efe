"""What is said where a diagnosis has left nothing that a recording could decide."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.api.expected import NOTHING, WANTED, decided
from greybox_torch.api.hypotheses import Hypotheses, Kept, left_out_told, to_tell_apart
from greybox_torch.api.inseparable import inseparable, told_one_effect
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.verdict import OF_ESTIMATION
from greybox_torch.errors import NothingToDo
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.name_lists import listed

_NOTHING = "nothing to design"
_OR_A_PARAMETER = "or a parameter whose standard deviation is to shrink: --precision PARAMETER (in Python: precision=)"


def group_in_question(held: Hypotheses) -> Sequence[Kept]:
    """The hypotheses that a recording is to tell apart.

    Raises:
        NothingToDo: there are no rivals, one hypothesis is decided, or all are one effect in the model.
    """
    group, left_out = to_tell_apart(held)
    told = "".join(f". {sentence.rstrip('.')}" for sentence in left_out_told(left_out))
    if len(group) < 2:
        raise NothingToDo(
            f"{_NOTHING}: the diagnosis left no rivals to tell apart{_all_the_same(held)}; expected a finding with named alternatives, "
            f"{_OR_A_PARAMETER}{told}{_better_known(held)}"
        )
    if decided([kept.probability for kept in group]):
        best = max(group, key=lambda kept: kept.probability)
        raise NothingToDo(
            f"{_NOTHING}: {_decided(best, held.complete)}"
            f"{_all_the_same(held)}; expected a finding that is open, {_OR_A_PARAMETER}{told}"
        )
    if same := inseparable(group):
        raise NothingToDo(
            f"{_NOTHING}: {told_one_effect(same)}{_all_the_same(held)}; expected a finding that a recording can decide, "
            f"{_OR_A_PARAMETER}{told}"
        )
    return group


def _better_known(held: Hypotheses) -> str:
    """Sentences, without the last full stop, on how the curves of unknown effects become better known; "" where there are none."""
    model = held.recommended.model
    if not isinstance(model, AugmentedModel):
        return ""
    told = ""
    for one in model.attachments:
        site = next(port for port in model.base.all_ports if port.name == one.port)
        names = [signal_name(model.base, site, signal) for signal in one.mechanism.signals()]
        if one.mechanism.free and names:
            go, of_each = (
                ("goes over its whole range", "")
                if len(names) == 1
                else ("go over their whole ranges", "of each other and ")
            )
            told += (
                f". The unknown effect at {one.port} is known better, and told from one over another signal, by recordings in which "
                f"{listed(names)} {go}, independently {of_each}of all other signals"
            )
    return told


def _all_the_same(held: Hypotheses) -> str:
    """What the verdict leaves beside its findings, in its first sentence, and why no input is designed for it; "" where nothing is."""
    if not held.left:
        return ""
    first = held.left.partition(f" {OF_ESTIMATION}")[0].rstrip(".")  # names of experiments have full stops, too
    return (
        f". The verdict leaves some error all the same. {first}. No hypothesis says what that is, so no "
        "input can be designed for it (greybox residuals draws it)"
    )


def _decided(best: Kept, complete: bool) -> str:
    """How sure the hypothesis is that has no rival, and why the verdict is less sure of it where that is so."""
    alone = f"each rival less than {NOTHING:g}"
    if best.in_verdict is None or best.in_verdict >= WANTED:
        return f"between the named hypotheses all is already decided: {best.name} has a probability of {best.probability:.2f}, {alone}"
    why = (
        "; ".join(best.limited) or "see its evidence in the report"
        if complete
        else "the search was stopped before all was tried: diagnose once more without a time limit"
    )
    return (
        f"of the named hypotheses the recordings leave {best.name} alone ({alone}), and no recording has to tell it from them; that its "
        f"probability is {best.in_verdict:.2f} has another reason: {why}"
    )
