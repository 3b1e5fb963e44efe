"""Which hypotheses are worth a refit: a score test of every mechanism at every port, and the shortlist from it.

For work on the diagnosis itself, as the experiments do it: :func:`candidates` lists what can be attached where, a :class:`Screen` tests it.
"""

from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.screen.score_test import Screen

__all__ = ["Screen", "candidates"]
