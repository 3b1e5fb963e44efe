"""A mechanism at a port."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import chain, count
from typing import TypeVar

from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.model import Body, GreyBoxModel
from greybox_torch.model.ports import driving_body

Value = TypeVar("Value")


@dataclass(frozen=True)
class Attachment:
    """A mechanism at a port. ``label`` tells several of the same kind apart; ``position`` names the body whose position it uses."""

    port: str
    mechanism: Mechanism
    label: str = ""
    position: str = ""
    shifted_state: str = ""
    """For a kinematic mechanism: the state that carries the change of deflection, see :mod:`greybox_torch.mechanisms.shift`."""

    substeps: int = 1
    """Runge-Kutta steps per sample that its law needs at the least: dry friction that holds a light body is stiff."""

    @property
    def prefix(self) -> str:
        """What the names of its parameters and states begin with."""
        return f"{self.port}.{self.mechanism.name}{self.label}"

    def own(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """What ``values`` of a model, by name, say of its parameters, by the names that its law has for them."""
        begin = f"{self.prefix}."
        return {name.removeprefix(begin): value for name, value in values.items() if name.startswith(begin)}

    @property
    def named(self) -> tuple[str, str]:
        """The port, and the mechanism there: how a finding is called."""
        return self.port, self.mechanism.name


def attach(model: GreyBoxModel, port: str, mechanism: Mechanism, shifted: str = "", label: str = "") -> Attachment:
    """The attachment of ``mechanism`` at ``port``, with the body that its position belongs to.

    Labelled where the model has an effect of this kind there already, as one that was diagnosed before may have.
    """
    site = next(q for q in model.all_ports if q.name == port)
    position = ""
    if "position" in mechanism.signals() or "position" in mechanism.needs:
        body = site if isinstance(site, Body) else driving_body(model.ports)
        position = body.name if body is not None else ""
    made = Attachment(port, mechanism, position=position, shifted_state=shifted)
    there = {p.name.rpartition(".")[0] for p in model.declared_parameters}
    labels = chain([label], (f"{label}_{k}" for k in count(2)))
    return next(a for one in labels if (a := replace(made, label=one)).prefix not in there)
