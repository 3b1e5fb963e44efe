"""What the networks at a port share: which signals they read, how these are scaled, and the weights as declared parameters.

Weights are parameters of the model like any other, so that the compiled stepper has tangents for them, Gauss-Newton can polish them, and a
checkpoint keeps them by name. A network of one hidden layer with some ten units has enough freedom for a curve over one or two signals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.unknown import INPUT
from greybox_torch.model import Parameter, Signals

MOST_UNITS = 256


def own_name(signal: str) -> str:
    """What parameters are called by that belong to a signal: of one from elsewhere in the model without the sign in its name."""
    return signal.replace("@", "_")


def spoken(signal: str) -> str:
    """A signal as it is told: an input by its name, that of another port with the port's."""
    if signal.startswith(INPUT):
        return signal.removeprefix(INPUT)
    name, _, port = signal.partition("@")
    return f"{name} of {port}" if port else name


class Network(Mechanism):
    """One hidden layer of ``units`` at a port, reading the local signals ``inputs``.

    Input i is scaled to σ_i = (s_i − centre_i) / scale_i, with centre and scale from where the signal moved in the recordings (fixed
    parameters). The weights of the output are zero to begin with, so that the hybrid begins as the physics, and are held weakly towards
    zero, so that physics is preferred; those of the hidden layer are drawn with ``seed``.

    Raises:
        UserError: no input, an input named twice, or a number of units that is none.
    """

    source = (
        "G. Cybenko, Approximation by superpositions of a sigmoidal function, Math. Control Signals Systems 2, 1989"
    )

    def __init__(self, inputs: Sequence[str], units: int = 8, seed: int = 0) -> None:
        self.inputs = tuple(inputs)
        self.units = units
        self.seed = seed
        self.needs = self.inputs
        self.reads = tuple(name for name in self.inputs if "@" in name)
        if not self.inputs or len(set(self.inputs)) < len(self.inputs):
            raise UserError(f"{self.name}: inputs are {list(self.inputs)}; expected one signal or more, each once")
        if not (isinstance(units, int) and 1 <= units <= MOST_UNITS):
            raise UserError(f"{self.name}: units is {units!r}; expected a whole number from 1 to {MOST_UNITS}")

    def span(self, name: str, around: Surroundings) -> tuple[float, float]:
        """Lowest and highest value of an input as the hidden layer reads it, in its unit."""
        if name not in around.ranges:
            raise UserError(
                f"{self.name}: there is no signal '{name}' at this port (there is: {', '.join(around.ranges)})"
            )
        return around.ranges[name].low, around.ranges[name].high

    def scaling(self, around: Surroundings) -> list[Parameter]:
        """Centre and scale of every input: the fixed parameters that map where it moved to [−1, 1]."""
        result = []
        for name in self.inputs:
            low, high = self.span(name, around)
            unit, half = around.units.get(name, ""), max(0.5 * (high - low), 1e-9 * max(abs(low), abs(high), 1e-3))
            result.append(
                Parameter(
                    f"{own_name(name)}_centre",
                    0.5 * (low + high),
                    unit,
                    fixed=True,
                    description=f"middle of {spoken(name)}",
                )
            )
            result.append(
                Parameter(
                    f"{own_name(name)}_scale", half, unit, fixed=True, description=f"half the range of {spoken(name)}"
                )
            )
        return result

    def scaled(self, s: Signals, p: Signals) -> dict[str, Any]:
        """The inputs σ as the hidden layer reads them."""
        return {name: (s[name] - p[f"{own_name(name)}_centre"]) / p[f"{own_name(name)}_scale"] for name in self.inputs}

    def heights(self, around: Surroundings, *, lower: float | None = None) -> list[Parameter]:
        """The weights of the output, in the unit of the port's force."""
        return [
            Parameter(f"out_{k}", 0.0, around.force_unit, lower=lower, description=f"height of unit {k}", shrunk=True)
            for k in range(self.units)
        ]

    def slanted(self) -> list[Parameter]:
        """Weights of hidden units that turn over along a straight line through the inputs: ``INPUT_k`` and ``bias_k``.

        The places where they turn are spread over the range of the first input, those along the others are drawn.
        """
        rng = np.random.default_rng(self.seed)
        result = []
        for k in range(self.units):
            place = rng.uniform(-1.0, 1.0, len(self.inputs))
            place[0] = 2.0 * (k + rng.uniform()) / self.units - 1.0
            direction = rng.normal(size=len(self.inputs))
            slopes = max(1.0, 0.4 * self.units) * direction / np.linalg.norm(direction)
            for name, slope in zip(self.inputs, slopes, strict=True):
                result.append(
                    Parameter(
                        f"{own_name(name)}_{k}", float(slope), "", description=f"weight of {spoken(name)} in unit {k}"
                    )
                )
            result.append(Parameter(f"bias_{k}", -float(slopes @ place), "", description=f"bias of unit {k}"))
        return result

    def leaning(self, sigma: dict[str, Any], p: Signals, k: int) -> Any:
        """What hidden unit ``k`` is a function of: its bias and the weighted inputs."""
        return p[f"bias_{k}"] + sum(p[f"{own_name(name)}_{k}"] * sigma[name] for name in self.inputs)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(tuple(f"out_{k}" for k in range(self.units)))]
