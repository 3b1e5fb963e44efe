"""Tensors by name: what a model's ``derivative`` and ``output`` are handed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import torch

from greybox_torch.errors import UserError, did_you_mean


class Signals(Mapping[str, Any]):
    """A read-only namespace of tensors, by attribute or by item; an unknown name is an error that lists the known ones."""

    _kind: str
    _values: dict[str, Any]

    def __init__(self, kind: str, values: Mapping[str, Any]) -> None:
        # As attributes of the object, which equations read ten times as fast as through __getattr__; names of methods by item alone.
        own = values if _OWN.isdisjoint(values) else {n: v for n, v in values.items() if n not in _OWN}
        vars(self).update(own, _kind=kind, _values=dict(values))

    def __getitem__(self, name: str) -> Any:
        try:
            return self._values[name]
        except KeyError:
            raise self._unknown(name) from None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"the {self._kind} '{name}' is set; expected equations that read their arguments only")

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def replaced(self, **values: Any) -> Signals:
        """The same namespace with some values replaced."""
        return Signals(self._kind, {**self._values, **values})

    def _unknown(self, name: str) -> UserError:
        known = ", ".join(self._values) or "none"
        return UserError(
            f"the equations ask for the {self._kind} '{name}'{did_you_mean(name, self._values)}, which is not declared (declared: {known})"
        )


_OWN = frozenset((*dir(Signals), "_kind", "_values"))


def parameter_signals(values: Mapping[str, Any]) -> Signals:
    """Parameter values by name, as a model's equations read them: tensors in double precision."""
    return Signals("parameter", {name: torch.as_tensor(value, dtype=torch.float64) for name, value in values.items()})
