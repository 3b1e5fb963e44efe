"""What the free runs of an estimate say about the model."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.fit_advice import begun_with, fit_advice, lost_in_one, lost_outputs
from greybox_torch.estimate.comparison import Score
from greybox_torch.estimate.problem import make_problem
from tests.api.motor import Motor
from tests.api.test_fit_many import motors

BEGUN = "the start values of the card"


def scores(role: str, *fits: float) -> list[Score]:
    return [Score("one", role, "y", fit, np.inf if np.isinf(fit) else 1.0) for fit in fits]


def said(before: tuple[float, ...], after: tuple[float, ...], role: str = "validation") -> str | None:
    """With an estimation experiment beside that is always simulated well."""
    well = scores("estimation", 99.0)
    return fit_advice({"start": [*well, *scores(role, *before)], "refit": [*well, *scores(role, *after)]}, BEGUN)


@pytest.mark.parametrize(
    ("before", "after"), [((50.0,), (90.0,)), ((80.0, 60.0), (79.5, 60.0)), ((-300.0,), (20.0,)), ((-np.inf,), (3.0,))]
)
def test_nothing_is_said_of_an_estimate_that_predicts_no_worse(before, after) -> None:
    assert said(before, after) is None


def test_an_estimate_that_predicts_worse_than_its_start_is_said_to() -> None:
    """Seen: a conveyor with dry friction left out, fitted; nothing but the table showed that validation had become worse."""
    told = said((90.0, 80.0), (40.0, 20.0))
    assert told is not None and "worse than the start values of the card did (mean fit 30 % for 85 %)" in told
    assert "--starts 128" in told and "greybox diagnose" in told, "seen: the diagnosis then found nothing missing"


def test_a_model_that_cannot_follow_the_machine_is_said_to() -> None:
    told = said((-900.0,), (-186.0,))
    assert told is not None and "no better than a constant would (mean fit -186 %)" in told
    assert "another sign, unit or meaning than the card says (`greybox inspect` draws them)" in told, (
        "seen: a voltage of the wrong sign"
    )
    assert "a term of the equations has the wrong sign" in told, "seen: gravity, of which diagnose added twice as much"


def test_of_a_machine_whose_free_runs_overflow_nothing_is_said() -> None:
    assert said((50.0,), (-np.inf,)) is None


def test_without_validation_the_estimation_experiments_count() -> None:
    told = said((-900.0,), (-500.0,), role="estimation")
    assert told is not None and "the estimation experiments" in told


def test_of_outputs_that_never_move_nothing_is_said() -> None:
    still, bad = Score("one", "validation", "y", -np.inf, 1.0), Score("one", "validation", "z", -40.0, 1.0)
    assert fit_advice({"start": [still], "refit": [still]}, BEGUN) is None
    told = fit_advice({"start": [still, bad], "refit": [still, bad]}, BEGUN)
    assert told is not None and "(mean fit -40 %)" in told


def test_an_output_that_is_lost_behind_a_good_mean_is_told() -> None:
    """Seen: a pressure read a hundred times too small, of which a mean fit of 21 % said nothing."""

    def of(*fits: float) -> str | None:
        return lost_outputs({"refit": [Score("one", "validation", f"y{k}", fit, 1.0) for k, fit in enumerate(fits)]})

    told = of(95.0, 96.0, -10.0)
    assert told is not None and told.startswith("y2 (-10 %) is simulated no better than a constant would")
    assert "the mean fit of 60.3 % hides" in told
    two = of(99.0, -1.0, -2.0)
    assert two is not None and two.startswith("y1 (-1 %) and y2 (-2 %) are simulated")
    hardly = of(95.0, 96.0, 0.6)
    assert hardly is not None and hardly.startswith("y2 (0.6 %) is simulated hardly better than a constant would")
    assert of(95.0, 3.0) is None and of(10.0, -90.0) is None, "of all that is lost the other sentence speaks"
    assert of(95.0, -np.inf) is None


def test_an_output_that_is_lost_in_one_experiment_is_told() -> None:
    """Seen: a current of the other sign in one file, -120 % there and 34 % in validation, and no word of it."""

    def of(*told: tuple[str, float, float], role: str = "estimation") -> str | None:
        roles = [role] * (len(told) - 1) + ["validation"]
        return lost_in_one({"refit": [Score(n, r, "current", f, e) for (n, f, e), r in zip(told, roles, strict=True)]})

    others = (("lauf2", 30.8, 4.5), ("lauf3", 34.0, 3.86))
    told = of(("lauf1", -119.7, 12.4), *others)
    assert told is not None and "current in lauf1 (-120 %, in lauf3 34 %)" in told and "another sign, unit" in told
    assert of(("lauf1", -119.7, 12.4), ("lauf1 (held out)", 34.0, 3.9)) is None, "the rest of the same file"
    assert of(("lauf1", -10.0, 4.6), *others) is None, "as large an error as elsewhere: little moved there"
    assert of(("lauf1", -119.7, 12.4), ("lauf3", -50.0, 3.9)) is None, "lost everywhere"
    assert of(("lauf1", -119.7, 12.4), *others, role="validation") is None, "what is lost in validation is judged there"


def test_where_the_start_values_came_from_is_named() -> None:
    """Seen: "worse than the values of the card" of an estimate begun with a checkpoint's, without a value on the card."""
    (data,) = motors(1)

    def of(model: gt.GreyBoxModel, **card: float) -> str:
        parameters = {name: {"value": value} for name, value in card.items()}
        own = gt.DataSet(data.recordings, parameters=parameters)
        return begun_with(make_problem(own, model, own.estimation()), own)

    held = Motor()
    held.set_values({"J": 0.02})
    free = Motor()
    assert of(free, J=0.03, b=0.1) == "the start values of the card"
    assert of(held).startswith("the start values held by the model (of a checkpoint, a result or set_values)")
    assert "of the card" not in of(held, J=0.03) and of(held, J=0.03).endswith(" and of the model file")
    assert of(free) == "the start values of the model file"
