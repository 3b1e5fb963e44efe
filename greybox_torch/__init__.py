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
    from greybox_torch.data.readers import register_reader, unregister_reader
    from greybox_torch.data.readers.table import Table
    from greybox_torch.errors import NumericalError, UserError
    from greybox_torch.evaluation import Evaluation, evaluate
    from greybox_torch.mechanisms.friction_net import FrictionNet
    from greybox_torch.mechanisms.library import register, unregister
    from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
    from greybox_torch.mechanisms.residual_net import ResidualNet
    from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
    from greybox_torch.report.comparison import plot_comparison
    from greybox_torch.report.residuals import plot_residuals
    from greybox_torch.report.sections.order import register_section, unregister_section
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
    "Mechanism",
    "NumericalError",
    "Output",
    "Parameter",
    "Probe",
    "ResidualNet",
    "SavedModel",
    "Signals",
    "State",
    "Surroundings",
    "Table",
    "TrainingSettings",
    "UserError",
    "evaluate",
    "explain",
    "fit_physics",
    "load_checkpoint",
    "load_dataset",
    "load_model",
    "load_saved_model",
    "plot_comparison",
    "plot_residuals",
    "register",
    "register_reader",
    "register_section",
    "train_hybrid",
    "unregister",
    "unregister_reader",
    "unregister_section",
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
    "Mechanism": "greybox_torch.mechanisms.mechanism",
    "NumericalError": "greybox_torch.errors",
    "Output": "greybox_torch.model",
    "Parameter": "greybox_torch.model",
    "Probe": "greybox_torch.mechanisms.mechanism",
    "ResidualNet": "greybox_torch.mechanisms.residual_net",
    "SavedModel": "greybox_torch.restored",
    "Signals": "greybox_torch.model",
    "State": "greybox_torch.model",
    "Surroundings": "greybox_torch.mechanisms.mechanism",
    "Table": "greybox_torch.data.readers.table",
    "TrainingSettings": "greybox_torch.train",
    "UserError": "greybox_torch.errors",
    "evaluate": "greybox_torch.evaluation",
    "explain": "greybox_torch.train",
    "fit_physics": "greybox_torch.train",
    "load_checkpoint": "greybox_torch.checkpoint",
    "load_dataset": "greybox_torch.data",
    "load_model": "greybox_torch.systems",
    "load_saved_model": "greybox_torch.restored",
    "plot_comparison": "greybox_torch.report.comparison",
    "plot_residuals": "greybox_torch.report.residuals",
    "register": "greybox_torch.mechanisms.library",
    "register_reader": "greybox_torch.data.readers",
    "register_section": "greybox_torch.report.sections.order",
    "train_hybrid": "greybox_torch.train",
    "unregister": "greybox_torch.mechanisms.library",
    "unregister_reader": "greybox_torch.data.readers",
    "unregister_section": "greybox_torch.report.sections.order",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME_OF[name]), name)
    globals()[name] = value  # the next use finds it without coming here
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME_OF})
