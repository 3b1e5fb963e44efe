"""The course of a training as TensorBoard shows it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from greybox_torch.errors import UserError
from greybox_torch.training.state import Epoch


@contextmanager
def tensorboard_log(folder: Path) -> Iterator[Callable[[Epoch], None]]:
    """A function that logs an epoch to ``folder``; the step is its number, counted over all window lengths.

    Raises:
        UserError: the package tensorboard is not installed.
    """
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        raise UserError(
            "--tensorboard: the package tensorboard is not installed; install the extra greybox_torch[tensorboard], or leave it out"
        ) from None
    writer, count = SummaryWriter(str(folder)), 0

    def log(epoch: Epoch) -> None:
        nonlocal count
        count += 1
        for name in ("loss", "held_out", "fit", "learning_rate", "stage"):
            writer.add_scalar(name, getattr(epoch, name), count)

    try:
        yield log
    finally:
        writer.close()
