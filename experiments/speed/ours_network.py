"""Our side of the network row."""

from __future__ import annotations

import numpy as np

from experiments.speed.network import NetworkTask


def ours_network_gradient(task: NetworkTask) -> tuple[float, np.ndarray]:
    """Loss and gradient (49,) of :class:`NetworkTask`. What is compiled or prepared once must be kept between calls.

    Raises:
        NotImplementedError: the engine cannot yet train networks.
    """
    raise NotImplementedError("greybox_torch has no batched network training yet")
