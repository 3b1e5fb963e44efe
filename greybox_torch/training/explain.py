"""What a trained network stands for: its curve with a band, which signals it depends on, and the named law that could replace it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from greybox_torch.errors import UserError
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.shifted_states import shifted_state
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.matching import (
    Match,
    kinematic_laws,
    law_force,
    matching_laws,
    worth_a_refit,
)
from greybox_torch.mechanisms.memory_net import MemoryNet
from greybox_torch.model import Coupling
from greybox_torch.name_lists import listed
from greybox_torch.training.hybrid import port_named
from greybox_torch.training.learned_force import LearnedForce, SignalCurve, curves_of, force_at, learned_force
from greybox_torch.training.named_term import NamedTerm, on_all_samples, refitted_term
from greybox_torch.training.own_parameters import OwnParameters, own_parameters
from greybox_torch.training.polish import WORTH
from greybox_torch.training.trained import Trained

KEEP = "Keep the network."
"""The recommendation where no law does what the network does."""


@dataclass(frozen=True)
class Explanation:
    """What the network stands for; empty where it was left at zero.

    ``curves`` over each of its signals, with their shares; ``members`` how many trainings the band is from: of one it is the parameters'
    covariance alone, of several what they differ by is added. ``matches`` compares every law of the library that depends on these
    signals alone with what the model's ``own`` parameters, which act where the network does, leave of the learned force; ``terms`` are the
    best of them in the network's place, best on held-out stretches first, ``refitted`` says whether any were asked there, and
    ``failed`` names those that cannot be simulated there. ``memories`` are the time constants, in s, of a network with hidden states, which
    no curve stands for. ``term`` is the one that makes the network needless, estimated on all samples as ``result``; None where none does.
    """

    curves: tuple[SignalCurve, ...] = ()
    members: int = 1
    matches: tuple[Match, ...] = ()
    terms: tuple[NamedTerm, ...] = ()
    term: NamedTerm | None = None
    result: Estimation | None = None
    memories: tuple[float, ...] = ()
    own: tuple[str, ...] = ()
    refitted: bool = True
    failed: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """What to do with the network, in a sentence."""
        if self.memories:
            told = " and ".join(f"{t:.2g} s" for t in self.memories)
            return f"The network remembers over {told}: no curve over its signals stands for it. {KEEP}"
        if not self.curves:
            return "There is nothing to explain: the network was left at zero."
        if self.term is not None:
            return (
                f"{self.term.attachment.prefix} does what the network does: its mean squared error on the held-out stretches is "
                f"{_told(self.term.lost)}. "
                "Drop the network."
            )
        present = [term for term in self.terms if not term.absent]
        if present:
            best = present[0]
            return (
                f"No law that was put in the network's place does what it does: with the closest, {best.attachment.prefix}, the mean "
                f"squared error on the held-out stretches is {_told(best.lost)}.{self._unjudged} {KEEP}"
            )
        nearest = next(iter(worth_a_refit(self.matches)), None)
        if nearest is not None and not self.refitted:
            return (
                f"Laws were compared with the learned curve alone: the nearest, {nearest.law.name}, matches {100 * nearest.share:.0f} % of "
                "it. Whether one does what the network does is not known before it is put in its place (`refit`)."
            )
        return f"No law of the library without memory comes near to what the network has learned. {KEEP}"

    @property
    def _unjudged(self) -> str:
        """A sentence, behind a space, on laws that were put in the network's place and could not be judged; "" for none."""
        if not self.failed:
            return ""
        return f" Nothing is known of {listed(self.failed)}: with the values that match the curve the simulation overflows."


def explain(
    found: Trained,
    others: Sequence[Trained] = (),
    *,
    refit: bool = True,
    told: Callable[[str], None] = lambda text: None,
) -> Explanation:
    """Turn what a network has learned into a named term, where a law of the library does as well.

    The laws are those that the verdict `unknown` is compared with: without memory, functions of the network's signals alone. The best few
    take the network's place, are estimated with the physics without the held-out stretches, and judged on these, as the network was. As
    these stretches choose, a validation experiment has to score.

    Args:
        others: the same hybrid trained with other seeds; their differences widen the band.
        refit: put laws in the network's place (some times the work of estimating the physics), or only compare curves.
        told: is told what is being done.

    Raises:
        UserError: the others have a network at another port, or of other signals.
        NumericalError: the chosen law overflows on all samples.
    """
    if found.physics_chosen:
        return Explanation()
    if isinstance(found.hybrid.network.mechanism, MemoryNet):
        return Explanation(memories=_memories(found))
    told("explaining: the learned curve")
    first = learned_force(found)
    others = [other for other in others if not other.physics_chosen]
    members = [first, *(_beside(first, found, other) for other in others)]
    network = found.hybrid.network
    curves = curves_of(members, found.hybrid.surroundings[network.port].units)
    names = found.hybrid.told([curve.signal for curve in curves])
    curves = tuple(replace(curve, name=name) for curve, name in zip(curves, names, strict=True))
    own = own_parameters(found, first.signals)
    matches = tuple(_matches(found, first, own))
    terms, failed = _terms(found, matches, first, own, told) if refit else ((), ())
    term = needless(terms, found)
    if term is not None:
        told(f"explaining: {term.attachment.prefix} on all samples")
    result = None if term is None else on_all_samples(term, found)
    return Explanation(curves, len(members), matches, terms, term, result, own=own.names, refitted=refit, failed=failed)


