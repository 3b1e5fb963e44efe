"""Laws at the port of a leading free curve in their richer forms, as hypotheses."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.study import Study


def richer_forms(study: Study, port: str, laws: Iterable[tuple[Candidate, Hypothesis]]) -> list[Candidate]:
    """The laws at a port in the forms with more parameters that they have, from what they were fitted to.

    Where a free curve leads, dry friction that is much larger in one direction removes a part of what the curve does: plain. Not in a form
    that is there already under its own name: a second ripple, with harmonics, beside a first one that has them.
    """
    found = []
    for candidate, fitted in laws:
        effect, start = candidate.attachment, f"{candidate.attachment.prefix}."
        if effect.port != port:
            continue
        there = {p.name.rpartition(".")[0] for p in fitted.model.declared_parameters} - {effect.prefix}
        others = {n: v for n, v in fitted.values().items() if not n.startswith(start)}
        for mechanism, begun in effect.mechanism.richer(effect.own(fitted.values())):
            law = replace(effect, mechanism=mechanism)
            values = {**others, **{f"{law.prefix}.{n}": v for n, v in begun.items()}}
            if law.prefix not in there and not study.beliefs.exclude(law) and possible_form(study, law):
                found.append(Candidate(law, (values,), candidate.explained))
    return found
