"""How large effects are, and which of them are findings: significance against noise is not evidence for a law, size is.

No law is exactly the machine's. What a law lacks stands far above the noise of a good sensor, and some other law will always take up part
of it; but it is small beside the mismatch that the law itself removes.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, partial

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.confirm.within_tolerance import is_timing, within_noise_of_sensor, within_tolerance
from greybox_torch.diagnosis.effect import SO_LITTLE
from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.transmission import HystereticSpring
from greybox_torch.model import GreyBoxModel

BY_TIMING = "a shift of a small part of a sampling interval, by which the time stamps of input and outputs may differ"
BY_NOISE_OF_SENSOR = "hardly more than the sensor's noise"
OF_LITTLE = (
    "the model as it stands leaves little more than noise over windows, and of that sensors, converters and wear make parts that any law "
    "takes up"
)
WITHIN_TOLERANCE = (
    "the model as it stands leaves little more than noise over windows, and none is exact to so small a shift in time, so small an error "
    "of a gain or a bend of its own friction"
)
NOT_BORNE_OUT = "little, and the experiments that had no part in choosing it do not bear it out beyond chance"
OF_MUCH = "most of the mismatch is left with all that was found, and any law takes up a part of that"
"""Why effects are refinements; another reason is ``SO_LITTLE``."""


def least_size(study: Study, state: SearchState, others: HeldOut | None) -> float:
    """The size from which an effect is a finding: much less where with all of them hardly more than noise is left."""
    return _least_size(study.settings, _completed(study, state, others))


def _least_size(settings: DiagnosisSettings, completed: bool) -> float:
    return settings.least_size_at_noise if completed else settings.least_size


def _completed(study: Study, state: SearchState, others: HeldOut | None) -> bool:
    """Whether with all effects hardly more than noise is left."""
    if others is not None:
        left = float(np.max(others.times_noise(state.current)))
    else:
        left = times_noise(study.problem, state.current, study.settings)
    return left < study.settings.above_noise


def refinements(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], sizes: Mapping[str, float]
) -> set[str]:
    """The effects that are no findings, but refinements of the model: arguments and reasons as for :func:`why_refinements`."""
    return set(why_refinements(study, state, others, gains, sizes))


def why_refinements(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], sizes: Mapping[str, float]
) -> dict[str, str]:
    """Why effects are refinements, a clause each: they are too small to be findings, or that small and not confirmed by held-out
    experiments beyond chance, or shifts in time by next to nothing of a sampling interval, or curves of a sensor that are hardly more than
    its noise.

    Where the model leaves little more than noise: those that do not account for most of what is beyond it on the held-out experiments, and
    those that no model is exact to. No machine is exactly its model. A sensor's filter, a converter's steps and a wear of a few thousandths
    leave as much together, and of these some law always takes up a part, and two of them more. Seen: a heat exchanger that nothing is
    missing from, 1.3 to 1.7 times the noise, told as a dead time of a fifth of a sample (0.97), 15 % of that; a tunnel with a surge tank,
    1.6 to 1.9 times, told as a curve and a threshold, each a third of it; a spring that stiffens, 2.1 times, told with a constant force
    beside it (a class of seven, 0.97), a twentieth of it.

    Of two laws of friction at one body, or of one spring, the smaller one has to be larger than other effects: it may be what the other
    lacks. So has any law at the port of a larger one, where more than noise is left in spite of both and it does not remove nearly all of
    the rest, and a free curve beside a larger law wherever that is: it draws what any of them lacks. So has every law beside a larger one
    where most of the mismatch is left. Seen: a hoop whose drive's law is a stand-in, told with waves over 3.5 periods of its travel (0.50),
    8 % of the mismatch of which 78 % is left.
    Of two hystereses of one motion the smaller one is a refinement, however large.

    Args:
        sizes: of every effect, from :func:`sizes`.
    """
    told = others is not None and not all(g.unexercised(study.settings) for g in gains.values())
    small = {e.prefix: BY_TIMING for e in state.effects if is_timing(study, state, e)}
    small |= {e.prefix: BY_NOISE_OF_SENSOR for e in state.effects if within_noise_of_sensor(study, state, e)}
    small |= _too_small(study, state, others, gains, sizes)
    little = {p: OF_LITTLE for p in state.prefixes if told and sizes[p] < study.settings.least_of_little}
    rest = [e for e in state.effects if e.prefix not in {*small, *little}]
    little |= {e.prefix: WITHIN_TOLERANCE for e in rest if within_tolerance(study, state, e, sizes[e.prefix])}
    return little | small if little and _little_is_missing(study, state, others) else small


def findings(study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain]) -> list[Attachment]:
    """The effects that are no refinements; ``gains`` by effect, on held-out experiments."""
    small = refinements(study, state, others, gains, sizes(study, state, gains))
    return [e for e in state.effects if e.prefix not in small]


def _too_small(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain], sizes: Mapping[str, float]
) -> dict[str, str]:
    """Why effects are too small to be findings, a clause each; arguments as for :func:`why_refinements`."""
    settings, completed = study.settings, _completed(study, state, others)
    effects = {e.prefix: e for e in state.effects}
    most_is_left = cache(partial(_most_is_left, study, state, others))

    def least(prefix: str) -> float:
        apart, gain = _apart(state, effects[prefix]), gains.get(prefix)
        alone = completed or (apart and _nearly_all(gain, settings.nearly_all_of_the_rest))
        whole_rest = completed and apart and _nearly_all(gain, settings.all_of_the_rest)
        return max(0.0 if whole_rest else _least_size(settings, alone), np.finfo(float).tiny)

    def doubtful(prefix: str) -> bool:
        gain = gains.get(prefix)
        confirmed = gain is None or gain.errors_away > settings.held_out_beyond_chance
        return sizes[prefix] < settings.least_size and not confirmed

    def part_of_another(prefix: str) -> str:
        own = effects[prefix]
        larger = [e for p, e in effects.items() if sizes[p] > sizes[prefix]]
        whole = next((e for e in larger if _one_hysteresis(study.problem.model, e, own)), None)
        if whole is not None:
            return f"{_spoken(whole)} is an element of the same hysteresis, of which a law has one"
        if not larger or sizes[prefix] >= settings.least_size_beside_larger:
            return ""
        there = [e for e in larger if e.port == own.port]
        alone = completed or _nearly_all(gains.get(prefix), settings.all_of_the_rest)
        lacking = [e for e in there if not alone or _of_one_kind(e.mechanism, own.mechanism)]
        if lacking:
            return f"it may be what {_spoken(lacking[0])}, which is larger, lacks to be the machine's law"
        if own.mechanism.free:
            return "beside a larger effect a free curve may draw what that one lacks"
        return OF_MUCH if most_is_left() else ""

    small = {p: SO_LITTLE for p in state.prefixes if not sizes[p] >= least(p)}
    small |= {p: NOT_BORNE_OUT for p in state.prefixes - small.keys() if doubtful(p)}
    return small | {p: why for p in state.prefixes - small.keys() if (why := part_of_another(p))}


def _spoken(effect: Attachment) -> str:
    return spoken_at(effect.mechanism.name, effect.port)


def _most_is_left(study: Study, state: SearchState, others: HeldOut | None) -> bool:
    """Whether all effects together leave most of the mismatch, far above the noise."""
    if not far_above_noise(state.current, study.settings):
        return False
    plain, full = (h.fits if others is None else others.fits(h) for h in (state.plain, state.current))
    return 1.0 - size(plain, plain, full, study.settings) > study.settings.most_of_the_mismatch


def _apart(state: SearchState, own: Attachment) -> bool:
    """Whether an effect is at a port of its own."""
    return all(e.port != own.port for e in state.effects if e is not own)


def _nearly_all(gain: Gain | None, least: float) -> bool:
    """Whether an effect removes so much of what the others leave on held-out experiments that it is no part of what they lack.

    Seen: a gimbal's gyro that shows 8 % too little, 1 % of the mismatch beside friction that differs by direction, and 92 % of the rest;
    a wrist's slack tendon, 0.16 % of the mismatch beside the hand's weight, and 99.4 % of the rest, which was 13 times the noise.
    """
    return gain is not None and gain.share >= least


def _little_is_missing(study: Study, state: SearchState, others: HeldOut | None) -> bool:
    """Whether the model as it stands leaves little more than noise on every experiment."""
    held_out = () if others is None else others.times_noise(state.plain)
    return max(times_noise(study.problem, state.plain, study.settings), *held_out, 0.0) < study.settings.far_above_noise


def _of_one_kind(one: Mechanism, other: Mechanism) -> bool:
    """Whether two laws are friction by speed alone, or a spring's answer to its deflection, of which a port has one."""
    return (one.rubs and other.rubs) or (one.springs and other.springs)


