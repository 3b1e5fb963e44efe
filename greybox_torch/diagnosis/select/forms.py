"""The forms with more parameters that a law which was found may take: its own, and laws of the library that contain it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism

Begun = tuple[Mechanism, Mapping[str, float]]
"""A law, and its parameters to begin with."""


def forms(
    effect: Attachment, state: SearchState, beliefs: Beliefs, begun: Mapping[str, float] | None = None
) -> Iterator[tuple[Attachment, dict[str, float]]]:
    """The richer forms of an effect, and the laws that contain it, that are not there already under their own name, and all parameters to
    begin with.

    Neither among what was found nor among what the model was given with; none that ``beliefs`` exclude.

    Args:
        begun: the values that they begin with; by default those of the state.
    """
    given = {p.name.rpartition(".")[0] for p in state.plain.model.declared_parameters}
    start, values = f"{effect.prefix}.", begun or state.current.values()
    others = {n: v for n, v in values.items() if not n.startswith(start)}
    own = effect.own(values)
    for mechanism, own_start in (*effect.mechanism.richer(own), *_containing(effect, own, state)):
        law = replace(effect, mechanism=mechanism)
        if law.prefix not in (state.prefixes | given) - {effect.prefix} and not beliefs.exclude(law):
            yield law, {**others, **{f"{law.prefix}.{n}": v for n, v in own_start.items()}}


def forms_of_both(
    effect: Attachment, newest: Attachment, before: SearchState, after: SearchState, beliefs: Beliefs
) -> Iterator[tuple[Attachment, dict[str, float]]]:
    """The richer forms of an effect, and those of the newest one at its port that have in them what it is, such as a mean level.

    A form that stands for both begins with what the two came to.
    """
    for law, start in forms(effect, before, beliefs):
        if not law.mechanism.stands_for:
            yield law, start
    for own, other in ((effect, newest), (newest, effect)):
        for law, start in forms(own, before, beliefs, after.current.values()):
            if other.mechanism.name in law.mechanism.stands_for:
                theirs = _of_the_other(law, start, other, after)
                both = start | {n: v for n, v in theirs.items() if start[n] == 0.0}
                yield law, both
                width = f"{law.prefix}.v_0"
                if width in theirs:  # within which friction changes its sign: either may be the one law's
                    yield law, both | {width: theirs[width]}


def _of_the_other(
    law: Attachment, start: Mapping[str, float], other: Attachment, after: SearchState
) -> dict[str, float]:
    """What ``law`` begins with and ``other`` has under the same name, as that one has it."""
    named = {f"{law.prefix}.{n}": v for n, v in other.own(after.current.values()).items()}
    return {n: v for n, v in named.items() if n in start}


def _containing(effect: Attachment, own: Mapping[str, float], state: SearchState) -> Iterator[Begun]:
    """The laws of the library that contain an effect, begun as it is, where they were no rivals when it was taken.

    A screen of a few probes sees little of a memory whose length it does not know. Seen: the friction of a capstan whose bristles bend by
    0.019 rad, told as Coulomb friction (0.85), which left 140 times the noise; they left 5 times it.
    """
    done = state.step_of(effect.prefix)
    rivals = {r.candidate.attachment.named for r in done.ranked} if done is not None else set()
    for law in (mechanism() for mechanism in LIBRARY.values()):
        contains = effect.mechanism.name in law.generalises and (effect.port, law.name) not in rivals
        begun = law.begun_as(effect.mechanism.name, own) if contains and own else {}
        if begun:
            yield law, begun
