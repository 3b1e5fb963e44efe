"""A model that uses every operation the compiled route knows, one an output."""

from __future__ import annotations

import torch
import torch.nn.functional as F

from greybox_torch import GreyBoxModel, Input, Output, Parameter, State

WEIGHT = torch.tensor([[0.5, -1.5], [2.0, 0.25]], dtype=torch.float64)
BIAS = torch.tensor([0.1, -0.2], dtype=torch.float64)


def in_place(a, b):
    total = a * 2.0
    total += b
    total.mul_(a).sub_(1.0)
    return total


def pair(x):
    return torch.stack([x.a, x.b], dim=-1)


def matrix(x, p):
    """Diagonally dominant, (..., 2, 2)."""
    upper = torch.stack([3.0 + x.a**2, torch.sin(x.b)], -1)
    return torch.stack([upper, torch.stack([0.5 * torch.cos(x.a), 2.0 + p.c * x.b**2], -1)], -2)


def larger(x, p, size):
    """A matrix (..., size, size) whose first pivot is zero."""
    rows = [
        torch.stack(
            [torch.sin(x.a * (i + 1) + j) + (4.0 if (j - i) % size == 1 else 0.0) * (1 + p.c) for j in range(size)], -1
        )
        for i in range(size)
    ]
    rows[0] = torch.cat([torch.zeros_like(rows[0][..., :1]), rows[0][..., 1:]], -1)
    return torch.stack(rows, -2)


def vector(x, u, size=2):
    return torch.stack([x.a, x.b * u.u, x.a * x.b, u.u, x.b, x.a + 1.0][:size], -1)


