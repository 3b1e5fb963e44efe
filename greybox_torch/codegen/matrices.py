"""Small matrices of expression nodes: products, sums, determinants, and systems of equations solved.

A system is solved by Cramer's rule, with determinants expanded by minors that are shared between them. Nothing depends on which pivot is
largest, so that the derivative is exact and one formula holds for all samples; mass matrices are small and well conditioned.
Leading dimensions are a batch, as in torch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from greybox_torch.codegen.arrays import NodeArray, UnsupportedOperation, elementwise, mapped, operand
from greybox_torch.codegen.expression import Graph

LARGEST = 6
"""Rows of the largest system that is written out."""


def summed(graph: Graph, value: np.ndarray, dims: Any = None, keepdim: bool = False, **_: Any) -> np.ndarray:
    """The sum over some dimensions; over all where none is given."""
    axes = tuple(np.atleast_1d(dims)) if dims not in (None, []) else tuple(range(value.ndim))
    moved = np.moveaxis(value, [int(a) for a in axes], range(len(axes)))
    flat = moved.reshape(-1, *moved.shape[len(axes) :])
    total = operand(graph, np.zeros(flat.shape[1:]))
    for row in flat:
        total = elementwise("add")(graph, total, np.asarray(row, dtype=object).view(NodeArray))
    return np.expand_dims(total, tuple(int(a) for a in axes)) if keepdim else total


def product(graph: Graph, left: Any, right: Any) -> np.ndarray:
    """The matrix product as torch.matmul has it: of vectors, matrices, and batches of matrices."""
    left, right = operand(graph, left), operand(graph, right)
    a = left if left.ndim >= 2 else left[None, :]
    b = right if right.ndim >= 2 else right[:, None]
    terms = elementwise("mul")(graph, a[..., :, :, None].view(NodeArray), b[..., None, :, :].view(NodeArray))
    result = summed(graph, terms, [terms.ndim - 2])
    if left.ndim == 1:
        result = result[..., 0, :]
    return result[..., 0] if right.ndim == 1 else result


def _affine(graph: Graph, bias: Any, left: Any, right: Any, **_: Any) -> np.ndarray:
    return elementwise("add")(graph, product(graph, left, right), bias)


def _averaged(graph: Graph, value: np.ndarray, dims: Any = None, keepdim: bool = False, **_: Any) -> np.ndarray:
    total = summed(graph, value, dims, keepdim)
    return elementwise("div")(graph, total, float(value.size / max(total.size, 1)))


def determinant(graph: Graph, matrix: Any) -> np.ndarray:
    """The determinants (*batch) of square matrices (*batch, n, n)."""
    matrix = _square(graph, matrix)
    result = np.empty(matrix.shape[:-2], dtype=object)
    for at in np.ndindex(result.shape):
        result[at] = _Minors(graph, matrix[at]).all_columns()
    return result


def solved(graph: Graph, matrix: Any, right: Any) -> np.ndarray:
    """The solution of matrix · solution = right, (*batch, n, n) by (*batch, n) or (*batch, n, k), as torch.linalg.solve has it."""
    matrix, right = _square(graph, matrix), operand(graph, right)
    is_vector = right.ndim == 1 or (right.ndim == matrix.ndim - 1 and right.shape == matrix.shape[:-1])
    columns = right[..., None] if is_vector else right
    batch = np.broadcast_shapes(matrix.shape[:-2], columns.shape[:-2])
    n, k = columns.shape[-2:]
    if n != matrix.shape[-1]:
        raise ValueError("sizes differ")
    systems = np.broadcast_to(matrix, (*batch, n, n))
    sides = np.broadcast_to(columns, (*batch, n, k))
    result = np.empty((*batch, n, k), dtype=object)
    for at in np.ndindex(batch):
        result[at] = _cramer(graph, systems[at], sides[at])
    return result[..., 0] if is_vector else result


def inverse(graph: Graph, matrix: Any) -> np.ndarray:
    """The inverses (*batch, n, n)."""
    matrix = _square(graph, matrix)
    return solved(graph, matrix, np.broadcast_to(operand(graph, np.eye(matrix.shape[-1])), matrix.shape, subok=True))


def _square(graph: Graph, matrix: Any) -> np.ndarray:
    matrix = operand(graph, matrix)
    if matrix.ndim < 2 or matrix.shape[-1] != matrix.shape[-2]:
        raise ValueError("expected a square matrix")
    if matrix.shape[-1] > LARGEST:
        raise UnsupportedOperation(f"a system of more than {LARGEST} equations")
    return matrix


def _cramer(graph: Graph, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    whole = _Minors(graph, matrix).all_columns()
    result = np.empty(right.shape, dtype=object)
    for row, column in np.ndindex(right.shape):
        replaced = matrix.copy()
        replaced[:, row] = right[:, column]
        result[row, column] = graph.apply("div", _Minors(graph, replaced).all_columns(), whole)
    return result


class _Minors:
    """Determinants of the last rows of a matrix and some of its columns, each computed once."""

    def __init__(self, graph: Graph, matrix: np.ndarray) -> None:
        self.graph, self.matrix = graph, matrix
        self._known: dict[tuple[int, ...], int] = {}

    def all_columns(self) -> int:
        return self._of(tuple(range(len(self.matrix))))

    def _of(self, columns: tuple[int, ...]) -> int:
        if columns not in self._known:
            self._known[columns] = self._expanded(columns)
        return self._known[columns]

    def _expanded(self, columns: tuple[int, ...]) -> int:
        """Laplace's expansion along the first row of the minor."""
        row = len(self.matrix) - len(columns)
        if len(columns) == 1:
            return self.matrix[row, columns[0]]
        total = self.graph.constant(0.0)
        for k, column in enumerate(columns):
            term = self.graph.apply("mul", self.matrix[row, column], self._of(columns[:k] + columns[k + 1 :]))
            total = self.graph.apply("sub" if k % 2 else "add", total, term)
        return total


