"""A gain error that the outputs cannot show, and the re-estimated parameters do.

A sensor that shows four fifths of the current, or a drive whose torque constant is another, is often made up for by the model's parameters
to the last digit: the re-estimated model simulates every recording, and its parameters are all wrong by powers of one factor. Recordings
alone cannot tell that from a machine with such parameters. The card's values can, where they are right within some per cent: one gain
then explains what would be a coincidence of all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.diagnosis.confirm.undone import made_up_for
from greybox_torch.diagnosis.describe.statement import Member, statement
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.findings import Findings
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.final import Final, finish
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, augmented
from greybox_torch.diagnosis.hypothesis.mismatch import negligible
from greybox_torch.diagnosis.one_of import Alternative, OneOf, spoken_at
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import problem_for
from greybox_torch.estimate.window_information import window_information
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.simulation.simulator import Simulator


@dataclass(frozen=True, eq=False)
class Moves:
    """How far re-estimated parameters moved from the card's values: logarithms of the ratios (n,), of those that have one and are known."""

    names: tuple[str, ...]
    logarithms: np.ndarray


@dataclass(frozen=True, eq=False)
class CommonGain:
    """A gain error that explains the moves of the parameters.

    ``error`` with its deviation; ``exponents`` (n,) by which the parameters make up for a gain; ``scatter`` of the moves' logarithms that
    remains, root mean square; ``share`` of their squares that goes; ``chance`` that so much of them lies along one direction by chance.
    """

    attachment: Attachment
    error: float
    deviation: float
    exponents: np.ndarray
    scatter: float
    share: float
    chance: float


def with_common_gain(found: Findings) -> Findings:
    """``found`` or, where nothing is missing by the outputs, with the gain error that the moves of the parameters show.

    Source of the test: the F test of a regression on one direction, R. A. Fisher, Statistical Methods for Research Workers, 1925.
    """
    study, plain, settings = found.study, found.state.plain, found.study.settings
    at_noise = times_noise(study.problem, plain, settings) <= settings.above_noise or negligible(study, plain)
    if found.state.effects or not found.complete or not at_noise:
        return found
    moves = moves_of(plain, found.judged.plain, settings)
    offered = [e for e in _gains(study) if not study.beliefs.exclude(e)]
    looked = (_asked(study, plain, moves, e, len(offered)) for e in offered)
    likely = sorted((g for g in looked if g is not None), key=lambda g: g.chance)
    return next((told for g in likely if (told := _told(found, moves, g, likely)) is not None), found)


def moves_of(plain: Hypothesis, final: Final, settings: DiagnosisSettings) -> Moves:
    """Of the free parameters that have the card's sign and deviations that are small beside what is asked of the card."""
    values, deviations, expected = final.values(), final.deviations(), plain.problem.expected
    found = {}
    for name, card in zip(plain.problem.names, expected, strict=True):
        value, deviation = values[name], deviations.get(name, np.inf)
        if card * value > 0 and deviation < settings.most_scatter_of_card * abs(value):
            found[name] = np.log(value / card)
    return Moves(tuple(found), np.array(list(found.values())))


def common_gain(
    attachment: Attachment, moves: np.ndarray, exponents: np.ndarray, looks: int, settings: DiagnosisSettings
) -> CommonGain | None:
    """The gain error whose making up explains ``moves`` (n,); None where it is small, or they are as likely by chance.

    Args:
        exponents: (n,) of each parameter, to which power of the gain it makes up for it.
        looks: at how many gains one looks.
    """
    from scipy.special import fdtrc  # not every diagnosis needs it

    if len(moves) < 2 or not np.isfinite(exponents).all():
        return None
    squares = exponents @ exponents
    several = squares**2 > settings.least_parameters_moved * np.sum(exponents**4)
    if not several:
        return None
    logarithm = -(exponents @ moves) / squares
    rest, freedom = moves + exponents * logarithm, len(moves) - 1
    before, after = moves @ moves, rest @ rest
    chance = looks * float(fdtrc(1, freedom, freedom * (before - after) / max(after, 1e-300)))
    scatter = float(np.sqrt(after / freedom))
    error = float(np.expm1(logarithm))
    small = abs(error) < settings.least_gain_error or scatter > settings.most_scatter_of_card
    if small or chance > settings.chance_of_common_gain:
        return None
    deviation = float(scatter / np.sqrt(squares) * np.exp(logarithm))
    return CommonGain(attachment, error, deviation, exponents, scatter, 1.0 - float(after / before), chance)


def _gains(study: Study) -> list[Attachment]:
    offered = candidates(study.problem.model, study.shifts, study.surroundings, flexible=False)
    return [e for e in offered if e.mechanism.nature == SensorGain.nature and len(_names(study, e)) == 1]


def _names(study: Study, effect: Attachment) -> list[str]:
    return [f"{effect.prefix}.{p.name}" for p in effect.mechanism.parameters(study.surroundings[effect.port])]


