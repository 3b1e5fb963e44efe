"""Grey-box models of machines: estimate them, find what physics they leave out, name it, and model it.

The public names are loaded on first use, so that `import greybox_torch` (and `greybox --help`) does not wait for
torch.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from greybox_torch.checkpoint import Checkpoint, load_checkpoint
    from greybox_torch.data import DataSet, load_dataset
    from greybox_torch.evaluation import Evaluation, evaluate
    from greybox_torch.mechanisms.friction_net import FrictionNet
    from greybox_torch.mechanisms.residual_net import ResidualNet
    from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
    from greybox_torch.report.comparison import plot_comparison
    from greybox_torch.report.residuals import plot_residuals
    from greybox_torch.restored import SavedModel, load_saved_model
    from greybox_torch.systems import load_model
    from greybox_torch.train import TrainingSettings, explain, fit_physics, train_hybrid

__version__ = "0.1.0"

__all__ = [
    "Balance",
    "Body",
    "Checkpoint",
    "Coupling",
    "DataSet",
    "Evaluation",
    "FrictionNet",
    "GreyBoxModel",
    "Input",
    "Output",
    "Parameter",
    "ResidualNet",
    "SavedModel",
    "State",
    "TrainingSettings",
    "evaluate",
    "explain",
    "fit_physics",
    "load_checkpoint",
    "load_dataset",
    "load_model",
    "load_saved_model",
    "plot_comparison",
    "plot_residuals",
    "train_hybrid",
]

_HOME_OF = {
    "Balance": "greybox_torch.model",
    "Body": "greybox_torch.model",
    "Checkpoint": "greybox_torch.checkpoint",
    "Coupling": "greybox_torch.model",
    "DataSet": "greybox_torch.data",
    "Evaluation": "greybox_torch.evaluation",
    "FrictionNet": "greybox_torch.mechanisms.friction_net",
    "GreyBoxModel": "greybox_torch.model",
    "Input": "greybox_torch.model",
    "Output": "greybox_torch.model",
    "Parameter": "greybox_torch.model",
    "ResidualNet": "greybox_torch.mechanisms.residual_net",
    "SavedModel": "greybox_torch.restored",
    "State": "greybox_torch.model",
    "TrainingSettings": "greybox_torch.train",
    "evaluate": "greybox_torch.evaluation",
    "explain": "greybox_torch.train",
    "load_checkpoint": "greybox_torch.checkpoint",
    "load_dataset": "greybox_torch.data",
    "load_model": "greybox_torch.systems",
    "load_saved_model": "greybox_torch.restored",
    "fit_physics": "greybox_torch.train",
    "plot_comparison": "greybox_torch.report.comparison",
    "plot_residuals": "greybox_torch.report.residuals",
    "train_hybrid": "greybox_torch.train",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME_OF[name]), name)
    globals()[name] = value  # the next use finds it without coming here
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME_OF})
