"""Where the estimation experiments do not show what others do, one of those is taken to choose with as well."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain
from greybox_torch.diagnosis.confirm.standing import findings
from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.rivals_beside import rivals_in_its_place
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


@dataclass(frozen=True)
class Promotion:
    """A data set with the experiment ``taken`` among those to choose with, and why.

    ``same_effects``: whether what was found is to be kept where it leaves less than a finding, and only to be estimated anew.
    """

    dataset: DataSet
    taken: str
    why: str
    same_effects: bool = False

    def sentence(self) -> str:
        """What the reader of a verdict has to know of it."""
        return f"{self.taken} was taken to choose with as well, as {self.why}: it no longer counts as validation."

    @staticmethod
    def of(dataset: DataSet, taken: str, why: str, same_effects: bool = False) -> Promotion:
        """The validation experiment ``taken`` of a data set."""
        changed = (replace(r, role="estimation") if r.name == taken else r for r in dataset.recordings)
        return Promotion(replace(dataset, recordings=tuple(changed)), taken, why, same_effects)


def promote_unstable(dataset: DataSet, unstable: Collection[str]) -> Promotion | None:
    """The data set with a validation experiment that no free run follows, and so cannot score, among those to choose with.

    None where there is none, where no validation experiment would be left, or where none can score: another would not, either.
    """
    if not unstable:
        return None
    names = {r.name for r in dataset.validation()}
    if len(names) < 2 or names <= set(unstable):
        return None
    return Promotion.of(dataset, min(unstable), "no free run of the model found before follows it", same_effects=True)


def promote_refusing(
    dataset: DataSet, state: SearchState, others: HeldOut, searched: Hypothesis, refused_in: str
) -> Promotion | None:
    """The data set with the validation experiment whose free runs took back all that was found among those to choose with.

    None where windows of the validation experiments do not bear out what was found, or where no validation experiment would be left. What
    the windows bear out is there; where that experiment operates its law was not drawn well enough. Seen: a bump in a stage's friction at
    0.22 m/s, whose curve removed 98 % of the held-out error over windows, and drifted in a recording of slow motion.
    """
    if not refused_in or state.effects or len(dataset.validation()) < 2:
        return None
    removed = gain(others.fits(state.plain), others.fits(searched))
    settings = others.study.settings
    if removed.share <= settings.held_out_in_part or removed.errors_away <= settings.held_out_beyond_chance:
        return None
    return Promotion.of(
        dataset, refused_in, "free runs of the model found before come out worse there, which windows bear out"
    )


def promote_for_a_curve(
    dataset: DataSet, state: SearchState, others: HeldOut, searched: Hypothesis
) -> Promotion | None:
    """The data set with the validation experiment among those to choose with that a free curve follows worst, beside names in its place.

    None where the search came to no curve, or to one that goes no farther than the names; where these leave hardly more than noise; and
    where no validation experiment would be left. Beyond the range that it was drawn over a curve says nothing, so that a law which has the
    wrong shape predicts better there. Seen: friction that comes in waves over a stage's speed, told as Coulomb friction (0.85) for a
    recording of higher speeds.
    """
    settings = others.study.settings
    curve, names = any(e.mechanism.free for e in searched.effects), state.effects and not state.has_curve
    if not (curve and names) or len(dataset.validation()) < 2:
        return None
    left = others.times_noise(state.current)
    if searched.score > state.current.score - settings.curve_margin or np.max(left) < settings.promote_error_beside:
        return None
    worst = int(np.argmax(others.times_noise(searched) / left))
    why = "a curve goes farther than the laws in its place where it was drawn, and not there"
    return Promotion.of(dataset, dataset.validation()[worst].name, why)


def promote_validation(study: Study, dataset: DataSet, state: SearchState, others: HeldOut) -> Promotion | None:
    """The data set with the validation experiment that the search's model fits worst among those to choose with.

    None where the others show no more than the estimation experiments do, or where no validation experiment would be left. What has had
    a part in choosing does not score: the experiment changes its role.
    """
    settings = study.settings
    recordings, found = dataset.validation(), bool(state.effects)
    if len(recordings) < 2 or (found and far_above_noise(state.current, settings)):
        return None
    errors = others.times_noise(state.current)
    worst = int(np.argmax(errors))
    if errors[worst] < (settings.promote_error_beside if found else settings.promote_error):
        return None
    if found and errors[worst] < settings.promote_share_beside * others.times_noise(state.plain)[worst]:
        return None
    why = f"the model found before leaves {errors[worst]:.2g} times the noise there, which the estimation experiments do not show so"
    return Promotion.of(dataset, recordings[worst].name, why)


def promote_for_a_rival(
    study: Study,
    dataset: DataSet,
    state: SearchState,
    others: HeldOut,
    gains: Mapping[str, Gain] = MappingProxyType({}),
) -> Promotion | None:
    """The data set with a validation experiment among those to choose with that a rival of what was found predicts better, beyond chance.

    None where held-out experiments speak for no rival, or where no validation experiment would be left. The estimation experiments left the
    names undecided, or decided them by what other effects, not quite the machine's, leave there. Effects too small to be findings are not
    asked about.

    Args:
        gains: by effect, on held-out experiments.
    """
    recordings, settings = dataset.validation(), study.settings
    if len(recordings) < 2 or not state.effects or np.max(others.times_noise(state.current)) < settings.rival_error:
        return None
    found = others.fits(state.current)
    for effect in findings(study, state, others, gains):
        for rival in rivals_in_its_place(study, state, effect, settings.rival_margin):
            further = gain(found, others.fits(rival))
            if further.errors_away > settings.held_out_beyond_chance and further.share > settings.least_gain:
                better = others.times_noise(state.current) / others.times_noise(rival)
                law = next(e for e in rival.effects if e not in state.effects)
                why = f"{spoken_at(*law.named[::-1])} instead of {spoken_at(*effect.named[::-1])} predicts it better"
                return Promotion.of(dataset, recordings[int(np.argmax(better))].name, why)
    return None


def replaces(others: HeldOut, before: SearchState, after: SearchState, settles: bool = False) -> bool:
    """Whether what one more experiment to choose with led to takes the place of what was found before it.

    So does the model as it stands, where it leaves hardly more than noise on every experiment and predicts those that had no part in either
    no worse. Seen: a complete arm whose one experiment left its Stribeck peak a third too small, and friction that warms up for it (0.68).

    Args:
        settles: whether that experiment cannot score, so that the same effects estimated from it as well are to be preferred.
    """
    if settles and before.prefixes == after.prefixes:
        return _no_worse(others, before, after)
    if after.effects:
        return serves(others, before, after)
    return _complete(others, after) and (not before.effects or _no_worse(others, before, after))


def serves(others: HeldOut, before: SearchState, after: SearchState) -> bool:
    """Whether the model of ``after`` may stand in the place of that of ``before``, as experiments that had no part in either say.

    Against what was found before it must predict them better, or, where it only adds to that, not worse than by chance: what was taken
    shows an effect that they need not show, such as a stop that they never reach. Against nothing the latter is enough.
    """
    fits, fits_before = others.fits(after.current), others.fits(before.current)
    further = len(before.effects) < len(after.effects) and all(_there(e, after) for e in before.effects)
    adds = not before.effects or further
    better = bool(before.effects) and gain(fits_before, fits).share > 0
    return better or (adds and (_no_worse(others, before, after) or _hardly_worse(others, before, after)))


def _there(effect: Attachment, state: SearchState) -> bool:
    """Whether a state has an effect, or one of the same nature: which of its look-alikes it is, a larger effect may have decided.

    Seen: a motor's lag, told as a dead time until the stop was found that another experiment shows.
    """
    nature = effect.mechanism.nature
    return effect.prefix in state.prefixes or (
        bool(nature) and any(e.mechanism.nature == nature for e in state.effects)
    )


def _no_worse(others: HeldOut, before: SearchState, after: SearchState) -> bool:
    """Whether the model of ``after`` predicts held-out experiments no worse than that of ``before``, beyond chance."""
    further = gain(others.fits(after.current), others.fits(before.current))
    return further.errors_away < others.study.settings.held_out_beyond_chance


def _hardly_worse(others: HeldOut, before: SearchState, after: SearchState) -> bool:
    """Whether it is worse by less than a finding beside the mismatch that the plain model leaves there once it is estimated from what was
    taken: what the law of a stop lacks to be the machine's bends the parameters a little.
    """
    settings, old, new = others.study.settings, others.fits(before.current), others.fits(after.current)
    return size(others.fits(after.plain), new, old, settings) < settings.least_size


def _complete(others: HeldOut, state: SearchState) -> bool:
    """Whether the model as it stands leaves hardly more than noise on every experiment: then nothing is missing.

    What one experiment does not tell of the model's own parameters (friction near rest, of a machine that never rests there) looks like
    missing physics on the next.
    """
    own = times_noise(others.study.problem, state.plain, others.study.settings)
    return max(own, *others.times_noise(state.plain)) < others.study.settings.promote_error
