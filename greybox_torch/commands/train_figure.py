"""The figure that `greybox train` draws of what the network has learned."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from greybox_torch.files import replacing
from greybox_torch.train import Explanation, Trained


@contextmanager
def figure_file(path: Path, found: Trained, explained: Explanation | None) -> Iterator[None]:
    """The figure at ``path`` once the block has ended without an error; none where there is nothing to draw."""
    if explained is None or not explained.curves:
        yield
        return
    from greybox_torch.report.learned import plot_learned

    network = found.hybrid.network
    with replacing(path) as temporary:
        plot_learned(found, explained, f"What {network.mechanism.name} at {network.port} has learned").savefig(
            temporary
        )
        yield
