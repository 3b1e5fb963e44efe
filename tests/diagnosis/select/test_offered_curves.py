"""Which free curves are offered, and which are drawn more finely."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.candidates import attach
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.select.finer_curve import with_finer_curve
from greybox_torch.diagnosis.select.forward_step import substantial
from greybox_torch.diagnosis.select.offered import screen_scores
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.unknown import Unknown


def signals_of_curves(scores: Sequence[ScreenScore]) -> set[str]:
    mechanisms = [s.attachment.mechanism for s in scores]
    return {m.signal for m in mechanisms if isinstance(m, Unknown)}


def test_a_fine_curve_is_never_one_of_time(dead_zone_search) -> None:
    """Seen on a real joint: 57 knots over the time of the one record, which explained 99.9 % of it."""
    study, state = dead_zone_search.study, dead_zone_search.state
    coarse = screen_scores(study, state, curves=True, fine=False)
    fine = screen_scores(study, state, curves=True, fine=True)
    assert all("time" in signals_of_curves(at) for at in coarse)
    assert all(signals_of_curves(at) == {"speed", "position", "input", "output"} for at in fine)


def test_a_curve_of_time_is_not_drawn_more_finely(dead_zone_search) -> None:
    study, state = dead_zone_search.study, dead_zone_search.state
    curve = attach(study.problem.model, "actuator", Unknown("time", 14, "input"))
    fitted = refitted(study, [curve], state.current)
    assert fitted is not None
    assert result_of(with_finer_curve(study, state.at(fitted))).current is fitted


def test_beside_named_effects_a_curve_has_to_remove_more(dead_zone_search, stub) -> None:
    study, plain = dead_zone_search.study, dead_zone_search.state
    settings = replace(study.settings, least_curve_share=0.02, least_curve_share_beside_names=0.05)
    before = plain.current
    size = before.fits[0].mean_square
    fits = tuple(replace(f, mean_square=f.mean_square - 0.03 * size) for f in before.fits[:1])
    curve = stub(gain=1.0, fitted=stub(fits=fits))
    for effects, pays in (((), True), (("a law",), False)):
        state = stub(plain=stub(fits=before.fits[:1]), current=stub(fits=before.fits[:1]), effects=effects)
        assert substantial(stub(settings=settings), state, curve) is pays