# Of states a and b, the input u and the parameters c (positive) and d.
OPERATIONS = {
    "add": lambda x, u, p: x.a + p.c,
    "add_alpha": lambda x, u, p: torch.add(x.a, x.b, alpha=2.5),
    "subtract": lambda x, u, p: x.a - x.b,
    "from_number": lambda x, u, p: 1.0 - x.a,
    "multiply": lambda x, u, p: x.a * x.b * p.d,
    "divide": lambda x, u, p: x.a / (1.5 + x.b**2),
    "divide_by_parameter": lambda x, u, p: x.a / p.c + 3 / p.c,
    "divide_floor": lambda x, u, p: torch.div(x.a, 0.37, rounding_mode="floor") * x.b,
    "divide_trunc": lambda x, u, p: torch.div(x.a, 0.37, rounding_mode="trunc") * x.b,
    "negate": lambda x, u, p: -x.a,
    "power_0": lambda x, u, p: x.a**0 + x.b,
    "power_2": lambda x, u, p: x.a**2,
    "power_3": lambda x, u, p: x.a**3 * p.d,
    "power_minus_2": lambda x, u, p: (1.1 + x.a**2) ** -2,
    "power_half": lambda x, u, p: (1.1 + x.a**2) ** 0.5,
    "power_real": lambda x, u, p: x.a.abs() ** 1.7,
    "power_of_number": lambda x, u, p: 2.0**x.a,
    "power_parameter": lambda x, u, p: x.a.abs() ** p.c,
    "square": lambda x, u, p: torch.square(x.a),
    "reciprocal": lambda x, u, p: torch.reciprocal(x.a + 7),
    "rsqrt": lambda x, u, p: torch.rsqrt(x.a + 7),
    "exp": lambda x, u, p: torch.exp(-x.a),
    "expm1": lambda x, u, p: torch.expm1(x.a),
    "log": lambda x, u, p: torch.log(x.a**2 + p.c),
    "log1p": lambda x, u, p: torch.log1p(x.a**2),
    "sqrt": lambda x, u, p: torch.sqrt(x.a**2 + 0.3),
    "sin": lambda x, u, p: torch.sin(p.c * x.a),
    "cos": lambda x, u, p: torch.cos(p.c * x.a),
    "tan": lambda x, u, p: torch.tan(x.a / 4),
    "asin": lambda x, u, p: torch.asin(x.a / 6),
    "acos": lambda x, u, p: torch.acos(x.a / 6),
    "atan": lambda x, u, p: torch.atan(x.a),
    "atan2": lambda x, u, p: torch.atan2(x.a, x.b),
    "sinh": lambda x, u, p: torch.sinh(x.a),
    "cosh": lambda x, u, p: torch.cosh(x.a),
    "tanh": lambda x, u, p: torch.tanh(p.c * x.a),
    "erf": lambda x, u, p: torch.erf(x.a),
    "abs": lambda x, u, p: abs(x.a) * x.b,
    "sign": lambda x, u, p: torch.sign(x.a) * x.b,
    "sgn": lambda x, u, p: torch.sgn(x.a) * x.b,
    "floor": lambda x, u, p: torch.floor(x.a) * x.b,
    "maximum": lambda x, u, p: torch.maximum(x.a, x.b),
    "minimum": lambda x, u, p: torch.minimum(x.a, x.b * p.d),
    "clamp": lambda x, u, p: x.a.clamp(-1.05, 0.55),
    "clamp_min": lambda x, u, p: x.a.clamp(min=-0.33),
    "clamp_max": lambda x, u, p: torch.clamp_max(x.a, 0.44),
    "clamp_by_tensors": lambda x, u, p: torch.clamp(x.a, -p.c, p.c),
    "relu": lambda x, u, p: torch.relu(x.a),
    "sigmoid": lambda x, u, p: torch.sigmoid(x.a),
    "silu": lambda x, u, p: F.silu(x.a),
    "softplus": lambda x, u, p: F.softplus(x.a),
    "softplus_sharp": lambda x, u, p: F.softplus(x.a, beta=3.0, threshold=5.0),
    "softplus_of_much": lambda x, u, p: F.softplus(500.0 * x.a),
    "remainder": lambda x, u, p: x.a % 0.7,
    "heaviside": lambda x, u, p: torch.heaviside(x.a, torch.tensor(0.5, dtype=torch.float64)) * x.b,
    "where": lambda x, u, p: torch.where(x.a > x.b, x.a**2, p.d * x.b),
    "where_numbers": lambda x, u, p: torch.where(x.a > 0.1, 1.0, -1.0) * x.b,
    "where_parameter": lambda x, u, p: torch.where(p.c > 1.0, x.a, x.b),
    "where_and": lambda x, u, p: torch.where((x.a > 0) & (x.b < 0), x.a, x.b),
    "where_or": lambda x, u, p: torch.where((x.a >= 0) | ~(x.b <= 0), x.a, x.b),
    "where_logical": lambda x, u, p: torch.where(
        torch.logical_not(torch.logical_or(x.a > 0, torch.logical_and(x.b > 0, x.a != 1.0))), x.a, x.b
    ),
    "where_equal": lambda x, u, p: torch.where(torch.sign(x.a) == torch.sign(x.b), x.a, x.b),
    "condition_as_number": lambda x, u, p: (x.a > 0) * x.a + (x.b > 0).double(),
    "condition_of_parameter": lambda x, u, p: (p.c > 1.0) * x.a,
    "condition_alone": lambda x, u, p: x.a > 0.2,
    "conditions_differ": lambda x, u, p: torch.where((x.a > 0) != (x.b > 0), x.a, x.b),
    "number_as_condition": lambda x, u, p: torch.where(torch.floor(x.a).bool(), x.a, x.b),
    "in_place": lambda x, u, p: in_place(x.a, x.b),
    "zeros_like": lambda x, u, p: torch.zeros_like(x.a) + torch.ones_like(x.b) * x.a + torch.full_like(x.a, 3.0),
    "new_zeros": lambda x, u, p: x.a.new_zeros(()) + x.b,
    "solve": lambda x, u, p: torch.linalg.solve(matrix(x, p), vector(x, u))[..., 0] * p.d,
    "solve_columns": lambda x, u, p: torch.linalg.solve(
        matrix(x, p), matrix(x, p) * p.d[..., None, None] + vector(x, u)[..., None]
    )[..., 1, 0],
    "solve_three": lambda x, u, p: torch.linalg.solve(larger(x, p, 3), vector(x, u, 3))[..., 2],
    "solve_six": lambda x, u, p: torch.linalg.solve(larger(x, p, 6), vector(x, u, 6)).sum(-1),
    "inverse": lambda x, u, p: torch.linalg.inv(matrix(x, p))[..., 1, 0],
    "determinant": lambda x, u, p: torch.linalg.det(larger(x, p, 4)),
    "matrix_vector": lambda x, u, p: (matrix(x, p) @ vector(x, u).unsqueeze(-1)).squeeze(-1)[..., 1],
    "matrix_matrix": lambda x, u, p: (matrix(x, p) @ matrix(x, p).mT)[..., 0, 1],
    "constant_matrix": lambda x, u, p: (vector(x, u) @ WEIGHT)[..., 1],
    "einsum": lambda x, u, p: torch.einsum("...ij,...j->...i", matrix(x, p), vector(x, u))[..., 0],
    "quadratic_form": lambda x, u, p: (vector(x, u) * (vector(x, u).unsqueeze(-2) @ matrix(x, p)).squeeze(-2)).sum(-1),
    "unbind": lambda x, u, p: vector(x, u).unbind(-1)[1],
    "mean": lambda x, u, p: vector(x, u, 3).mean(-1),
    "diagonal": lambda x, u, p: matrix(x, p).diagonal(dim1=-2, dim2=-1).sum(-1),
    "diagonal_matrix": lambda x, u, p: (torch.diag_embed(vector(x, u)) @ matrix(x, p))[..., 1, 1],
    "sum": lambda x, u, p: torch.sum(pair(x), dim=-1),
    "stack_and_index": lambda x, u, p: torch.stack([x.a, x.b, u.u])[1] * x.a,
    "slice_and_cat": lambda x, u, p: torch.cat([pair(x)[..., 1:], pair(x)[..., :1]], dim=-1)[..., 0],
    "squeeze": lambda x, u, p: x.a.unsqueeze(-1).squeeze(-1) * u.u,
    "detach": lambda x, u, p: x.a.clone() * u.u,
    "input": lambda x, u, p: p.d * u.u**2 + x.a,
    "constant": lambda x, u, p: torch.zeros((), dtype=torch.float64),
    "parameters_only": lambda x, u, p: p.c * torch.exp(p.d),
}


class Operations(GreyBoxModel):
    """Outputs are named after the operations; the rates do not matter."""

    states = [State("a"), State("b")]
    inputs = [Input("u")]
    outputs = [Output(name) for name in OPERATIONS]
    parameters = [Parameter("c", 0.8, lower=0.0), Parameter("d", -0.6)]

    def derivative(self, x, u, p, port):
        return {"a": -x.a, "b": -p.c * x.b}

    def output(self, x, u, p):
        return {name: operation(x, u, p) for name, operation in OPERATIONS.items()}


class Exponential(GreyBoxModel):
    """exp(k u)."""

    states = [State("unused")]
    inputs = [Input("u")]
    outputs = [Output("y")]
    parameters = [Parameter("k", 1.0)]

    def derivative(self, x, u, p, port):
        return {"unused": -x.unused}

    def output(self, x, u, p):
        return {"y": torch.exp(p.k * u.u)}
