"""A pass over windows: what it is asked for, and what it gives.

A window is a stretch of records with its own start state and parameters; windows, experiments and hypotheses are all just lanes of one
batch.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np

from greybox_torch.simulation.packed_normals import PackedNormals
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class Probes:
    """The last ``count`` sensitive parameters look at effects one by one: products more than ``band`` columns apart are not wanted."""

    count: int
    band: int


@dataclass(frozen=True)
class Restarts:
    """In every window the states are set anew at the samples that are multiples of ``every``, but for those ``kept`` (n_x,), which go on.

    ``starts`` (W, K, n_x): what they are set to, the window's own start first. Where a window ends earlier the rest is not used. A kept
    state that is not a number goes on from zero.
    """

    every: int
    kept: np.ndarray
    starts: np.ndarray


@dataclass(frozen=True)
class Pass:
    """What is asked of one pass over W windows.

    Args:
        windows: the stretches of the records to simulate.
        parameters: in physical units and declared order, (n_p,) or one row per window (W, n_p).
        starts: start states (W, n_x).
        tangents: also propagate the derivatives by the sensitive parameters.
        start_directions: further tangents (W, n_s, n_x), directions in which the start states vary.
        tangents0: start values (W, n_sensitive, n_x) of the parameter tangents, zero by default (a record continued in chunks).
        weights: (n_y,) factors on the errors against the records' outputs; asks for ``normal`` instead of ``dy``.
        keep_states: also return the states at the samples.
        probes: asks for ``packed`` instead of ``normal``, without what is not wanted of it.
        restarts: where the states are set anew; asks for ``begun``. Without tangents.
    """

    windows: Windows
    parameters: np.ndarray
    starts: np.ndarray
    _: KW_ONLY
    tangents: bool = False
    start_directions: np.ndarray | None = None
    tangents0: np.ndarray | None = None
    weights: np.ndarray | None = None
    keep_states: bool = False
    probes: Probes | None = None
    restarts: Restarts | None = None


@dataclass(frozen=True)
class Run:
    """Result of a pass over W windows of at most K steps.

    ``y`` (W, K, n_y); ``dy`` (W, K, n_y, n_d) with the directions in the order sensitive parameters, then start-state directions;
    ``x_end`` (W, n_x) and ``dx_end`` (W, n_d, n_x) after the last step; ``states`` (W, K, n_x) if they were asked for.
    ``normal`` (W, n_d + 1, n_d + 1), if errors against a measurement were asked for: the matrix [J e]ᵀ[J e] of the directions' output
    sensitivities J and the weighted errors e = measured − simulated; then ``dy`` is None. Samples beyond a window's end are
    meaningless, and carry no weight in ``normal``. ``packed`` holds the same matrices where probes were named. ``begun`` (W, K, n_x): the
    states with which the window goes on at every restart.
    """

    y: np.ndarray
    dy: np.ndarray | None
    x_end: np.ndarray
    dx_end: np.ndarray | None
    states: np.ndarray | None
    normal: np.ndarray | None = None
    packed: PackedNormals | None = None
    begun: np.ndarray | None = None
