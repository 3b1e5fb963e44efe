"""Mechanisms: the laws of physics that may be missing, attached to the ports of a model.

For work on the engine itself, as the experiments do it; a mechanism of one's own needs only :class:`greybox_torch.Mechanism` and
:func:`greybox_torch.register`. An :class:`Attachment` is a mechanism at a port, an :class:`AugmentedModel` a model with attachments.
"""

from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range
from greybox_torch.mechanisms.stored import restored_model

__all__ = ["Attachment", "AugmentedModel", "Range", "attach", "restored_model"]
