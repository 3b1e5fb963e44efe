"""What a trained network is explained to be: a law of the library where there is one, a curve with an honest band where there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from greybox_torch.api.train_explained import _not_refitted, _row, open_sign
from greybox_torch.errors import UserError
from greybox_torch.training import Trained, TrainingSettings, fit_physics, train_hybrid
from greybox_torch.training.explain import Explanation, explain, needless
from greybox_torch.training.learned_force import force_at, learned_force

from .conftest import Turntable, drag, true_friction

SHORT = TrainingSettings(epochs=8, refresh=3, patience=8, learning_rate=0.03)


@pytest.fixture(scope="module")
def of_a_law(drag_data) -> Trained:
    return train_hybrid(drag_data, Turntable(), settings=SHORT, network={"units": 5})


@pytest.fixture(scope="module")
def law(of_a_law: Trained) -> Explanation:
    return explain(of_a_law)


@pytest.fixture(scope="module")
def of_no_law(table_data) -> Trained:
    return train_hybrid(table_data, Turntable(), settings=SHORT, network={"units": 5})


@pytest.fixture(scope="module")
def no_law(of_no_law: Trained) -> Explanation:
    return explain(of_no_law)


def test_a_law_is_found_and_the_network_dropped(law: Explanation, of_a_law: Trained) -> None:
    assert law.term is not None and law.result is not None
    assert law.term.attachment.prefix == "table.quadratic_drag"
    assert law.term.lost < 0.02 and law.sentence.endswith("Drop the network.")
    estimates = dict(zip(law.result.problem.names, law.result.problem.values, strict=True))
    assert estimates["table.quadratic_drag.c"] == pytest.approx(0.01, rel=0.1)
    assert estimates["b"] == pytest.approx(0.05, rel=0.1)
    assert law.result.samples == of_a_law.result.samples
    assert law.result.mse == pytest.approx(0.02**2, rel=0.1)


def test_the_terms_are_those_that_come_near_the_curve(law: Explanation) -> None:
    by_name = {m.law.name: m for m in law.matches}
    assert law.matches[0].share == max(m.share for m in law.matches) > 0.95
    assert [m.share for m in law.matches] == sorted((m.share for m in law.matches), reverse=True)
    assert all(by_name[t.attachment.mechanism.name].share == t.match for t in law.terms)
    assert "presliding_hysteresis" not in by_name and "position_dependent_friction" not in by_name


def test_no_law_is_made_of_what_has_none(no_law: Explanation, of_no_law: Trained) -> None:
    assert no_law.term is None and no_law.result is None
    assert no_law.sentence.endswith("Keep the network.")
    assert all(t.lost > 0.02 for t in no_law.terms)


@pytest.mark.parametrize("case", ["law", "no_law"])
def test_the_band_holds_the_truth(case: str, request: pytest.FixtureRequest) -> None:
    """Total friction, the network's and the viscous one: the band of two deviations about the learned curve has the true one."""
    found = request.getfixturevalue(f"of_a_{case}" if case == "law" else "of_no_law")
    (curve,) = request.getfixturevalue(case).curves
    assert curve.signal == "speed" and curve.unit == "rad/s" and curve.share > 0.97
    viscous = dict(zip(found.result.problem.names, found.result.problem.values, strict=True))["b"]
    true = (drag if case == "law" else true_friction)(curve.values) - 0.05 * curve.values
    error = curve.force - viscous * curve.values - true
    inside = np.abs(error) < 2.0 * curve.deviation + 0.002
    assert np.mean(inside) > 0.8
    assert np.median(curve.deviation) < 0.3 * np.abs(curve.force).max()


def test_slopes_by_finite_differences(of_a_law: Trained) -> None:
    signals = {"speed": np.linspace(-3.0, 3.0, 7)}
    force, slope = force_at(of_a_law, signals)
    np.testing.assert_allclose(force, of_a_law.force(**signals), rtol=1e-12)
    problem = of_a_law.result.problem
    names = [n for n in problem.free_names if n.startswith("table.friction_net.")]
    assert slope.shape == (7, len(names))
    for k, name in enumerate(names):
        step = 1e-6 * (np.arange(len(problem.names)) == problem.names.index(name))
        moved = replace(of_a_law, result=replace(of_a_law.result, problem=problem.with_values(problem.values + step)))
        difference = (moved.force(**signals) - force) / 1e-6  # upwards: a height may lie at its bound, which is zero
        np.testing.assert_allclose(slope[:, k], difference, rtol=1e-4, atol=1e-6)


