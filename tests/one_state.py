"""A model of one state, with whatever rate a test is about."""

from __future__ import annotations

from typing import Any

from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State


def lag(rate: Any) -> GreyBoxModel:
    """A model with one state and the rate ``rate(x, u, p)``."""

    class Lag(GreyBoxModel):
        states = [State("level")]
        inputs = [Input("flow")]
        outputs = [Output("level")]
        parameters = [Parameter("k", 0.7, lower=0.0)]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"level": rate(x, u, p)}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"level": x.level}

    return Lag()
