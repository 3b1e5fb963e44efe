"""The fixed-step stepper: windows side by side in one batch, with forward sensitivities.

Runge-Kutta of order four, with the input held between samples as the data set says and as many sub-steps as asked for. A window is a
stretch of records with its own start state and parameters; windows, experiments and hypotheses are all just lanes of the batch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from greybox_torch.codegen.lower import lower
from greybox_torch.codegen.operations import UnsupportedOperation
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.packed_normals import PackedNormals
from greybox_torch.simulation.records import Records


@dataclass(frozen=True)
class Windows:
    """Which stretch of the records each of W windows covers: first sample (W,), last sample it may read (W,), steps of the longest."""

    start: np.ndarray
    last: np.ndarray
    steps: int


@dataclass(frozen=True)
class Run:
    """Result of a pass over W windows of at most K steps.

    ``y`` (W, K, n_y); ``dy`` (W, K, n_y, n_d) with the directions in the order sensitive parameters, then start-state directions;
    ``x_end`` (W, n_x) and ``dx_end`` (W, n_d, n_x) after the last step; ``states`` (W, K, n_x) if they were asked for.
    ``normal`` (W, n_d + 1, n_d + 1), if errors against a measurement were asked for: the matrix [J e]ᵀ[J e] of the directions' output
    sensitivities J and the weighted errors e = measured − simulated; then ``dy`` is None. Samples beyond a window's end are
    meaningless, and carry no weight in ``normal``. ``packed`` holds the same matrices where probes were named.
    """

    y: np.ndarray
    dy: np.ndarray | None
    x_end: np.ndarray
    dx_end: np.ndarray | None
    states: np.ndarray | None
    normal: np.ndarray | None = None
    packed: PackedNormals | None = None


@dataclass(frozen=True)
class Probes:
    """The last ``count`` sensitive parameters look at effects one by one: products more than ``band`` columns apart are not wanted."""

    count: int
    band: int


class Stepper(Protocol):
    """What advances windows: compiled code where there is a compiler, torch operations everywhere."""

    @property
    def sensitive(self) -> tuple[str, ...]:
        """The parameters that tangents are propagated for, in the order of the directions."""
        ...

    @property
    def compiled(self) -> bool:
        """Whether a pass takes milliseconds rather than seconds."""
        ...

    def run(
        self,
        records: Records,
        windows: Windows,
        p: np.ndarray,
        x0: np.ndarray,
        *,
        tangents: bool = False,
        start_directions: np.ndarray | None = None,
        tangents0: np.ndarray | None = None,
        substeps: int = 1,
        keep_states: bool = False,
        weights: np.ndarray | None = None,
        probes: Probes | None = None,
    ) -> Run:
        """Advance all windows.

        Args:
            p: parameters (n_p,) or one row per window (W, n_p).
            x0: start states (W, n_x).
            tangents: also propagate the derivative of the output with respect to the sensitive parameters.
            start_directions: further tangents (W, n_s, n_x), directions in which the start state varies.
            tangents0: start values (W, n_sensitive, n_x) of the parameter tangents, zero by default (a record continued in chunks).
            substeps: Runge-Kutta steps per sample.
            keep_states: also return the states at the samples.
            weights: (n_y,) factors on the errors against the records' outputs; asks for ``normal`` instead of ``dy``.
            probes: asks for ``packed`` instead of ``normal``, without what is not wanted of it.
        """
        ...


def make_stepper(
    model: GreyBoxModel,
    sensitive: Sequence[str],
    *,
    at_zero: Sequence[str] = (),
    device: str = "cpu",
    precision: str = "double",
) -> Stepper:
    """The fastest stepper for a model: compiled for the CPU, else torch operations on any device.

    Args:
        sensitive: names of the parameters that tangents are wanted for, in the order of the directions.
        at_zero: parameters (amplitudes of hypothetical effects) that are zero throughout; only their tangents are computed.

    Raises:
        UserError: the model's equations branch on a signal or do not return what the model declares.
    """
    from greybox_torch.simulation.eager import EagerStepper
    from greybox_torch.simulation.native import native_stepper

    eager = EagerStepper.of(model, sensitive, device, precision)
    if device != "cpu":
        return eager
    try:
        equations = lower(model, sensitive, at_zero)
    except UnsupportedOperation:
        return eager
    return native_stepper(equations, tuple(sensitive), precision) or eager


def whole_records(records: Records) -> Windows:
    """One window per experiment: the free run."""
    return Windows(records.first, records.last, int(records.lengths.max()))


def cut(records: Records, length: int) -> Windows:
    """All experiments cut into windows of ``length`` samples, each beginning at a multiple of it.

    A remainder shorter than half a window is joined to the window before it: the longest, which ``steps`` counts, may be longer.
    """
    starts: list[int] = []
    lasts: list[int] = []
    for first, last in zip(records.first, records.last, strict=True):
        total = int(last - first + 1)
        count = max(1, int(total / length + 0.5))
        begins = [int(first) + k * length for k in range(count)]
        starts += begins
        lasts += [b - 1 for b in begins[1:]] + [int(last)]
    sizes = np.array(lasts) - np.array(starts) + 1
    return Windows(np.array(starts), np.array(lasts), int(sizes.max()))


__all__ = ["Probes", "Run", "Stepper", "Windows", "cut", "make_stepper", "whole_records"]
