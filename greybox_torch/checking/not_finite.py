"""Where the equations give no number: at random points, and where a simulation begins, with the line that makes them so."""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves

from greybox_torch.checking.finding import Finding
from greybox_torch.checking.influence import Influence
from greybox_torch.checking.points import Points, start_of
from greybox_torch.checking.source import Source
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.sensed_states import sensed_states

_WRITE = (
    "torch.sqrt(a.clamp(min=1e-9)), torch.log(a.clamp(min=…)), a denominator that stays away from zero, "
    "a matrix that can be inverted"
)


def not_finite(model: GreyBoxModel, influence: Influence, points: Points, source: Source) -> Iterator[Finding]:
    """A finding where the equations give no number at some of the points, with the smallest of them."""
    lost = np.flatnonzero(~influence.finite)
    if not lost.size:
        return
    x, u = points.x.detach().numpy(), points.u.detach().numpy()
    size = np.abs(np.vstack([x, u])).max(axis=0)
    at = lost[np.argmin(size[lost])]
    shown = [f"{s.name} = {v:.3g}" for s, v in zip((*model.states, *model.inputs), (*x[:, at], *u[:, at]), strict=True)]
    one = Points(*(of.detach()[:, at : at + 1] for of in (points.x, points.u, points.p, points.f)))
    yield _finding(
        f"the equations give no number at {lost.size} of {len(influence.finite)} random points, such as {', '.join(shown[:6])}",
        source,
        _origin(model, one, source.file)[1],
    )


def not_finite_where_recorded(model: GreyBoxModel, points: Points, tries: int, source: Source) -> Iterator[Finding]:
    """A finding where the equations give no number at recorded samples, whatever the states are that no sensor shows.

    Args:
        points: with so many ``tries`` of these states for each sample, one behind the other.
    """
    x, u, p, f = points.signals(model)
    with torch.no_grad():
        given = [*model.derivative(x, u, p, f).values(), *model.outputs_with(x, u, p, f).values()]
    fine = torch.stack([torch.isfinite(torch.as_tensor(row)).expand(points.x.shape[1]) for row in given]).all(0)
    by_sample = fine.reshape(-1, tries).any(1).numpy()
    lost = np.flatnonzero(~by_sample)
    if not lost.size:
        return
    at, seen = int(lost[0]) * tries, sensed_states(model)
    one = Points(*(of[:, at : at + 1] for of in (points.x, points.u, points.p, points.f)))
    named = [(s.name, float(one.x[i, 0])) for i, s in enumerate(model.states) if s.name in seen]
    named += [(s.name, float(one.u[i, 0])) for i, s in enumerate(model.inputs)]
    others = ", whatever the other states are" if len(seen) < len(model.states) else ""
    yield _finding(
        f"the equations give no number (a root or logarithm of a negative number, or 0/0) at {lost.size} of {len(by_sample)} recorded "
        f"samples{others}, such as {', '.join(f'{name} = {value:.3g}' for name, value in named[:6])}",
        source,
        _origin(model, one, source.file)[1],
    )


def never_finite(model: GreyBoxModel, points: Points, starts: Collection[Points], source: Source) -> Finding:
    """The finding where none of the points gives numbers, however far apart they are.

    Args:
        starts: where simulations begin. An error where none of these gives numbers either: points alone are no proof, as many states may
            have to be within narrow limits.
    """
    one = Points(*(of.detach()[:, :1] for of in (points.x, points.u, points.p, points.f)))
    found = (
        "the equations give no number (nan or inf) at any of the values that were tried, from thousandths to millions"
    )
    lost = [_origin(model, start, source.file)[0] for start in starts]
    if starts and not all(lost):
        found += ", but they do where a simulation begins"
    return replace(
        _finding(found, source, _origin(model, one, source.file)[1]),
        level="error" if starts and all(lost) else "warning",
    )


