"""The compiled stepper: packs windows into vector lanes and calls the machine code made for the model."""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from greybox_torch.codegen.build import library
from greybox_torch.codegen.emit import emit
from greybox_torch.codegen.lower import Equations
from greybox_torch.simulation.packed_normals import Layout, PackedNormals
from greybox_torch.simulation.parts_of_gaps import parts_of_gaps
from greybox_torch.simulation.passes import Pass, Probes, Run
from greybox_torch.simulation.records import Records, once
from greybox_torch.simulation.side_by_side import threads

_LONG, _POINTER = ctypes.c_long, ctypes.c_void_p


WORTH_A_THREAD = 2000
"""Steps times directions of a group of lanes, about 0.1 ms."""

_TILE = 4
"""Side of the squares in which the emitted program accumulates normal matrices."""


class _Job(ctypes.Structure):
    """Mirrors ``struct Job`` of the emitted program."""

    _fields_ = [
        *[(n, _LONG) for n in ("groups", "steps", "substeps", "foh", "samples", "directions", "threads")],
        *[(n, _LONG) for n in ("first", "close", "band", "every", "restarts")],
        *[
            (n, _POINTER)
            for n in (
                "u",
                "dt",
                "parts",
                "start",
                "last",
                "column",
                "p",
                "x",
                "dx",
                "y",
                "dy",
                "trace",
                "kept",
                "restart",
                "measured",
                "weight",
                "normal",
            )
        ],
    ]


def native_stepper(equations: Equations, sensitive: tuple[str, ...], precision: str) -> NativeStepper | None:
    """A compiled stepper, None where no compiler works."""
    loaded = library(emit(equations, precision))
    return None if loaded is None else NativeStepper(equations, sensitive, precision, loaded)


