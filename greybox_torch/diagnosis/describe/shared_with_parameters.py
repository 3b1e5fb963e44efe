"""Parameters of the model that do what its unknown curve can do: their values go with the curve as it is drawn.

A conductance beside a curve over the wind that multiplies the same difference of temperatures is a constant of that curve, and a damping
beside a curve over the speed is a straight line in it. The recordings determine the sum of both.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.curve import Curve
from greybox_torch.diagnosis.describe.along_records import along_records
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.beside_curves import whole
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.problem import Problem
from greybox_torch.in_unit import in_unit
from greybox_torch.linear_algebra import least_squares
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.name_lists import listed

SAME = 1e-3
"""Share of what a parameter changes, squared, that no curve may lack for it to do what the curve does."""

INDEPENDENT = 1e-6
"""Singular values below this share of the largest are taken for zero."""


def shared_with_parameters(fitted: Hypothesis, attachment: Attachment, at: Problem, curve: Curve | None) -> str:
    """Which free parameters of the model do what the curve of an effect may do, and with which curve their values go, a clause; "" for
    none, and for an effect that is no curve.

    Args:
        at: the values that the verdict gives.
        curve: as the report draws it.
    """
    if type(attachment.mechanism) is not Unknown or curve is None:
        return ""
    found = _doing_the_same(fitted, attachment, at)
    if not found:
        return ""
    units = {p.name: p.unit for p in fitted.model.declared_parameters}
    values = listed([in_unit(f"{name} = {at.values_by_name[name]:.4g}", units.get(name, "")) for name in found])
    does, holds = ("does", "holds") if len(found) == 1 else ("do", "hold")
    return (
        f"the model's {listed(found)} {does} what such a curve can do as well: the recordings determine what both do together, not the "
        f"part of either, and {values} {holds} with the curve as it is drawn{_where_zero(curve)}"
    )


def _where_zero(curve: Curve) -> str:
    """Where a curve is zero, a clause; "" where it is so nowhere, or at several places."""
    force, values = curve.force, curve.values
    between = np.flatnonzero(np.sign(force[:-1]) * np.sign(force[1:]) < 0)
    part = force[between] / (force[between] - force[between + 1])
    places = [*values[force == 0.0], *(values[between] + part * (values[between + 1] - values[between]))]
    if len(places) != 1:
        return ""
    at = float(places[0])
    return f", which is zero at {in_unit(f'{curve.signal} = {digits(at)}', curve.unit)}"


def _doing_the_same(fitted: Hypothesis, attachment: Attachment, at: Problem) -> list[str]:
    """The free parameters of the model of which a change moves rates and outputs as some change of the curve's heights does."""
    model = fitted.model
    assert isinstance(model, AugmentedModel)
    own = {p.name for p in model.base.declared_parameters}
    with_all = AugmentedModel(model.base, [whole(effect) for effect in fitted.effects], model.surroundings)
    values = {p.name: 0.0 if p.shrunk else p.value for p in with_all.declared_parameters} | at.values_by_name
    changes = along_records(fitted, with_all, values)
    mechanism = whole(attachment).mechanism
    assert isinstance(mechanism, Unknown)
    heights = [f"{attachment.prefix}.w_{k}" for k in mechanism.bumps]
    by_height = [changes.between({name: values[name]}, {name: values[name] + 1.0}) for name in heights]
    names = [n for n, free in zip(at.names, at.free, strict=True) if free and n in own]
    bounds = dict(zip(at.names, zip(at.lower, at.upper, at.expected, strict=True), strict=True))
    slopes = {n: changes.slope(n, (float(bounds[n][0]), float(bounds[n][1])), float(bounds[n][2])) for n in names}
    return [name for name in names if _spanned(by_height, slopes[name])]


def _spanned(by_height: Sequence[np.ndarray], slope: np.ndarray) -> bool:
    """Whether a sum of changes (n, N) by the heights, in any amounts, is that by a parameter, each of the n as exactly."""
    if not np.isfinite(slope).all() or not slope.any():
        return False
    there = np.mean([(one**2).mean(axis=1) for one in by_height], axis=0)
    scale = np.sqrt(np.maximum((slope**2).mean(axis=1), there))
    rows = scale > 0
    columns = np.stack([(one[rows] / scale[rows, None]).ravel() for one in by_height], axis=1)
    wanted = (slope[rows] / scale[rows, None]).ravel()
    lengths = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    left = wanted - columns / lengths @ least_squares(columns / lengths, wanted, rcond=INDEPENDENT)
    return bool(left @ left <= SAME * (wanted @ wanted))
