"""The hybrid: a network at a port of a physical model, trained on sequences and polished by Gauss-Newton."""

from greybox_torch.training.explain import Explanation, explain
from greybox_torch.training.hybrid import Hybrid, attach_network, default_port
from greybox_torch.training.hybrid_training import train_hybrid
from greybox_torch.training.physics import Physics, fit_physics
from greybox_torch.training.settings import TrainingSettings
from greybox_torch.training.trained import Report, Trained

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
