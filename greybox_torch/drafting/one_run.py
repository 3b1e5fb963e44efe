"""Files that may be of one run, input and output apart, though no time stamps say so."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.drafting.clock import Clock
from greybox_torch.drafting.recorded import Recorded
from greybox_torch.files import toml_text


def perhaps_one_run(files: Sequence[Recorded], clocks: Sequence[Clock], channels: int) -> str:
    """What to write if several files of equal length, without time stamps and with fewer columns each than the ``channels`` of a model, are
    one run; empty elsewhere. They are drafted as an experiment each, which nobody could tell from runs of their own.
    """
    counts = [len(file.columns) for file in files]
    alike = len({file.samples for file in files}) == 1 and all(clock.column is None for clock in clocks)
    if len(files) < 2 or not alike or max(counts) >= channels:
        return ""
    two = files[:2]
    listed = ", ".join(toml_text(file.path.name) for file in two)
    return (
        f"[[experiment]]: {' and '.join(file.path.name for file in two)} have {files[0].samples} samples each, no time stamps, and fewer "
        f"columns than a model has inputs and outputs; if they are of one run, one experiment with both: file = [{listed}], "
        f'join = "rows", and their columns by position: column = 1 to column = {sum(len(file.columns) for file in two)}'
    )