@dataclass(frozen=True)
class NativeStepper:
    """See :class:`greybox_torch.simulation.stepper.Stepper`."""

    equations: Equations
    sensitive: tuple[str, ...]
    precision: str
    loaded: ctypes.CDLL

    @property
    def compiled(self) -> bool:
        return True

    @property
    def lanes(self) -> int:
        """Windows side by side in a vector of the machine."""
        return _LONG.in_dll(self.loaded, "lanes").value

    def run(self, records: Records, asked: Pass, substeps: int = 1) -> Run:
        windows, weights = asked.windows, asked.weights
        real = np.float64 if self.precision == "double" else np.float32
        lanes = self.lanes
        count, n_x, n_y = len(windows.start), self.equations.n_states, self.equations.n_outputs
        groups = -(-count // lanes)
        n_p = len(self.sensitive) if asked.tangents else 0
        n_s = 0 if asked.start_directions is None else asked.start_directions.shape[1]
        n_d = n_p + n_s
        n_t = self.equations.n_tangent

        rows = np.broadcast_to(asked.parameters, (count, self.equations.n_parameters))
        dx0 = np.zeros((count, n_d, n_t))
        if n_p and asked.tangents0 is not None:
            dx0[:, :n_p] = asked.tangents0[..., :n_t]
        if asked.start_directions is not None:
            dx0[:, n_p:] = asked.start_directions[..., :n_t]
        layout = _layout(asked.probes, n_p, n_d)
        signals = _signals(records, real)
        packed = {
            "u": signals["u"],
            "dt": signals["dt"],
            "parts": parts_of_gaps(records),
            "start": _lanes(windows.start, lanes, np.int64),
            "last": _lanes(windows.last, lanes, np.int64),
            "column": np.array([*range(n_p), *([len(self.sensitive)] * n_s)], dtype=np.int64),
            "p": _lanes(rows if rows.shape[1] else np.zeros((count, 1)), lanes, real),
            "x": _lanes(asked.starts, lanes, real),
            "dx": _lanes(dx0, lanes, real),
            "y": _empty((groups, windows.steps, n_y, lanes), real),
            "dy": _empty((groups, windows.steps, n_y, n_d, lanes), real) if n_d and weights is None else None,
            "trace": _empty((groups, windows.steps, n_x, lanes), real) if asked.keep_states else None,
            "kept": None if asked.restarts is None else asked.restarts.kept.astype(np.int64),
            "restart": None if asked.restarts is None else _lanes(asked.restarts.starts, lanes, real),
            "measured": None if weights is None else signals["y"],
            "weight": None if weights is None else _aligned(weights, real),
            "normal": None if weights is None else _zeros((groups, layout.size, lanes), real),
        }
        worth = _threads(groups, windows.steps * substeps * (1 + n_d))
        sizes = (groups, windows.steps, substeps, int(records.hold == "foh"), len(records.dt), n_d, worth)
        sparse = (layout.first, layout.close, layout.band)
        restarts = (1, 0) if asked.restarts is None else (asked.restarts.every, asked.restarts.starts.shape[1])
        pointers = [None if a is None else _address(a) for a in packed.values()]
        self.loaded.run(ctypes.byref(_Job(*sizes, *sparse, *restarts, *pointers)))
        dy, normal = packed["dy"], packed["normal"]
        return Run(
            y=_windows(packed["y"], count),
            dy=None if dy is None else _windows(dy, count),
            x_end=_windows(packed["x"], count),
            dx_end=_windows(packed["dx"], count) if n_d else None,
            states=_windows(packed["trace"], count) if asked.keep_states else None,
            begun=None if packed["restart"] is None else _windows(packed["restart"], count),
            normal=None
            if normal is None or asked.probes is not None
            else _mirrored(_windows(normal.reshape(groups, layout.width, -1, lanes), count)[:, : n_d + 1, : n_d + 1]),
            packed=None if normal is None or asked.probes is None else PackedNormals.of(normal, count, n_d + 1, layout),
        )


def _layout(probes: Probes | None, n_p: int, n_d: int) -> Layout:
    """How normal matrices of ``n_d`` directions stand, ``n_p`` of parameters, the probes the last of them: in whole squares."""
    width = (n_d + _TILE) // _TILE * _TILE
    if probes is None:
        return Layout(width)
    first, close, band = -(-(n_p - probes.count) // _TILE), n_p // _TILE, (probes.band + _TILE) // _TILE
    return Layout(width, first * _TILE, close * _TILE, band * _TILE, _TILE)


def _threads(groups: int, work: int) -> int:
    """How many threads a pass over ``groups`` of so much work each is worth: waking them costs as much as a short one."""
    return max(1, min(groups, threads(), groups * work // WORTH_A_THREAD))


def _signals(records: Records, real: type) -> dict[str, np.ndarray]:
    """The records' signals as the machine code reads them: copied once, as records is simulated many times."""

    def copied() -> dict[str, np.ndarray]:
        u = records.u if len(records.u) else np.zeros((1, len(records.dt)))
        return {"u": _aligned(u, real), "dt": _aligned(records.dt, real), "y": _aligned(records.y, real)}

    return once(records, ("signals", real), copied)


def _address(array: np.ndarray) -> int:
    """Where its data begin; ``array.ctypes`` makes three objects to tell it."""
    return array.__array_interface__["data"][0]


def _empty(shape: tuple[int, ...], real: type) -> np.ndarray:
    """An uninitialised array whose data begin on a cache line, as vector loads need."""
    size = math.prod(shape) * np.dtype(real).itemsize
    raw = np.empty(size + 64, dtype=np.uint8)
    offset = -_address(raw) % 64
    return raw[offset : offset + size].view(real).reshape(shape)


def _zeros(shape: tuple[int, ...], real: type) -> np.ndarray:
    result = _empty(shape, real)
    result.fill(0)
    return result


def _mirrored(lower: np.ndarray) -> np.ndarray:
    """Symmetric matrices (W, d, d) from their lower triangles."""
    result = np.ascontiguousarray(lower)
    rows, columns = _above_diagonal(result.shape[1])
    result[:, rows, columns] = result[:, columns, rows]
    return result


@lru_cache(maxsize=64)
def _above_diagonal(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of the elements above the diagonal of a matrix (size, size)."""
    return np.triu_indices(size, 1)


def _aligned(values: np.ndarray, real: type) -> np.ndarray:
    result = _empty(values.shape, real)
    result[...] = values
    return result


def _lanes(values: np.ndarray, lanes: int, real: type) -> np.ndarray:
    """(W, ...) -> (groups, ..., lanes); the last group is filled up with copies of the last window."""
    values = np.asarray(values)
    if len(values) % lanes:
        values = values[_filled_up(len(values), lanes)]
    shaped = values.reshape(len(values) // lanes, lanes, *values.shape[1:])
    return _aligned(shaped.transpose(0, *range(2, shaped.ndim), 1), real)


@lru_cache(maxsize=64)
def _filled_up(count: int, lanes: int) -> np.ndarray:
    """Indices of ``count`` windows, the last one repeated until the lanes of all groups are taken."""
    return np.minimum(np.arange(-(-count // lanes) * lanes), count - 1)


def _windows(packed: np.ndarray, count: int) -> np.ndarray:
    """(groups, ..., lanes) -> (W, ...), a view where there is one group."""
    moved = packed.transpose(0, -1, *range(1, packed.ndim - 1))
    return (
        moved.reshape(len(packed) * moved.shape[1], *moved.shape[2:])[:count] if len(packed) > 1 else moved[0, :count]
    )
