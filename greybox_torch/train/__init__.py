"""The hybrid: a network at a port of a physical model, trained on sequences and polished by Gauss-Newton."""

from greybox_torch.train.explain import Explanation, explain
from greybox_torch.train.hybrid import Hybrid, attach_network, default_port
from greybox_torch.train.physics import Physics, fit_physics
from greybox_torch.train.settings import TrainingSettings
from greybox_torch.train.trained import Report, Trained
from greybox_torch.train.training import train_hybrid

__all__ = [
    "Explanation",
    "Hybrid",
    "Physics",
    "Report",
    "Trained",
    "TrainingSettings",
    "attach_network",
    "default_port",
    "explain",
    "fit_physics",
    "train_hybrid",
]
