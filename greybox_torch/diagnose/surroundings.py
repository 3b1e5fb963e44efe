"""Where the signals around every port moved, see :mod:`greybox_torch.estimate.surroundings`, which training needs too."""

from greybox_torch.estimate.surroundings import survey

__all__ = ["survey"]