def test_several_trainings_widen_the_band(of_no_law: Trained, no_law: Explanation, table_data) -> None:
    other = train_hybrid(
        table_data,
        Turntable(),
        settings=replace(SHORT, seed=1),
        network={"units": 5},
        physics=fit_physics(table_data, Turntable(), settings=SHORT),
    )
    both = explain(of_no_law, [other], refit=False)
    assert both.members == 2 and not both.terms
    (curve,), (alone,) = both.curves, no_law.curves
    second = force_at(other, learned_force(of_no_law).signals)[0]
    assert curve.force.mean() == pytest.approx(0.5 * (alone.force.mean() + second.mean()), abs=0.01)
    assert np.all(curve.deviation**2 >= 0.5 * alone.deviation**2)


def test_another_network_is_refused(of_no_law: Trained) -> None:
    elsewhere = replace(of_no_law.hybrid.network, port="actuator")
    other = replace(of_no_law, hybrid=replace(of_no_law.hybrid, attachments=(elsewhere,)))
    with pytest.raises(UserError, match="a network at actuator reading speed; expected one at table reading speed"):
        explain(of_no_law, [other], refit=False)


def test_a_network_at_zero(of_no_law: Trained) -> None:
    alone = next(c for c in of_no_law.polished.choices if c.weight is None)
    zero = replace(of_no_law, polished=replace(of_no_law.polished, chosen=alone))
    assert explain(zero) == Explanation()
    assert "nothing to explain" in Explanation().sentence


def test_a_term_no_better_than_physics_does_not_count(law: Explanation, of_a_law: Trained) -> None:
    alone = next(c for c in of_a_law.polished.choices if c.weight is None)
    poor = replace(law.terms[0], held_out=alone.held_out, lost=0.0)
    assert needless([poor], of_a_law) is None
    assert needless([poor, law.terms[0]], of_a_law) is law.terms[0]


def test_hybrid_of_an_augmented_model(drag_data, law: Explanation) -> None:
    """A network beside a named law has nothing left to learn; it begins where the estimate of both is."""
    assert law.term is not None
    augmented = law.term.problem.model
    physics = fit_physics(drag_data, augmented, values={"table.quadratic_drag.c": 0.008}, settings=SHORT)
    values = dict(zip(physics.result.problem.names, physics.result.problem.values, strict=True))
    assert values["table.quadratic_drag.c"] == pytest.approx(0.01, rel=0.1)
    found = train_hybrid(drag_data, augmented, settings=replace(SHORT, epochs=1), physics=physics)
    assert found.physics is physics.result
    assert np.abs(found.force(speed=np.linspace(-3, 3, 9))).max() < 0.01
    assert torch.is_tensor(augmented.base.raw["b"])


def test_a_law_that_cannot_be_simulated_is_told(law: Explanation) -> None:
    """Seen: "not put there: others match more" of a law of 99 %, which had been put there, beside one of 90 %."""
    without = tuple(term for term in law.terms if term.attachment.mechanism.name != "quadratic_drag")
    failed = replace(law, terms=without, term=None, failed=("quadratic_drag",))
    drag = next(m for m in law.matches if m.law.name == "quadratic_drag")
    assert _not_refitted(drag, failed) == "tried in its place: the simulation overflows"
    others = [_not_refitted(replace(drag, share=share), replace(failed, failed=())) for share in (0.4, 0.9)]
    assert others == [
        "not tried in its place: it matches less than 50 %",
        "not tried in its place: others match more",
    ], 'seen: "matches less than 0.5"'
    assert "Nothing is known of quadratic_drag: with the values that match the curve" in failed.sentence or not without


def test_a_law_without_its_effect_is_not_the_closest(law: Explanation, of_a_law: Trained) -> None:
    """Seen: "with the closest, cable.backlash", whose half_gap was zero."""
    first = law.terms[0]
    assert first.absent == "" and first.attachment.mechanism.absent(
        of_a_law.hybrid.surroundings["table"], {"c": 0.0}
    ) == ("c = 0")
    nothing = replace(first, absent="c = 0")
    assert needless([nothing], of_a_law) is None
    told = replace(law, terms=(nothing,), term=None).sentence
    assert "closest" not in told and told.endswith("Keep the network.")
    *_, row = _row(nothing)
    assert row.startswith("no longer this law, as it was estimated with c = 0: c "), (
        'seen: "without its effect: F_c 28 N, F_s 0 N"'
    )


def test_where_the_band_contains_zero_is_told(law: Explanation) -> None:
    """Seen: a band of ±4 N m around a curve of ±0.5 N m, and "Keep the network" without a word of it."""
    (curve,) = law.curves
    wide = replace(curve, deviation=np.abs(curve.force) + 1.0)
    assert wide.zero_within == 1.0 and curve.zero_within < 0.5
    assert open_sign([curve]) == "" and "(speed 100 %)" in open_sign([wide])
