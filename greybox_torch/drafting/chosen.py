"""What a drafted card holds out for validation, and what to write to hold out something else."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.drafting.runs import Run, fullest, names_of

FEW = 80
"""Samples below which a file is not divided between estimation and validation."""


def held_out(runs: Sequence[Run]) -> str:
    """A sentence."""
    full, names = fullest(runs), names_of(runs)
    if len(full) > 1:
        return (
            f'"{names[full[-1]]}" is for validation, as the last file. Where the experiments differ in kind, give that role to another, '
            "or leave it out: with no such role on the card, the last quarter of every experiment is held out"
        )
    if runs[full[0]].whole.samples < FEW:
        return "the last quarter of every experiment, as no experiment has the role for it"
    return f'the last quarter of "{names[full[0]]}"'
