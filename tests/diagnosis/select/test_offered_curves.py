"""Which free curves are offered, and which are drawn more finely."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import pytest

from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.candidates import attach
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import finer_curve as module
from greybox_torch.diagnosis.select import forward_step
from greybox_torch.diagnosis.select.compare import Comparison
from greybox_torch.diagnosis.select.finer_curve import as_fine_as_pays, with_finer_curve, with_tied_curves_finer
from greybox_torch.diagnosis.select.forward_step import substantial, take_best
from greybox_torch.diagnosis.select.offered import screen_scores
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.forces import ConstantBias
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
        state = stub(plain=replace(before, fits=before.fits[:1]), current=stub(fits=before.fits[:1]), effects=effects)
        assert substantial(stub(settings=settings), state, curve) is pays


@pytest.mark.parametrize(("far", "removed", "pays"), [(True, 0.25, True), (False, 0.25, False), (False, 0.64, True)])
def test_of_what_hardly_exceeds_the_noise_a_curve_has_to_explain_most(
    dead_zone_search, stub, monkeypatch, far: bool, removed: float, pays: bool
) -> None:
    """Seen: a complete aeration basin, of whose disturbances a curve drew a quarter (0.97)."""
    monkeypatch.setattr(forward_step, "far_above_noise", lambda fitted, settings: far)
    before = dead_zone_search.state.current.fits[:1]
    fits = tuple(replace(f, mean_square=(1.0 - removed) * f.mean_square) for f in before)
    state = stub(plain=stub(fits=before), current=stub(fits=before), effects=())
    curve = stub(gain=1.0, fitted=stub(fits=fits))
    assert substantial(stub(settings=dead_zone_search.study.settings), state, curve) is pays


@pytest.mark.parametrize(
    ("removed", "complete", "stands"), [(0.4, False, False), (0.4, True, True), (0.8, False, True)]
)
def test_a_law_beside_a_curve_has_to_remove_most_of_what_that_leaves(
    dead_zone_search, stub, monkeypatch, removed: float, complete: bool, stands: bool
) -> None:
    """Seen: a loss of heat above 187 degC (0.85) beside the curve of a brake whose friction depends on its temperature."""
    study, model = dead_zone_search.study, dead_zone_search.study.problem.model
    curve, law = attach(model, "rotor", Unknown("speed")), attach(model, "rotor", ConstantBias())
    drawn = refitted(study, [curve], dead_zone_search.state.current)
    assert drawn is not None
    state = dead_zone_search.state.at(drawn)
    left = tuple(replace(f, energies=(1.0 - removed) * f.energies) for f in drawn.fits)
    fitted = replace(drawn, effects=(curve, law), fits=left)
    beside = RankedCandidate(Candidate(law, (), 0.5), fitted, 0.3, 9.0)
    monkeypatch.setattr(forward_step, "completes", lambda fitted, settings: complete)
    monkeypatch.setattr(
        forward_step, "compare", lambda study, parent, screened, ranked: Comparison(parent, tuple(ranked))
    )
    monkeypatch.setattr(forward_step, "tellable", lambda study, ranked: list(ranked))
    monkeypatch.setattr(
        forward_step, "with_values_that_say_something", lambda study, parent, polished, before: polished
    )
    monkeypatch.setattr(forward_step, "little_is_left", lambda study, state: False)
    assert result_of(take_best(study, state, (), [beside])).took_one is stands


@pytest.fixture
def drawn(stub, monkeypatch):
    """Curves whose score falls to that of another list with twice the knots: those at the wing gain, those at the actuator do not."""
    further = {"wing": 2.0, "actuator": 0.05}

    def candidate(port: str, gain: float, *, unknown: bool = True, knots: int = 14):
        effect = stub(port=port, mechanism=Unknown("position", knots))
        fitted = stub(score=-gain, effects=(effect,), problem=stub(free_names=["J"]))
        return stub(candidate=Pair(effect), fitted=fitted, gain=gain, unknown=unknown)

    def finer(study, fitted):
        effect = fitted.effects[-1]
        return candidate(effect.port, -fitted.score + further[effect.port], knots=2 * effect.mechanism.knots).fitted

    def judged(pair, parent, fitted, settings):
        return stub(candidate=pair, fitted=fitted, gain=-fitted.score, unknown=True)

    monkeypatch.setattr(module, "_drawn_finer", finer)
    monkeypatch.setattr(module, "judged", judged)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: sorted(ranked, key=lambda r: -r.gain))
    return candidate


@dataclass(frozen=True)
class Pair:
    """What a candidate attaches."""

    attachment: object


@pytest.mark.parametrize(
    ("behind", "noise", "first"),
    [(0.05, 5.0, "wing"), (0.5, 5.0, "actuator"), (0.05, 1.0, "actuator")],
    ids=["tied", "far behind", "only noise is left"],
)
def test_curves_that_tie_are_drawn_finer_before_one_is_preferred(
    drawn, stub, monkeypatch, behind, noise, first
) -> None:
    """Seen: a wing that stalls, told as a gain of the flow for 0.05 in the logarithm of the error."""
    monkeypatch.setattr(module, "times_noise", lambda *args: noise)
    study = stub(settings=DiagnosisSettings(), budget=SearchBudget(), problem=None)
    ranked = [drawn("actuator", 6.7), drawn("wing", 6.7 - behind), drawn("wing", 1.0, unknown=False)]
    found = with_tied_curves_finer(study, stub(), ranked)
    assert found[0].candidate.attachment.port == first and len(found) == 3
    assert (found is ranked) is (first == "actuator")


def test_a_curve_is_drawn_finer_as_long_as_that_pays(drawn, stub) -> None:
    study = stub(settings=DiagnosisSettings(), budget=SearchBudget(), problem=None)
    assert as_fine_as_pays(study, stub(), drawn("wing", 1.0)).gain == 7.0, "14, 28, 56 and 112 knots"
    little = drawn("actuator", 1.0)
    assert as_fine_as_pays(study, stub(), little) is little