def _asked(study: Study, plain: Hypothesis, moves: Moves, effect: Attachment, looks: int) -> CommonGain | None:
    """What the moves say of one gain; None where the parameters do not make up for it."""
    model = augmented(study.problem, (effect,), study.surroundings)
    (gain,) = _names(study, effect)
    problem = problem_for(study.problem, model, {**plain.values(), gain: 0.0})
    simulator = Simulator.of(model, problem.free_names, study.options)
    known = window_information(replace(plain.fits[0], problem=problem), simulator)
    if known is None or not moves.names:
        return None
    own = problem.free_names.index(gain)
    rest = [i for i in range(len(known)) if i != own]
    answer, left = made_up_for(known, [own], rest, np.ones(1))
    if left > study.settings.least_not_undone:
        return None
    by_name = {problem.free_names[i]: a for i, a in zip(rest, answer, strict=True)}
    values = plain.values()
    exponents = np.array([by_name[n] / values[n] for n in moves.names])
    return common_gain(effect, moves.logarithms, exponents, looks, study.settings)


def _told(found: Findings, moves: Moves, gain: CommonGain, likely: Sequence[CommonGain]) -> Findings | None:
    """The findings with a gain error, the model refitted beside it; None where it does not simulate the recordings as well."""
    study, plain, effect = found.study, found.state.plain, gain.attachment
    (name,) = _names(study, effect)
    begun = {**plain.values(), name: gain.error}
    for parameter, exponent in zip(moves.names, gain.exponents, strict=True):
        begun[parameter] *= (1.0 + gain.error) ** exponent
    study.working_on(f"asking what the parameters say of {spoken_at(*reversed(effect.named))}")
    fitted = fit(study, (effect,), [begun], plain.fits[0], frozen=frozenset({name}))
    if fitted is None or fitted.score > plain.score + study.settings.parameter_price:
        return None
    judged = found.judged.having(finish(fitted, study.settings, study.budget, study.recorded))
    if not judged.holds:
        return None
    return replace(
        found,
        state=found.state.at(fitted),
        judged=judged,
        by_parameters=_effect(study, effect, gain, likely, moves),
        more=(*found.more, _sentence(moves, gain)),
    )


def _effect(study: Study, effect: Attachment, gain: CommonGain, likely: Sequence[CommonGain], moves: Moves) -> Effect:
    """The finding: gains between which the moves do not decide share its probability."""
    highest = study.settings.highest_probability_far_above_noise
    weights = np.array([g.scatter for g in likely]) ** -float(len(moves.names) - 1)
    shares = dict(zip((g.attachment.named for g in likely), highest * weights / weights.sum(), strict=True))
    around, own = study.surroundings[effect.port], shares.pop(effect.named)
    rivals = tuple(
        Alternative(*k, round(float(p), 4)) for k, p in shares.items() if p > study.settings.least_alternative
    )
    parameter = effect.mechanism.parameters(around)[0]
    return Effect(
        port=effect.port,
        mechanism=effect.mechanism.name,
        probability=round(float(own), 4),
        signals=effect.mechanism.signals(),
        where="it acts throughout the recordings",
        parameters={parameter.name: {"value": gain.error, "std": gain.deviation, "unit": parameter.unit}},
        explained=0.0,
        alternatives=rivals,
        curve=None,
        explanation=effect.mechanism.explanation,
        source=effect.mechanism.source,
        separating_experiment=effect.mechanism.experiment,
        size=gain.share,
        one_of=_one_of(study, likely, {**shares, effect.named: own}),
        equation=effect.mechanism.described_here(),
        made_up_for=_made_up_for(moves, gain),
    )


def _one_of(study: Study, likely: Sequence[CommonGain], shares: dict[tuple[str, str], float]) -> OneOf | None:
    """The gains that the moves do not tell apart, as one statement; None where one alone is likely."""
    near = [g for g in likely if shares[g.attachment.named] >= study.settings.least_class_share]
    if len(near) < 2:
        return None
    near.sort(key=lambda g: -shares[g.attachment.named])
    members = [
        Member(*g.attachment.named, g.attachment.mechanism.nature, round(shares[g.attachment.named], 4), size=g.error)
        for g in near
    ]
    told = tuple(Alternative(m.port, m.mechanism, m.probability) for m in members)
    return OneOf(statement(members), round(sum(m.probability for m in members), 4), told)


def _made_up_for(moves: Moves, gain: CommonGain) -> str:
    """What makes up for it without it, for the verdict's sentence."""
    moved = [
        n for n, e in zip(moves.names, gain.exponents, strict=True) if abs(e) > 0.5 * np.max(np.abs(gain.exponents))
    ]
    listed = " and ".join([", ".join(moved[:-1]), moved[-1]])
    before = float(np.sqrt(np.mean(moves.logarithms**2)))
    return (
        f"the recordings do not show it, as {listed} make up for it when they are re-estimated: they move from the card's values by "
        f"{digits(100 * before)} % together, and by {digits(100 * gain.scatter)} % with it"
    )


def _sentence(moves: Moves, gain: CommonGain) -> str:
    """The evidence."""
    named = spoken_at(*reversed(gain.attachment.named))
    return (
        f"Of the squared moves (logarithms) of {len(moves.names)} re-estimated parameters from the card's values {named} removes "
        f"{100 * gain.share:.3g} %; that so much of them falls in line by chance has a probability of {gain.chance:.1g}. This rests on "
        "the card's values, not on the recordings, which both models simulate alike."
    )
