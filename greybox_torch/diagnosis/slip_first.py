"""A slip on the card that explains the mismatch far better than what was found: the verdict begins with the question about it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import held_out_scores, mean_fit
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.ports import Actuator, Sensor
from greybox_torch.name_lists import listed

LIKE_A_SLIP = ("unknown", "input_gain", "sensor_gain")
"""What a channel that is exchanged, turned or of another scale looks like, at its actuator or sensor."""


def looks_like_a_slip(effect: Effect) -> bool:
    """Whether an effect may stand for a slip on the card."""
    return effect.mechanism in LIKE_A_SLIP and effect.port.startswith(("actuator", "sensor"))


def with_question(
    verdict: Verdict, question: str, reaches: float, lead: str, ports: Collection[str] = frozenset()
) -> Verdict:
    """The verdict with a question to the user, first and with effects that are doubtful where the change that it is about explains far
    more than these do, as much where these leave much, or nearly all by itself of what is told as an effect at the same channel.

    Seen: a current of the other sign, told as an unknown effect at the actuator (0.97), which left 130 times the noise; the question, a few
    lines below, was about what left hardly anything. A valve of the other sign, told as such an effect (0.97) beside dry friction that was
    missing indeed, so that the sign alone left more than both. A temperature in K, read as degC, told as an offset of -96 kW (0.97) with
    79.5 %; the question below it reached 80.2 %.

    Args:
        question: without its full stop.
        reaches: the mean fit in % on the validation experiments with the channels as the question has them.
        lead: how the question begins, up to what was changed: of a scale it is a no that explains the error.
        ports: those of the channels that it is about.
    """
    asked, left, settings = replace(verdict, question=question), 100.0 - reaches, verdict.settings
    left_by_effects, little = _left(verdict, "augmented"), settings.left_by_a_slip * _left(verdict, "refit")
    alike = tuple(e for e in verdict.effects if looks_like_a_slip(e) and e.port in ports)
    doubted, compared = verdict.effects, "what was found with the card as it is"
    if verdict.effects and left < settings.far_more_by_a_question * left_by_effects:
        how_much, first = "far more", f"leaves far less than {compared}"
    elif verdict.effects and little < left_by_effects and left <= left_by_effects:
        how_much, first = "as much", f"leaves no more than {compared}"
    elif alike and left < little:
        doubted, how_much = alike, "nearly all by itself"
        them = listed([spoken_at(e.mechanism, e.port) for e in alike])
        first = f"reaches {digits(reaches, 3)} % without {them}; with the card as it is"
    else:
        return asked
    highest = settings.highest_probability_beside_a_question
    why = f"no more than {highest:.2f} is claimed for it, as a slip on the card, which is asked about, would explain {how_much}"
    effects = tuple(_doubtful(e, highest, why) if e in doubted else e for e in verdict.effects)
    first = f"{lead}, a short refit {first}"
    return replace(asked, question_first=first, effects=effects, confidence=min(verdict.confidence, highest))


def ports_of(model: GreyBoxModel, channels: Collection[str]) -> frozenset[str]:
    """The actuators and sensors of some inputs and outputs, by name."""
    own = (
        (port.name, port.input if isinstance(port, Actuator) else port.output)
        for port in model.all_ports
        if isinstance(port, Actuator | Sensor)
    )
    return frozenset(name for name, channel in own if channel in channels)


def _left(verdict: Verdict, which: str) -> float:
    """What a model of the verdict leaves to a mean fit of 100 % on the validation experiments that count."""
    return 100.0 - mean_fit(held_out_scores(verdict.counted(which)))


def _doubtful(effect: Effect, highest: float, why: str) -> Effect:
    """An effect that is no surer than that, nor is the class that it is told in."""
    surest = max(effect.probability, 0.0 if effect.one_of is None else effect.one_of.probability)
    limited = (*effect.limited, why) if surest > highest else effect.limited
    return replace(effect.no_surer_than(highest, highest), limited=limited)
