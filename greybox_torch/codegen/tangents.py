"""How tangents go through one Runge-Kutta step, written out without the terms that are zero whatever the values.

One step is linear in the tangents: q goes over to S q + sum of M[s] b[s], b[s] the partial derivatives by a parameter in stage s. Both
matrices follow from the Jacobians A[s] of the stages, backwards:

    M[3] = H/6 I,   M[2] = H M[3] A[3] + H/3 I,   M[1] = H/2 M[2] A[2] + H/3 I,   M[0] = H/2 M[1] A[1] + H/6 I,   S = I + sum of M[s] A[s]

Which entries are zero follows from which entries of the Jacobian are: a lag's state depends on nothing behind the lag. Matrices are
stored by columns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

STAGES = 4

WRITTEN_OUT = 16
"""States up to which every entry has a statement of its own; beyond, statements are in loops over rows, which are compiled in less time."""


@dataclass(frozen=True)
class Entry:
    """An entry of the sparse Jacobian: its place in A, and its value where that is constant."""

    place: int
    constant: float | None


@dataclass(frozen=True)
class Transition:
    """``entries`` of the Jacobian by (row, column), and where, (row, column), ``through[s]`` = M[s] and ``step`` = S are not zero."""

    size: int
    entries: Mapping[tuple[int, int], Entry]
    through: tuple[frozenset[tuple[int, int]], ...]
    step: frozenset[tuple[int, int]]

    @classmethod
    def of(cls, size: int, entries: Mapping[tuple[int, int], Entry]) -> Transition:
        diagonal = frozenset((i, i) for i in range(size))
        through, step = [diagonal], diagonal
        for stage in reversed(range(STAGES)):
            product = _product(through[0], frozenset(entries))
            step |= product
            if stage:
                through.insert(0, product | diagonal)
        return cls(size, entries, tuple(through), step)

    def matrices(self) -> str:
        """Statements that fill ``S[column][row]`` and ``M[stage][column][row]`` from ``A[stage][place]`` and the step ``H``."""
        lines = ["const vec sixth = H / (real)6, third = H / (real)3, half = H * (real)0.5;"]
        turns = [(stage, column) for stage in reversed(range(STAGES)) for column in range(self.size)]
        if self.size > WRITTEN_OUT:
            lines.append("for (int j = 0; j < NT; j++) for (int i = 0; i < NT; i++) {")
            lines.append("M[3][j][i] = i == j ? sixth : vec{}; S[j][i] = splat(i == j);\n}")
            return "\n".join([*lines, *(self._looped_column(*turn) for turn in turns)])
        lines += [f"M[3][{i}][{i}] = sixth; S[{i}][{i}] = splat(1);" for i in range(self.size)]
        known = {(i, i) for i in range(self.size)}
        for turn in turns:
            lines += self._column(*turn, known)
        return "\n".join(lines)

    def _column(self, stage: int, column: int, known: set[tuple[int, int]]) -> list[str]:
        """Statements for one column of M[stage] A[stage], of what it adds to S, and of M[stage - 1]; ``known`` are entries of S so far."""
        lines, of_column = ["{"], self._of_column(column)
        for row in range(self.size):
            terms = [_term(stage, k, str(row), e) for k, e in of_column if (row, k) in self.through[stage]]
            at, diagonal = f"[{column}][{row}]", row == column
            if terms:
                sign = "+=" if (row, column) in known else "="
                lines += [f"const vec p{row} = {added(terms)};", f"S{at} {sign} p{row};"]
                known.add((row, column))
            if stage and (terms or diagonal):
                parts = [f"{_factor(stage)} * p{row}"] * bool(terms) + [_own(stage)] * diagonal
                lines.append(f"M[{stage - 1}]{at} = {added(parts)};")
        return [*lines, "}"]

    def _looped_column(self, stage: int, column: int) -> str:
        """The same for all rows at once, zeros or not."""
        terms = [_term(stage, k, "i", e) for k, e in self._of_column(column)]
        lines = [f"for (int i = 0; i < NT; i++) {{ const vec p = {added(terms or ['vec{}'])}; S[{column}][i] += p;"]
        if stage:
            parts = [f"{_factor(stage)} * p", f"(i == {column} ? {_own(stage)} : vec{{}})"]
            lines.append(f"M[{stage - 1}][{column}][i] = {added(parts)};")
        return " ".join([*lines, "}"])

    def _of_column(self, column: int) -> list[tuple[int, Entry]]:
        """The rows and entries of one column of the Jacobian."""
        return [(row, entry) for (row, j), entry in sorted(self.entries.items()) if j == column]

    def propagation(self) -> str:
        """Statements of ``q = S q + sum of M[s] b[s]`` over the stages s, with the partial derivatives b by parameter c."""
        rows, lines = range(self.size), []
        for i in rows:
            terms = [f"S[{j}][{i}] * q[{j}]" for j in rows if self.size > WRITTEN_OUT or (i, j) in self.step]
            lines.append(f"vec w{i} = {added(terms)};")
        lines.append("for (long k = first[c]; k < first[c + 1]; k++) {")
        lines += [f"const vec b{s} = B[k][{s}];" for s in range(STAGES)]
        if self.size > WRITTEN_OUT:
            lines.append("const long r = row[k];")
            lines += [f"w{i} += {added([f'M[{s}][r][{i}] * b{s}' for s in range(STAGES)])};" for i in rows]
        else:
            lines += ["switch (row[k]) {", *(self._forced(r) for r in rows), "}"]
        return "\n".join([*lines, "}", *(f"q[{i}] = w{i};" for i in rows)])

    def _forced(self, r: int) -> str:
        """What partial derivatives of the rate of state ``r`` add."""
        lines = [f"case {r}:"]
        for i in range(self.size):
            terms = [f"M[{s}][{r}][{i}] * b{s}" for s in range(STAGES) if (i, r) in self.through[s]]
            lines += [f"w{i} += {added(terms)};"] if terms else []
        return "\n".join([*lines, "break;"])


def _term(stage: int, through: int, row: str, entry: Entry) -> str:
    """What a row of M[stage] A[stage] has of an ``entry`` of A, by the column ``through`` of M."""
    return scaled(f"M[{stage}][{through}][{row}]", f"A[{stage}][{entry.place}]", entry.constant)


def _factor(stage: int) -> str:
    """By what M[stage] A[stage] is multiplied in M[stage - 1]."""
    return "H" if stage == STAGES - 1 else "half"


def _own(stage: int) -> str:
    """What stands on the diagonal of M[stage - 1] besides: the weight of that stage in the step."""
    return "sixth" if stage == 1 else "third"


def scaled(source: str, entry: str, constant: float | None) -> str:
    """``entry`` times ``source``, written out where it is ``constant`` and 1 or -1."""
    return source if constant == 1.0 else f"-{source}" if constant == -1.0 else f"{entry} * {source}"


def added(terms: list[str]) -> str:
    """The sum of ``terms``."""
    return " + ".join(terms).replace("+ -", "- ")


def _product(left: frozenset[tuple[int, int]], right: frozenset[tuple[int, int]]) -> frozenset[tuple[int, int]]:
    """Where the product of two matrices is not zero."""
    return frozenset((i, j) for i, k in left for m, j in right if m == k)
