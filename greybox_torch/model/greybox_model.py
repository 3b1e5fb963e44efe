"""The base class of every grey-box model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import torch

from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.keywords import names_checked
from greybox_torch.model.constraints import parameter_scale, project
from greybox_torch.model.declarations import Input, Output, Parameter, State
from greybox_torch.model.force_outputs import output_asks_for_forces
from greybox_torch.model.misdeclared import check_declarations
from greybox_torch.model.ports import Port, actuators, sensors
from greybox_torch.model.shown_rates import shown_rates, with_shown_rates
from greybox_torch.model.signals import Signals
from greybox_torch.model.singular import nan_where_singular
from greybox_torch.model.stacked import spread, stacked
from greybox_torch.model.summary import summary
from greybox_torch.model.unseen_states import unseen_states

NO_LIST = "'parameters' of a model is torch's method, not its list; expected [*Other.declared_parameters] for those of another model"


class GreyBoxModel(torch.nn.Module):
    """A physical model dx/dt = f(x, u, p), y = g(x, u, p) with named, constrained, learnable parameters.

    A subclass declares ``states``, ``inputs``, ``outputs``, ``parameters`` and ``ports`` as class attributes and defines
    :meth:`derivative` and :meth:`output` in torch operations that treat every sample alike: elementwise ones, and small matrices in the
    last dimensions (``torch.stack([a, b], -1)``, ``@``, ``torch.linalg.solve``). The declared list of parameters is kept as
    ``declared_parameters``; ``parameters()`` stays what it is on every :class:`torch.nn.Module`.

    Raises:
        UserError: a declaration is missing, empty, or names something twice.
    """

    states: Sequence[State] = ()
    inputs: Sequence[Input] = ()
    outputs: Sequence[Output] = ()
    ports: Sequence[Port] = ()
    declared_parameters: Sequence[Parameter] = ()
    parameters: Any  # a subclass assigns its list; read `declared_parameters`, since torch's method keeps the name
    name: ClassVar[str] = ""
    starts_free: bool = False
    """Whether every start state is estimated, also those that the states declare as fixed; a card that speaks of one still wins."""
    asks_for_forces: ClassVar[bool] = False
    """Whether the outputs are handed the forces at the ports: defined as ``output(self, x, u, p, port)``."""
    least_substeps: int = 1
    """Runge-Kutta steps per sample that a simulation makes at the least."""
    loaded_as: str = ""
    """The name that :func:`greybox_torch.load_model` found the model by; empty where it was made in Python."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for name in {"derivative", "output"} & cls.__dict__.keys():
            setattr(cls, name, nan_where_singular(cls.__dict__[name]))
        cls.asks_for_forces = output_asks_for_forces(cls)
        declared = cls.__dict__.get("parameters")
        if isinstance(declared, list | tuple):
            cls.declared_parameters = tuple(declared)
            del cls.parameters
        elif declared is torch.nn.Module.parameters:
            raise UserError(f"model {cls.__name__}: {NO_LIST}")

    def __init__(self, *given: Any, **values: Any) -> None:
        if given or values:
            raise UserError(
                f"{type(self).__name__}() takes no values; expected them in set_values({{name: value}}) of the model made"
            )
        super().__init__()
        check_declarations(self, self.title)
        self._scales = {p.name: parameter_scale(p.value, *p.bounds) for p in self.declared_parameters}
        self._set_by_name: frozenset[str] = frozenset()
        self.raw = torch.nn.ParameterDict()
        for parameter in self.declared_parameters:
            start = torch.tensor(parameter.value / self._scales[parameter.name], dtype=torch.float64)
            self.raw[_key(parameter.name)] = torch.nn.Parameter(start, requires_grad=not parameter.fixed)

    def __repr__(self) -> str:
        return summary(self.title, self.effects_told(), self.declared_parameters, self.values())

    def effects_told(self) -> tuple[str, ...]:
        """The attached effects, each with its port."""
        return ()

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        """Rates of all states by name, in state unit per second."""
        raise NotImplementedError(f"{type(self).__name__} does not define derivative(x, u, p, port)")

    def output(self, x: Any, u: Any, p: Any, *port: Any) -> dict[str, Any]:
        """Outputs by name.

        Defined as ``output(self, x, u, p, port)`` it is handed the forces at the ports as well: a force that is measured under a prescribed
        motion shows what acts at a port without any state in between.
        """
        raise NotImplementedError(f"{type(self).__name__} does not define output(x, u, p)")

    def outputs_with(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        """Outputs by name, with forces at the ports where :meth:`output` asks for them or shows accelerations."""
        if self.asks_for_forces:
            return self.output(x, u, p, port)
        return with_shown_rates(self, self.output(x, u, p), x, u, p, port)

    @property
    def shows_forces(self) -> bool:
        """Whether forces at the ports reach an output with no state in between."""
        return self.asks_for_forces or bool(shown_rates(self))

    def admissible(self, p: Any) -> dict[str, Any]:
        """Quantities that must stay positive, by a name for messages (for constraints that join several parameters)."""
        return {}

    def prepared(self, records: Any, values: Any) -> Any:
        """The records that drives the model at parameter ``values`` (n_p,): the recorded one, unless an effect shifts signals in time."""
        return records

    def settled(self, records: Any, values: Any) -> Any:
        """The records without what outputs show that was before their beginning: that tells nothing of a window that begins there."""
        return records

    def remembered_states(self) -> tuple[str, ...]:
        """States that hold what went on before: carried from window to window, and estimated where a record begins."""
        return ()

    def start_trials(self, values: Any) -> list[dict[str, float]]:
        """Start states to be tried one by one, where the data determine them only up to several possibilities."""
        return []

    def begun(self, states: Any, records: Any, samples: Any, values: Any) -> Any:
        """Start states (W, n_x) at ``samples`` (W,) of records, with those that follow from the others filled in."""
        return states

    def taken_over(self, states: Any, known: GreyBoxModel, records: Any, samples: Any, values: Any) -> Any:
        """Start states (W, n_x) at ``samples`` (W,) of records, found with the model ``known``, as they are in this one."""
        return states

    def carried_states(self) -> tuple[str, ...]:
        """States that a window of a record does not begin with freely but takes over from the window before: those that nothing shows."""
        return unseen_states(self)

    @property
    def title(self) -> str:
        """The model's name for reports."""
        return self.name or type(self).__name__

    @property
    def all_ports(self) -> tuple[Port, ...]:
        """Declared ports, then the actuators of the inputs and the sensors of the outputs."""
        return (
            *self.ports,
            *actuators(tuple(i.name for i in self.inputs)),
            *sensors(tuple(o.name for o in self.outputs)),
        )

    @property
    def plain(self) -> GreyBoxModel:
        """The model without effects attached: itself, where there are none."""
        return self

    def values(self) -> dict[str, float]:
        """The present parameter values in physical units."""
        with torch.no_grad():
            return {name: float(value) for name, value in self.physical().items()}

    def held_values(self) -> dict[str, float]:
        """The values that are the model's own doing: set by :meth:`set_values`, or moved by an optimiser or a state dictionary.

        They stand before the start values of a data card; declared values that nothing has changed stand behind them.
        """
        present = self.values()
        return {p.name: present[p.name] for p in self.declared_parameters if self._is_held(p)}

    def _is_held(self, parameter: Parameter) -> bool:
        raw = self.raw[_key(parameter.name)].detach()
        declared = torch.tensor(parameter.value / self._scales[parameter.name], dtype=raw.dtype)
        return parameter.name in self._set_by_name or bool(raw.cpu() != declared)

    @names_checked
    def set_values(self, values: Mapping[str, float]) -> None:
        """Set parameter values in physical units. They then stand before those of a data card.

        Raises:
            UserError: an unknown name, a value that is no number, or one outside its bounds.
        """
        declared = {p.name: p for p in self.declared_parameters}
        for name, value in values.items():
            if name not in declared:
                hint = did_you_mean(name, declared)
                raise UserError(f"model {self.title} has no parameter '{name}'{hint} (it has: {', '.join(declared)})")
            if not hasattr(value, "__float__"):
                raise UserError(f"parameter '{name}' of model {self.title}: found {value!r}, expected a number")
            low, high = declared[name].bounds
            if not low <= value <= high:
                where = f"lies outside its bounds [{low:g}, {high:g}]"
                raise UserError(f"parameter '{name}' of model {self.title}: {value:g} {where}")
            with torch.no_grad():
                self.raw[_key(name)].fill_(value / self._scales[name])
        self._set_by_name |= frozenset(values)

    def physical(self) -> Signals:
        """The parameters as differentiable tensors in physical units, held within their bounds."""
        values = {}
        for parameter in self.declared_parameters:
            low, high = parameter.bounds
            scale = self._scales[parameter.name]
            values[parameter.name] = project(self.raw[_key(parameter.name)] * scale, low, high)  # exact at the bounds
        return Signals("parameter", values)

    def rates(self, x: torch.Tensor, u: torch.Tensor, p: Any) -> torch.Tensor:
        """The right-hand side on stacked tensors: x (n_x, *batch), u (n_u, *batch) -> (n_x, *batch)."""
        xs, us = self.named_signals(x, u)
        rates = self.derivative(xs, us, spread(p, x), self._no_forces(x))
        return stacked(rates, [s.name for s in self.states], x, f"{self.title}.derivative()")

    def measured(self, x: torch.Tensor, u: torch.Tensor, p: Any) -> torch.Tensor:
        """The outputs on stacked tensors: x (n_x, *batch), u (n_u, *batch) -> (n_y, *batch)."""
        xs, us = self.named_signals(x, u)
        values = spread(p, x)
        outputs = self.output(xs, us, values, *([self._no_forces(x)] if self.asks_for_forces else []))
        return stacked(outputs, [o.name for o in self.outputs], x, f"{self.title}.output()")

    def _no_forces(self, x: torch.Tensor) -> Signals:
        none = x.new_zeros(()).expand(x.shape[1:])
        return Signals("port", {port.name: none for port in self.all_ports})

    def named_signals(self, x: torch.Tensor, u: torch.Tensor) -> tuple[Signals, Signals]:
        """States and inputs by name, from stacked tensors: x (n_x or more, *batch), u (n_u or more, *batch)."""
        # select: an index in brackets makes torch import its distributed tensors when x is traced, half a second
        xs = Signals("state", {s.name: x.select(0, i) for i, s in enumerate(self.states)})
        us = Signals("input", {s.name: u.select(0, i) for i, s in enumerate(self.inputs)})
        return xs, us


def _key(name: str) -> str:
    """A parameter's name as a key of torch.nn.ParameterDict, which reserves the dot and the names of its own methods."""
    key = name.replace(".", "/")
    return f"{key}/" if hasattr(torch.nn.ParameterDict, key) else key