def not_finite_at_start(
    model: GreyBoxModel,
    source: Source,
    values: Mapping[str, float] | None = None,
    begun: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None,
) -> Iterator[Finding]:
    """A finding where the equations give no number where a simulation begins, once.

    Args:
        values: of parameters, where a card has others than the model declares.
        begun: by experiment the states (n_x,) and inputs (n_u,) that its recording begins with.
    """
    starts = {
        name: start_of(model, values or {}, start) for name, start in ({"": None} if begun is None else begun).items()
    }
    found = ((name, start, *_origin(model, start, source.file)) for name, start in starts.items())
    name, start, _, line = next((one for one in found if one[2]), ("", None, False, None))
    if start is None:
        return
    zero, text = _zero(model, start), _text(source, line)
    standing = [name for name in zero if re.search(rf"\b{re.escape(name)}\b", text)]
    divisors = [name for name in standing if re.search(rf"/\s*\(?\s*\w+\.{re.escape(name)}\b", text)]
    if not standing:  # the line divides by what other lines made of them
        standing = [name for name, other in zero.items() if not _origin(model, other, source.file)[0]]
    of = f' of "{name}"' if name else " (states at their start values, measured ones and inputs at zero)"
    told = _finding(
        f"the equations give no number at the start{of}"
        + (f", where {' and '.join(f'{name} = 0' for name in divisors or standing)}" if standing else ""),
        source,
        line,
    )
    zeros = [name for name in divisors if name in {p.name for p in model.declared_parameters}]
    if zeros:  # no simulation gets anywhere; without recordings a card may still give other values
        write = f"a value other than 0 for {' and '.join(zeros)}, on the card or in the model"
        told = replace(told, level="warning" if begun is None else "error", write=write)
    yield told


def _zero(model: GreyBoxModel, start: Points) -> dict[str, Points]:
    """What is zero at a point, by name, with the point at which it is one in the place of zero."""
    declared = {"x": model.states, "u": model.inputs, "p": model.declared_parameters}
    places = [(kind, row, s.name) for kind, of in declared.items() for row, s in enumerate(of)]
    found = {}
    for kind, row, name in places:
        values = getattr(start, kind).detach().clone()
        if values[row, 0] == 0:
            values[row] = 1.0
            found[name] = replace(start, **{kind: values})
    return found


def _finding(found: str, source: Source, line: int | None) -> Finding:
    first = next((m.tree.lineno for m in source.methods), source.line)
    return Finding("warning", "numbers", found, _WRITE, source.file, line or first)


def _origin(model: GreyBoxModel, point: Points, file: Path | None) -> tuple[bool, int | None]:
    """Whether a rate or an output is no number at a point, and the line that the first such number on its way is from."""
    x, u, p, f = point.signals(model)
    with torch.no_grad(), _Watch(str(file)) as watch:
        given = [*model.derivative(x, u, p, f).values(), *model.outputs_with(x, u, p, f).values()]
    lost = [torch.as_tensor(value) for value in given if not torch.isfinite(torch.as_tensor(value)).all()]
    return bool(lost), next((line for value in lost if (line := watch.line_of(value))), None)


class _Watch(TorchDispatchMode):
    """Remembers of every tensor that is no number in which line of a file the first such number was made."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self._file = file
        self._lines: dict[int, int | None] = {}
        self._kept: list[torch.Tensor] = []  # so that no other tensor gets the identity of one that is gone

    def line_of(self, value: torch.Tensor) -> int | None:
        return self._lines.get(id(value))

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        made = func(*args, **(kwargs or {}))
        before = [a for a in tree_leaves((args, kwargs or {})) if isinstance(a, torch.Tensor) and id(a) in self._lines]
        for value in tree_leaves(made):
            if isinstance(value, torch.Tensor) and value.is_floating_point() and not torch.isfinite(value).all():
                self._kept.append(value)
                self._lines[id(value)] = self._lines[id(before[0])] if before else self._line()
        return made

    def _line(self) -> int | None:
        frame = sys._getframe(2)
        while frame is not None and frame.f_code.co_filename != self._file:
            frame = frame.f_back
        return None if frame is None else frame.f_lineno


def _text(source: Source, line: int | None) -> str:
    """A line of the file."""
    if source.file is None or line is None:
        return ""
    lines = source.file.read_text(encoding="utf-8").splitlines()
    return lines[line - 1] if line <= len(lines) else ""
