"""How a model is simulated, as one value: its stepper, and the options that further steppers are made with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.codegen.lower import lower
from greybox_torch.deadline import check_time
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.native import native_stepper
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.substeps import choose_substeps


@dataclass(frozen=True)
class SimulationOptions:
    """How models are simulated: ``device`` as torch names it, ``precision`` "double" or "single", Runge-Kutta steps per sample."""

    device: str = "cpu"
    precision: str = "double"
    substeps: int = 1


DEFAULT = SimulationOptions()


@dataclass(frozen=True)
class Simulator:
    """Simulates one model, with tangents for the parameters that its stepper was made for."""

    stepper: Stepper
    options: SimulationOptions = DEFAULT
    least_substeps: int = 1
    """What the model asks for, whatever the options say."""

    @staticmethod
    def of(
        model: GreyBoxModel,
        sensitive: Sequence[str] = (),
        options: SimulationOptions = DEFAULT,
        *,
        at_zero: Sequence[str] = (),
    ) -> Simulator:
        """The simulator of a model.

        Args:
            sensitive: names of the parameters that tangents are wanted for, in the order of the directions.
            at_zero: parameters (amplitudes of hypothetical effects) that are zero throughout; only their tangents are computed.

        Raises:
            UserError: the model's equations branch on a signal or do not return what the model declares.
        """
        stepper = make_stepper(model, sensitive, at_zero=at_zero, options=options)
        return Simulator(stepper, options, model.least_substeps)

    def for_model(
        self, model: GreyBoxModel, sensitive: Sequence[str] = (), *, at_zero: Sequence[str] = ()
    ) -> Simulator:
        """The simulator of another model, or of other sensitive parameters, with the same options; see :meth:`of`."""
        return Simulator.of(model, sensitive, self.options, at_zero=at_zero)

    def with_substeps(self, substeps: int) -> Simulator:
        """The same stepper with so many Runge-Kutta steps per sample, or as many as its model asks for at the least."""
        return replace(self, options=replace(self.options, substeps=substeps))

    def fine_enough(self, records: Records, p: np.ndarray, starts: np.ndarray) -> Simulator:
        """The same stepper with as many sub-steps as accuracy asks for, see :func:`choose_substeps`; one where none give finite numbers.

        Args:
            p: parameters (n_p,).
            starts: of the experiments, (E, n_x).
        """
        return self.with_substeps(choose_substeps(records, self.stepper, p, starts) or 1)

    @property
    def sensitive(self) -> tuple[str, ...]:
        """The parameters that tangents are propagated for, in the order of the directions."""
        return self.stepper.sensitive

    @property
    def compiled(self) -> bool:
        """Whether a pass takes milliseconds rather than seconds."""
        return self.stepper.compiled

    @property
    def substeps(self) -> int:
        """Runge-Kutta steps per sample."""
        return max(self.options.substeps, self.least_substeps)

    def run(self, records: Records, asked: Pass) -> Run:
        """Advance all windows of a pass.

        Raises:
            TimeIsUp: what asks for it has no time left, see :func:`greybox_torch.deadline.until`.
        """
        check_time()
        return self.stepper.run(records, asked, self.substeps)


def make_stepper(
    model: GreyBoxModel,
    sensitive: Sequence[str],
    *,
    at_zero: Sequence[str] = (),
    options: SimulationOptions = DEFAULT,
) -> Stepper:
    """The fastest stepper for a model: compiled for the CPU, else torch operations on any device; see :meth:`Simulator.of`."""
    check_time()
    eager = EagerStepper.of(model, sensitive, options.device, options.precision)
    if options.device != "cpu":
        return eager
    try:
        equations = lower(model, sensitive, at_zero)
    except UnsupportedOperation:
        return eager
    return native_stepper(equations, tuple(sensitive), options.precision) or eager
