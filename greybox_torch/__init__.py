"""Grey-box models of machines: estimate them, find what physics they leave out, name it, and model it.

    import greybox_torch as gt

    data = gt.load_dataset("dataset.toml")
    found = gt.diagnose(Motor(), data)
    print(found)
    found.save("results")

The public names are loaded on first use, so that `import greybox_torch` (and `greybox --help`) does not wait for torch.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from greybox_torch.api.card import CardResult, card
    from greybox_torch.api.check import check
    from greybox_torch.api.check_result import CheckResult
    from greybox_torch.api.compare import ComparisonResult, compare
    from greybox_torch.api.design import design
    from greybox_torch.api.design_result import DesignResult
    from greybox_torch.api.diagnose import diagnose
    from greybox_torch.api.diagnosis_result import DiagnosisResult
    from greybox_torch.api.export import export
    from greybox_torch.api.export_result import ExportResult, SnippetResult
    from greybox_torch.api.fit import fit
    from greybox_torch.api.fit_many import fit_many
    from greybox_torch.api.fit_result import FitResult
    from greybox_torch.api.fleet import fleet
    from greybox_torch.api.fleet_result import FleetResult
    from greybox_torch.api.inspect import InspectionResult, inspect
    from greybox_torch.api.new import NewModel, new
    from greybox_torch.api.residuals import ResidualResult, residuals
    from greybox_torch.api.simulate import SimulationResult, simulate
    from greybox_torch.api.train import train
    from greybox_torch.api.train_result import TrainingResult
    from greybox_torch.checkpoint import Checkpoint, load_checkpoint
    from greybox_torch.data import DataSet, Recording, load_dataset
    from greybox_torch.data.readers import register_reader, unregister_reader
    from greybox_torch.data.readers.table import Table
    from greybox_torch.diagnosis.progress import Progress
    from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
    from greybox_torch.errors import ArgumentError, NumericalError, UserError
    from greybox_torch.evaluation import Evaluation, evaluate
    from greybox_torch.mechanisms.friction_net import FrictionNet
    from greybox_torch.mechanisms.library import register, unregister
    from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
    from greybox_torch.mechanisms.memory_net import MemoryNet
    from greybox_torch.mechanisms.residual_net import ResidualNet
    from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
    from greybox_torch.report.comparison import plot_comparison
    from greybox_torch.report.residuals import plot_residuals
    from greybox_torch.report.sections.order import register_section, unregister_section
    from greybox_torch.restored import SavedModel, load, load_saved_model
    from greybox_torch.systems import load_model
    from greybox_torch.training import TrainingSettings, explain, fit_physics, train_hybrid

__version__ = "0.1.0"

__all__ = [
    "ArgumentError",
    "Balance",
    "Body",
    "CardResult",
    "CheckResult",
    "Checkpoint",
    "ComparisonResult",
    "Coupling",
    "DataSet",
    "DesignResult",
    "DiagnosisResult",
    "DiagnosisSettings",
    "Evaluation",
    "ExportResult",
    "FitResult",
    "FleetResult",
    "FrictionNet",
    "GreyBoxModel",
    "Input",
    "InspectionResult",
    "Mechanism",
    "MemoryNet",
    "NewModel",
    "NumericalError",
    "Output",
    "Parameter",
    "Probe",
    "Progress",
    "Recording",
    "ResidualNet",
    "ResidualResult",
    "SavedModel",
    "SearchBudget",
    "Signals",
    "SimulationResult",
    "SnippetResult",
    "State",
    "Surroundings",
    "Table",
    "TrainingResult",
    "TrainingSettings",
    "UserError",
    "card",
    "check",
    "compare",
    "design",
    "diagnose",
    "evaluate",
    "explain",
    "export",
    "fit",
    "fit_many",
    "fit_physics",
    "fleet",
    "inspect",
    "load",
    "load_checkpoint",
    "load_dataset",
    "load_model",
    "load_saved_model",
    "new",
    "plot_comparison",
    "plot_residuals",
    "register",
    "register_reader",
    "register_section",
    "residuals",
    "simulate",
    "train",
    "train_hybrid",
    "unregister",
    "unregister_reader",
    "unregister_section",
]

_HOME_OF = {
    "ArgumentError": "greybox_torch.errors",
    "Balance": "greybox_torch.model",
    "Body": "greybox_torch.model",
    "CardResult": "greybox_torch.api.card",
    "CheckResult": "greybox_torch.api.check_result",
    "Checkpoint": "greybox_torch.checkpoint",
    "ComparisonResult": "greybox_torch.api.compare",
    "Coupling": "greybox_torch.model",
    "DataSet": "greybox_torch.data",
    "DesignResult": "greybox_torch.api.design_result",
    "DiagnosisResult": "greybox_torch.api.diagnosis_result",
    "DiagnosisSettings": "greybox_torch.diagnosis.settings",
    "Evaluation": "greybox_torch.evaluation",
    "ExportResult": "greybox_torch.api.export_result",
    "FitResult": "greybox_torch.api.fit_result",
    "FleetResult": "greybox_torch.api.fleet_result",
    "FrictionNet": "greybox_torch.mechanisms.friction_net",
    "GreyBoxModel": "greybox_torch.model",
    "Input": "greybox_torch.model",
    "InspectionResult": "greybox_torch.api.inspect",
    "Mechanism": "greybox_torch.mechanisms.mechanism",
    "MemoryNet": "greybox_torch.mechanisms.memory_net",
    "NewModel": "greybox_torch.api.new",
    "NumericalError": "greybox_torch.errors",
    "Output": "greybox_torch.model",
    "Parameter": "greybox_torch.model",
    "Probe": "greybox_torch.mechanisms.mechanism",
    "Progress": "greybox_torch.diagnosis.progress",
    "Recording": "greybox_torch.data",
    "ResidualNet": "greybox_torch.mechanisms.residual_net",
    "ResidualResult": "greybox_torch.api.residuals",
    "SavedModel": "greybox_torch.restored",
    "SearchBudget": "greybox_torch.diagnosis.settings",
    "Signals": "greybox_torch.model",
    "SimulationResult": "greybox_torch.api.simulate",
    "SnippetResult": "greybox_torch.api.export_result",
    "State": "greybox_torch.model",
    "Surroundings": "greybox_torch.mechanisms.mechanism",
    "Table": "greybox_torch.data.readers.table",
    "TrainingResult": "greybox_torch.api.train_result",
    "TrainingSettings": "greybox_torch.training",
    "UserError": "greybox_torch.errors",
    "card": "greybox_torch.api.card",
    "check": "greybox_torch.api.check",
    "compare": "greybox_torch.api.compare",
    "design": "greybox_torch.api.design",
    "diagnose": "greybox_torch.api.diagnose",
    "evaluate": "greybox_torch.evaluation",
    "explain": "greybox_torch.training",
    "export": "greybox_torch.api.export",
    "fit": "greybox_torch.api.fit",
    "fit_many": "greybox_torch.api.fit_many",
    "fit_physics": "greybox_torch.training",
    "fleet": "greybox_torch.api.fleet",
    "inspect": "greybox_torch.api.inspect",
    "load": "greybox_torch.restored",
    "load_checkpoint": "greybox_torch.checkpoint",
    "load_dataset": "greybox_torch.data",
    "load_model": "greybox_torch.systems",
    "load_saved_model": "greybox_torch.restored",
    "new": "greybox_torch.api.new",
    "plot_comparison": "greybox_torch.report.comparison",
    "plot_residuals": "greybox_torch.report.residuals",
    "register": "greybox_torch.mechanisms.library",
    "register_reader": "greybox_torch.data.readers",
    "register_section": "greybox_torch.report.sections.order",
    "residuals": "greybox_torch.api.residuals",
    "simulate": "greybox_torch.api.simulate",
    "train": "greybox_torch.api.train",
    "train_hybrid": "greybox_torch.training",
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
    """The public names, and those of a module's own; not what this file imports for itself."""
    own = {name for name in globals() if name.startswith("__") and name.endswith("__")}
    return sorted(own | set(__all__))
