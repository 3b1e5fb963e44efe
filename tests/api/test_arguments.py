"""Arguments at fault, named as Python names them, and results that cannot be saved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.plain_arguments import check_seconds, check_seed
from tests.api.motor import Motor


def max_of_two(a, b):
    return max(a, b)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m, d: gt.train(m, d, net="fiction"), "net: found 'fiction', unknown (did you mean \"friction\"?); expected"),
        (lambda m, d: gt.train(m, d, port="rotary"), "port: found 'rotary', model Motor has no such port"),
        (lambda m, d: gt.train(m, d, signals="speed"), "signals: found 'speed', expected a list of names, such as [\"speed\"]"),
        (lambda m, d: gt.train(m, d, ensemble=0), "ensemble: found 0, expected a whole number from 1 to 1000"),
        (lambda m, d: gt.train(m, d, resume=True), "resume: found True, expected a snapshot to take the training up from"),
        (lambda m, d: gt.train(m, d, settings=None), "settings: found None, expected TrainingSettings(…)"),
        (lambda m, d: gt.diagnose(m, d, time_limit=-1), "time_limit: found -1, expected a number above 0"),
        (lambda m, d: gt.diagnose(m, d, settings={}), "settings: found an object of type dict, expected DiagnosisSettings(…)"),
        (lambda m, d: gt.fit(m, d, starts=0), "starts: found 0, expected a whole number from 1 to 4096"),
        (lambda m, d: gt.fit(m, d, seed=-1), "seed: found -1, expected a whole number from 0 to 4294967295"),
        (lambda m, d: gt.fit(m, d, profiles="J"), "profiles: found 'J', expected a list of names, such as [\"J\"]"),
        (lambda m, d: gt.fit(m, d, profiles=["k"]), "profiles: found 'k', this parameter is fixed; expected one of"),
        (lambda m, d: gt.fit(m, d, progress=None), "progress: found None, expected a function that is called with a text; leave"),
        (lambda m, d: gt.fit_many(m, [d], progress=3), "progress: found 3, expected a function"),
        (lambda m, d: gt.train(m, d, progress=3), "progress: found 3, expected a function that is called with a Report"),
        (lambda m, d: gt.diagnose(m, d, progress=3), "progress: found 3, expected a function"),
        (lambda m, d: gt.diagnose(m, d, on_progress=3), "on_progress: found 3, expected a function that is called with a Progress"),
        (lambda m, d: gt.diagnose(m, d, on_progress=lambda: 3), "on_progress: found lambda(), expected a function"),
        (lambda m, d: gt.fit(m, d, progress=max_of_two), "progress: found max_of_two(a, b), expected a function that is"),
        (lambda m, d: gt.design("results", progress=3), "progress: found 3, expected a function"),
        (lambda m, d: gt.fleet("machines", "results", progress=3), "progress: found 3, expected a function"),
        (lambda m, d: gt.simulate(Motor, d), "model: found the class Motor, expected an object of it: Motor()"),
        (lambda m, d: gt.fit("a.py:A", d), 'model: found an object of type str, expected a model, as load_model("a.py:A") gives one, or'),
        (lambda m, d: gt.simulate(m, [d]), "data: found an object of type list, expected a DataSet, as load_dataset()"),
        (lambda m, d: gt.inspect("card.toml"), "card.toml: no such file"),
        (lambda m, d: gt.fit(d, m), "model: found an object of type DataSet, expected a model first, and the data second"),
        (lambda m, d: gt.compare({"m": m}, d), "models: found an object of type DataSet, expected the data first: compare("),
        (lambda m, d: gt.evaluate(m, d), "data: found an object of type Motor, expected a DataSet first, or a card by path, as in"),
        (lambda m, d: gt.simulate("a/dataset.toml", m), "model: found 'a/dataset.toml', expected a model first, and the data second"),
        (lambda m, d: gt.train(Path("a.toml"), m), "model: found 'a.toml', expected a model first, and the data second"),
        (lambda m, d: gt.check("a.toml", m), "model: found 'a.toml', expected a model first, and the data second"),
        (lambda m, d: gt.check(d, m), "model: found an object of type DataSet, expected a model first, and the data second"),
        (lambda m, d: gt.check(m, [d]), "data: found an object of type list, expected a DataSet, as load_dataset()"),
        (lambda m, d: gt.compare({"m": m}, "a.toml"), "models: found an object of type str, expected the data first: compare("),
        (lambda m, d: gt.inspect(d, Motor), "model: found the class Motor, expected an object of it: Motor()"),
        (lambda m, d: gt.simulate(m, d, device="tpu"), "device: found 'tpu', expected \"cpu\", \"cuda\" or \"cuda:N\""),
        (lambda m, d: gt.simulate(m, d, precision="half"), "precision: found 'half', expected \"double\" or \"single\""),
        (lambda m, d: gt.compare(d, [m]), "models: found an object of type list, expected models by name"),
        (lambda m, d: gt.compare(d, {}), "models: found none, expected models by name"),
        (lambda m, d: gt.residuals(m, d).plot("sweep"), "experiment: found 'sweep', expected one of Steps, More steps, Sweep"),
        (lambda m, d: gt.simulate(m, d).plot("sweep"), "experiment: found 'sweep', expected one of Steps, More steps, Sweep"),
    ],
)  # fmt: skip
def test_arguments_at_fault(data: gt.DataSet, call: Callable[[Any, Any], Any], message: str) -> None:
    with pytest.raises(gt.UserError) as caught:
        call(Motor(), data)
    assert str(caught.value).startswith(message)


def test_data_may_be_given_by_their_card(folder: Path) -> None:
    """Seen: ``gt.diagnose(model, "dataset.toml")`` refused, where `card` takes a model by its name."""
    card = folder / "dataset.toml"
    assert gt.simulate(Motor(), str(card)).scores == gt.simulate(Motor(), gt.load_dataset(card)).scores
    assert gt.residuals(Motor(), card).run.data.name == "Motor on the bench"
    results = [
        gt.compare(card, {"start": Motor()}),
        *gt.fit_many(Motor(), [card]),
        gt.inspect(card),
        gt.fit(Motor(), card),
        gt.evaluate(card, model=Motor()),
    ]
    assert gt.check(Motor(), card).to_dict() == gt.check(Motor(), gt.load_dataset(card)).to_dict()
    assert {one.data.name for one in results if not isinstance(one, Exception)} == {"Motor on the bench"}


def test_numbers_of_numpy_are_numbers() -> None:
    """Seen: ``time_limit=np.int64(60)`` refused with "expected a number above 0"."""
    seconds, seed = check_seconds("time_limit", np.int64(60)), check_seed(np.int64(7))
    assert (type(seconds), seconds, type(seed), seed) == (float, 60.0, int, 7)
    assert check_seconds("time_limit", np.float32(0.5)) == 0.5
    for wrong in (True, np.True_, "60", np.array([60])):
        with pytest.raises(gt.UserError, match="time_limit: found"):
            check_seconds("time_limit", wrong)
        with pytest.raises(gt.UserError, match="seed: found"):
            check_seed(wrong)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda x: x.speed.add_(1.0), "model Sly: the equations of Sly change the signals that they are given"),
        (lambda x: 1j * x.speed, "model Sly: Sly.derivative() returned complex numbers for speed; expected real ones"),
        (lambda x: 1 / 0, "model Sly: test_arguments.py, line"),
    ],
)
def test_a_model_whose_equations_cannot_be_trusted(
    data: gt.DataSet, change: Callable[[Any], Any], message: str
) -> None:
    class Sly(Motor):
        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"speed": change(x) + port.rotor}

    with pytest.raises(gt.UserError) as caught:
        gt.simulate(Sly(), data)
    assert str(caught.value).startswith(message)


def test_nothing_is_half_saved(folder: Path, data: gt.DataSet) -> None:
    (folder / "saved" / "residuals.png").mkdir(parents=True)
    with pytest.raises(gt.UserError, match=r"residuals.png: cannot be written: it is a folder"):
        gt.residuals(Motor(), data).save(folder / "saved")
    assert [path.name for path in (folder / "saved").iterdir()] == ["residuals.png"]