def _one_hysteresis(model: GreyBoxModel, one: Attachment, other: Attachment) -> bool:
    """Whether two laws are elements that slip with the same motion: of a body, and of a spring between it and the ground.

    A hysteresis is a sum of such elements, of which a law has one. Seen: four of a piezo stack, told as two laws (0.97 and 0.93).

    Source: W. D. Iwan, "A distributed-element model for hysteresis and its steady-state dynamic response", Journal of Applied Mechanics
    33, 1966.
    """
    if {one.mechanism.name, other.mechanism.name} != {HystereticSpring.name, PreslidingHysteresis.name}:
        return False
    ports = {port.name: port for port in model.ports}
    speeds = [ports[e.port].signals.get("speed", ports[e.port].signals.get("rate")) for e in (one, other)]
    return speeds[0] == speeds[1]


def sharing_with_the_rest(
    study: Study, state: SearchState, others: HeldOut | None, gains: Mapping[str, Gain]
) -> str | None:
    """The smallest of several effects that are each too small for a finding beside the rest, and together are not; None elsewhere.

    Of a lag and a delay, or of two stops at either end of a spring, each makes up for the other: one has to go before the other one's size
    is known.
    """
    by_effect = sizes(study, state, gains)
    small = _too_small(study, state, others, gains, by_effect)
    if len(small) < 2:
        return None
    without = _without_all(study, state, set(small))
    plain, rest, full = (h.fits if others is None else others.fits(h) for h in (state.plain, without, state.current))
    together = size(plain, rest, full, study.settings)
    return min(sorted(small), key=lambda p: by_effect[p]) if together >= study.settings.least_size else None


def _without_all(study: Study, state: SearchState, prefixes: set[str]) -> Hypothesis:
    """The state's hypothesis without several of its effects."""
    rest = tuple(e for e in state.effects if e.prefix not in prefixes)
    if not rest:
        return state.plain
    study.working_on("trying without what is small")
    return refitted(study, rest, state.current) or state.plain