def _memories(found: Trained) -> tuple[float, ...]:
    """The time constants of a network with hidden states, s."""
    problem, start = found.result.problem, f"{found.hybrid.network.prefix}.T_"
    return tuple(float(v) for n, v in zip(problem.names, problem.values, strict=True) if n.startswith(start))


def needless(terms: Sequence[NamedTerm], found: Trained) -> NamedTerm | None:
    """The term for which the network can be dropped: as good on held-out stretches as a network must be better to be worth having, and
    better than physics alone.
    """
    alone = next(choice.held_out for choice in found.polished.choices if choice.weight is None)
    return next((t for t in terms if t.lost <= WORTH and t.held_out < alone and not t.absent), None)


def _beside(first: LearnedForce, found: Trained, other: Trained) -> LearnedForce:
    one, two = found.hybrid.network, other.hybrid.network
    if (one.port, one.mechanism.needs) != (two.port, two.mechanism.needs):
        raise UserError(
            f"explain: others has a network at {two.port} reading {', '.join(two.mechanism.needs)}; expected one at {one.port} reading "
            f"{', '.join(one.mechanism.needs)}, as the first"
        )
    force, slope = force_at(other, first.signals)
    return LearnedForce(first.signals, force, slope, learned_force(other).covariances)


def _matches(found: Trained, learned: LearnedForce, own: OwnParameters) -> list[Match]:
    physics, network = found.physics.problem.model, found.hybrid.network
    there = [a for a in physics.attachments if a.port == network.port] if isinstance(physics, AugmentedModel) else []
    around, kind = found.hybrid.surroundings[network.port], port_named(physics, network.port).kind
    signals = {name: torch.tensor(np.ascontiguousarray(values)) for name, values in learned.signals.items()}
    weight = np.ones(len(learned.force))
    return matching_laws(kind, around, signals, learned.force, weight, {a.mechanism.name for a in there}, own.force)


def _terms(
    found: Trained, matches: Sequence[Match], learned: LearnedForce, own: OwnParameters, told: Callable[[str], None]
) -> tuple[tuple[NamedTerm, ...], tuple[str, ...]]:
    """The laws that come near the curve, and the kinematic ones of its signals, in the network's place; best first. And the names of those
    that cannot be simulated there.

    Each begins with the model's own parameters where they do what the law leaves of the learned force.
    """
    physics, network = found.physics.problem, found.hybrid.network
    beside = found.result.problem.values_by_name
    beside = {name: beside[name] for name in physics.names}
    around = found.hybrid.surroundings[network.port]
    signals = {name: torch.tensor(np.ascontiguousarray(values)) for name, values in learned.signals.items()}
    candidates: list[tuple[Attachment, list[dict[str, float]], float | None, dict[str, float]]] = []
    for m in worth_a_refit(matches):
        moved = own.taking_over(learned.force - law_force(m.law, around, signals, m.values))
        candidates.append((attach(physics.model, network.port, m.law), [m.values], m.share, moved))
    candidates += [(attachment, sizes, None, {}) for attachment, sizes in _kinematic(found)]
    terms, failed = [], []
    for attachment, sizes, share, moved in candidates:
        told(f"explaining: {attachment.prefix} instead of the network")
        starts = [{**beside, **moved, **{f"{attachment.prefix}.{n}": v for n, v in values.items()}} for values in sizes]
        term = refitted_term(found, attachment, starts, share)
        if term is None:
            failed.append(attachment.mechanism.name)
        else:
            terms.append(term)
    return tuple(sorted(terms, key=lambda term: term.held_out)), tuple(failed)


def _kinematic(found: Trained) -> list[tuple[Attachment, list[dict[str, float]]]]:
    """Attachments of the kinematic laws of the network's signals, with sizes to begin with, where a state carries their change."""
    physics, network = found.physics.problem, found.hybrid.network
    site = port_named(physics.model, network.port)
    shifted = shifted_state(physics.model, physics, site) if isinstance(site, Coupling) else ""
    laws = kinematic_laws(found.hybrid.surroundings[network.port], network.mechanism.needs) if shifted else []
    return [(attach(physics.model, network.port, law, shifted), sizes) for law, sizes in laws]


def _told(lost: float) -> str:
    """How a mean squared error compares with the network's, where it is a share ``lost`` more: words a reader can picture."""
    if not math.isfinite(lost):
        return "not finite, as the simulation diverges"
    if lost >= 1.0:
        return f"{1.0 + lost:.3g} times the network's"
    return f"{abs(100 * lost):.1f} % {'more' if lost > 0 else 'less'}"
