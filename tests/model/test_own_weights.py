"""A model with a network of its own in its equations: weights that are no declared parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.model.own_weights import own_weights


class Cart(gt.GreyBoxModel):
    """A cart with a resistance that a network in it has learned elsewhere."""

    states = [gt.State("v", "m/s", initial="measured")]
    inputs = [gt.Input("force", "N")]
    outputs = [gt.Output("v", "m/s")]
    parameters = [gt.Parameter("m", 2.0, unit="kg", lower=0.1), gt.Parameter("b", 1.0, unit="N s/m", lower=0.0)]
    ports = [gt.Body("cart", speed="v")]

    def __init__(self, seed: int = 0, dtype: torch.dtype = torch.float64) -> None:
        super().__init__()
        torch.manual_seed(seed)
        self.net = torch.nn.Sequential(torch.nn.Linear(1, 3), torch.nn.Tanh(), torch.nn.Linear(3, 1)).to(dtype)

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"v": (u.force - p.b * x.v + 0.1 * self.net(x.v[..., None])[..., 0] + port.cart) / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"v": x.v}


@pytest.fixture
def data() -> gt.DataSet:
    """Of 1.5 kg and 0.6 N s/m, with dry friction of 0.5 N and noise."""
    drawn, v = np.random.default_rng(0), [0.0]
    force = np.repeat(drawn.uniform(-6.0, 6.0, 40), 25)
    for f in force[:-1]:
        v.append(v[-1] + 0.02 * (f - 0.6 * v[-1] - 0.5 * np.tanh(v[-1] / 0.01)) / 1.5)
    measured = np.array(v) + 0.01 * drawn.standard_normal(len(v))
    given = {"force": force, "v": measured}
    return gt.DataSet(
        [gt.Recording.from_arrays("run", given, sample_time=0.02, units={"force": "N", "v": "m/s"})],
    )


def test_a_diagnosis_takes_them_as_they_are(data: gt.DataSet) -> None:
    """Seen: "Can't call numpy() on Tensor that requires grad" of a model with which `check` found nothing wrong."""
    model = Cart()
    found = gt.diagnose(model, data, time_limit=30)
    assert found.effects
    assert all(one.requires_grad for of in (model, found.model.plain) for one in own_weights(of).values())


def test_a_fit_says_that_they_stay(data: gt.DataSet) -> None:
    model = Cart()
    found = gt.fit(model, data)
    told = found._repr_html_()
    assert (
        "The 10 weights of net in the model stay as they are: only declared parameters are estimated and saved" in told
    )
    before, after = own_weights(model), own_weights(found.model)
    assert all(torch.equal(one, after[name]) and after[name].requires_grad for name, one in before.items())


def test_what_is_saved_is_loaded_with_the_same_weights_alone(data: gt.DataSet, tmp_path: Path) -> None:
    """Seen: a fit of 48 % that another model of the same class was loaded with, of random weights, without a word."""
    found = gt.fit(Cart(), data)
    found.save(tmp_path)
    assert gt.load(tmp_path, model=Cart()).values() == pytest.approx(found.model.values())
    with pytest.raises(UserError, match=r"its values belong to other weights .* \(load_state_dict"):
        gt.load(tmp_path, model=Cart(seed=1))


def test_single_precision_is_told_with_what_to_write(data: gt.DataSet) -> None:
    """Seen: "mat1 and mat2 must have the same dtype" alone."""
    with pytest.raises(UserError, match=r"net\.0\.weight is torch\.float32, .* \(self\.net = ….double\(\)"):
        gt.fit(Cart(dtype=torch.float32), data)
