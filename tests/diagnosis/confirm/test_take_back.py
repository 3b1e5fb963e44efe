"""What held-out experiments make of a finding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import exercised, take_back
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain
from greybox_torch.diagnosis.confirm.simpler_laws import simplified, with_simpler_laws
from greybox_torch.diagnosis.confirm.take_back import _idle, goes_farther_in_most_windows
from greybox_torch.diagnosis.confirm.wider_laws import with_wider_laws
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.stribeck import StribeckFriction


@pytest.fixture
def chose_stribeck(motor_data, motor, begun) -> Any:
    """Makes a search that has taken Stribeck friction, Coulomb friction being its rival, and what judges it on other experiments."""

    def make(extra: float) -> tuple[Any, HeldOut]:
        def friction(q: float, v: float) -> float:
            return -(0.05 + extra * np.exp(-((v / 0.8) ** 2))) * np.tanh(v / 0.1)

        data = motor_data(torque=friction)
        search, laws = begun(data, motor), (StribeckFriction(), CoulombFriction())
        ranked = []
        for law in laws:
            effect = attach(motor, "rotor", law)
            sizes = {f"{effect.prefix}.{n}": v for n, v in (("F_c", 0.04), ("F_s", 0.02), ("v_0", 0.1), ("v_s", 0.8))}
            fitted = search.refitted((effect,), search.plain, [{**search.plain.values(), **sizes}])
            ranked.append(judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings))
        step = SelectionStep((), search.plain, tuple(ranked), ranked[0])
        return search.at(ranked[0].fitted, steps=(step,)), HeldOut(data, search.study)

    return make


@pytest.mark.parametrize(("extra", "meant"), [(0.0, "coulomb_friction"), (0.1, "stribeck_friction")])
def test_the_contained_law_is_meant_where_the_larger_one_predicts_no_better(chose_stribeck, extra, meant) -> None:
    search, others = chose_stribeck(extra)
    state = result_of(with_simpler_laws(search.study, search.state, others))
    (effect,) = state.effects
    assert effect.mechanism.name == meant
    assert state.steps[0].taken.candidate.attachment.mechanism.name == meant
    assert state.step_of(effect.prefix) is state.steps[0]


@pytest.mark.parametrize(("extra", "meant"), [(0.0, "coulomb_friction"), (0.1, "stribeck_friction")])
def test_the_law_that_contains_it_is_meant_where_that_predicts_others_better(chose_stribeck, extra, meant) -> None:
    """Seen: two laws that few windows at slow speed left alike, and on held-out experiments three times the noise with the simpler one."""
    search, others = chose_stribeck(extra)
    (step,) = search.state.steps
    simple = next(r for r in step.ranked if r.candidate.attachment.mechanism.name == "coulomb_friction")
    state = search.at(simple.fitted, steps=(replace(step, taken=simple),)).state
    found = result_of(with_wider_laws(search.study, state, others))
    (effect,) = found.effects
    assert effect.mechanism.name == meant
    assert found.steps[0].taken.candidate.attachment.mechanism.name == meant
    assert (found.current is state.current) is (extra == 0.0)


def test_what_is_left_of_a_law_without_what_makes_it_one_is_a_law_that_it_contains(chose_stribeck) -> None:
    """Seen: Stribeck friction at an arm, all of the held-out error removed, dropped as its peak was less than its deviation."""
    search, _ = chose_stribeck(0.0)
    (effect,), (step,) = search.state.effects, search.state.steps
    alone = search.at(
        search.current, steps=(replace(step, ranked=step.ranked[:1]),)
    ).state  # no rival was refitted beside it
    found = simplified(search.study, alone, effect)
    assert found is not None
    (law,) = found.effects
    assert law.named == ("rotor", "coulomb_friction")
    values = found.current.values()
    assert values[f"{law.prefix}.F_c"] == pytest.approx(0.05, rel=0.05)
    assert values[f"{law.prefix}.v_0"] == pytest.approx(0.1, rel=0.2)
    assert found.step_of(law.prefix) is found.steps[0] and found.steps[0].taken.gain > 0.0
    assert simplified(search.study, found, law) is None, "it contains no other"


@pytest.mark.parametrize("elsewhere_too", [True, False])
def test_what_only_frees_the_other_parameters_is_idle_on_other_experiments(
    motor_data, motor, begun, elsewhere_too
) -> None:
    """A bias of one experiment: with it the other parameters are right, so it predicts others better than the model without."""
    biased = motor_data(torque=lambda q, v: 0.1)
    others = biased if elsewhere_too else motor_data(torque=lambda q, v: 0.0)
    recordings = (biased.recordings[0], others.recordings[1])
    data = replace(biased, recordings=recordings)
    search, effect = begun(data, motor), attach(motor, "rotor", ConstantBias())
    state = search.at(search.refitted((effect,), search.plain), without={effect.prefix: search.plain}).state
    held_out = HeldOut(data, search.study)
    found = _idle(state, {effect.prefix: Gain(0.5, 0.1)}, held_out.fits(state.current), held_out)
    assert found == (None if elsewhere_too else effect.prefix)
    assert _idle(state, {effect.prefix: Gain(0.95, 0.1)}, held_out.fits(state.current), held_out) is None


@pytest.mark.parametrize(
    ("whole", "idle"), [(Gain(0.6, 0.1), None), (Gain(0.6, 0.3), "rotor.law"), (Gain(0.4, 0.2), None)]
)
def test_few_windows_alone_do_not_make_an_effect_idle_whose_gain_is_beyond_chance_or_all_its_own(
    stub, whole: Gain, idle
) -> None:
    """Left out, all else as it is, 0.43 of the error and 2.5 standard errors are lost: less than what is beyond chance by itself.

    Seen: a notch in a stage's friction, rarely passed on held-out experiments, where all of what little was gained was its own.
    """
    windows = stub(steps=20)
    full = (stub(energies=np.ones(8), windows=windows),)
    left_out = (stub(energies=np.array([5.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 1.0]), windows=windows),)
    assert 1.0 < gain(left_out, full).errors_away < 3.0 and gain(left_out, full).share == pytest.approx(0.43, abs=0.01)
    state = stub(current=stub(values=dict), without={"rotor.law": None})
    others = stub(fits_at=lambda hypothesis, values: left_out, study=stub(settings=DiagnosisSettings()))
    assert _idle(state, {"rotor.law": whole}, full, others) == idle


@pytest.mark.parametrize(
    ("by_name", "by_curve", "astray", "farther"),
    [
        (0.1, 1e-4, 1e3, True),
        (0.1, 1e-4, 1.0, True),
        (0.01, 0.006, 1.0, False),  # names reach more than 0.85 of it, in logarithms
        (0.95, 0.9, 1.0, False),  # less than the margin
        (1e-4, 0.1, 1.0, False),
    ],
)
def test_one_window_beyond_its_range_does_not_decide_against_a_curve(stub, by_name, by_curve, astray, farther) -> None:
    """Seen: a cable harness, of which a curve left a thousandth in 38 of 40 held-out windows, told as gravity, which left a tenth."""

    def fits(share: float, last: float = 1.0, count: int = 10) -> list[Any]:
        energies = share * np.linspace(0.5, 2.0, count)
        energies[-1] *= last
        half = energies[: count // 2].copy()
        return [stub(energies=energies, windows=stub(steps=20)), stub(energies=half, windows=stub(steps=40))]

    settings = DiagnosisSettings()
    given = fits(1.0), fits(by_name), fits(by_curve, astray)
    assert goes_farther_in_most_windows(*given, settings) is farther  # type: ignore[arg-type]
    every_third, longest = fits(by_curve), fits(by_curve)
    every_third[0].energies[::3] *= 1e6
    longest[1].energies[1:] *= 1e6
    assert goes_farther_in_most_windows(*given[:2], longest, settings) is False, "the longest speak against it"  # type: ignore[arg-type]
    mixed = (*given[:2], every_third)
    assert goes_farther_in_most_windows(*mixed, settings) is False, "in a third of them it is no better"  # type: ignore[arg-type]
    few = [side[1:] for side in given]
    assert goes_farther_in_most_windows(*few, settings) is False, "five windows are too few"  # type: ignore[arg-type]


@pytest.mark.parametrize("lasts", ["name", "curve", ""])
def test_where_nothing_is_left_of_names_the_curve_that_they_stood_for_is_asked(monkeypatch, stub, lasts: str) -> None:
    """Seen: a brake along a part of a rail, told as a mode that removed none of the held-out error; the curve removed 46 %."""
    plain = stub(effects=())
    curve, name = (stub(prefix=p, mechanism=stub(free=p == "curve")) for p in ("curve", "name"))
    named = SearchState(plain, stub(effects=(name,)))
    state = SearchState(plain, stub(effects=(curve,)), named=named)

    def stage(found: SearchState) -> Any:
        yield found
        return found

    def borne_out(study: Any, asked: SearchState, others: Any) -> Any:
        return stage(asked if asked.prefixes == {lasts} else asked.at(plain))

    monkeypatch.setattr(take_back, "_names_for_curve", lambda study, state, others: stage(named))
    for law in ("with_simpler_laws", "with_wider_laws", "second_choice"):
        monkeypatch.setattr(take_back, law, lambda study, state, others: stage(state))
    monkeypatch.setattr(take_back, "_what_is_borne_out", borne_out)
    found = result_of(take_back.confirm(stub(working_on=lambda text: None), state, stub()))
    assert found.prefixes == ({lasts} if lasts else set()) and found.named is None


@pytest.mark.parametrize(("share", "own", "untouched"), [(0.004, 0.0, True), (0.004, 0.01, False), (0.3, 0.0, False)])
def test_what_is_never_reached_on_held_out_experiments_is_not_taken_back_by_them(
    monkeypatch, stub, share: float, own: float, untouched: bool
) -> None:
    """Seen: an amplifier's limit, reached in one experiment alone. What frees the other parameters by much is no such thing."""
    asked = {("refit", "full"): Gain(share, 0.003), ("same values", "full"): Gain(own, 0.0)}
    for module in (take_back, exercised):
        monkeypatch.setattr(module, "gain", lambda before, after: asked[before, after])
    monkeypatch.setattr(take_back, "size", lambda *args: 0.0)
    monkeypatch.setattr(take_back, "timelines", lambda *args: ())
    fits = {"plain": "plain", "with it": "full", "without": "refit"}
    others = stub(
        fits=fits.__getitem__,
        fits_at=lambda hypothesis, values: {"without": "same values"}[hypothesis],
        study=stub(settings=DiagnosisSettings()),
    )
    current = stub(values=dict)
    fits[current] = "full"
    state = stub(plain="plain", current=current, effects=("one",), without={"actuator.torque_saturation": "without"})
    (found,) = take_back.held_out_gains(state, others).values()
    assert found.untouched is found.unexercised(DiagnosisSettings()) is untouched