def _parts(graph: Graph, value: np.ndarray, dim: int = 0) -> tuple[np.ndarray, ...]:
    return tuple(np.asarray(part, dtype=object) for part in np.moveaxis(value, dim, 0))


def _diagonal(graph: Graph, value: np.ndarray, offset: int = 0, dim1: int = 0, dim2: int = 1) -> np.ndarray:
    return np.diagonal(value, offset, dim1, dim2)


def _onto_diagonal(graph: Graph, value: np.ndarray, offset: int = 0, dim1: int = -2, dim2: int = -1) -> np.ndarray:
    if (offset, dim1, dim2) != (0, -2, -1):
        raise ValueError("another diagonal")
    zero = graph.constant(0.0)
    return mapped(lambda entry, one: entry if one else zero, value[..., None, :], np.eye(value.shape[-1], dtype=int))


def _permuted(graph: Graph, value: np.ndarray, dims: Sequence[int]) -> np.ndarray:
    return np.transpose(value, [int(d) for d in dims])


MATRICES: dict[str, Callable[..., Any]] = {
    "sum": summed,
    "mean": _averaged,
    "mm": product,
    "mv": product,
    "dot": product,
    "bmm": product,
    "addmm": _affine,
    "addmv": _affine,
    "unbind": _parts,
    "diagonal": _diagonal,
    "diag_embed": _onto_diagonal,
    "permute": _permuted,
}

MATRICES_AT_ONCE: dict[str, Callable[..., Any]] = {
    "matmul": product,
    "__matmul__": product,
    "__rmatmul__": lambda graph, a, b: product(graph, b, a),
    "linalg_solve": solved,
    "linalg_inv": inverse,
    "inverse": inverse,
    "linalg_det": determinant,
    "det": determinant,
}
