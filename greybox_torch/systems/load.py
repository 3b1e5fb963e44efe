"""A model by its name: a built-in system, or ``file.py:Class``."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType

from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.check import check_equations
from greybox_torch.systems.robot_arm import RobotArm

BUILT_IN: dict[str, type[GreyBoxModel]] = {RobotArm.name: RobotArm}


def load_model(name: str) -> GreyBoxModel:
    """The model called ``name``, with its declared values.

    Raises:
        UserError: no such built-in system, no such file, the file raises or does not define the class, or the equations of the
            class raise.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]()
    file, separator, class_name = name.rpartition(":")
    if not separator or not file.endswith(".py"):
        known = ", ".join(BUILT_IN)
        raise UserError(
            f"model '{name}' is unknown; expected a built-in system ({known}) or a file and class such as my_motor.py:Motor"
        )
    module = _run(Path(file))
    found = getattr(module, class_name, None)
    if not (isinstance(found, type) and issubclass(found, GreyBoxModel)):
        classes = [
            n
            for n, v in vars(module).items()
            if isinstance(v, type) and issubclass(v, GreyBoxModel) and v is not GreyBoxModel
        ]
        have = f"it defines {', '.join(classes)}" if classes else "it defines no GreyBoxModel"
        what = "is not a GreyBoxModel" if found is not None else "is not defined"
        raise UserError(f"model file {file}: class '{class_name}' {what}; {have}")
    try:
        model = found()
        check_equations(model)
        return model
    except UserError as error:
        raise UserError(f"model file {file}, class {class_name}: {error}") from None
    except Exception as error:
        raise UserError(
            f"model file {file}, class {class_name}: creating it raised {type(error).__name__}: {error}"
        ) from None


def _run(file: Path) -> ModuleType:
    if not file.is_file():
        raise UserError(f"model file {file}: no such file")
    spec = importlib.util.spec_from_file_location(f"greybox_user_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise UserError(f"model file {file}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except UserError as error:
        raise UserError(f"model file {file}: {error}") from None
    except Exception as error:
        line = _line_in(file, error)
        raise UserError(f"model file {file}{line}: running it raised {type(error).__name__}: {error}") from None
    return module


def _line_in(file: Path, error: BaseException) -> str:
    """The last line of ``file`` on the way to the error."""
    if isinstance(error, SyntaxError):
        return f", line {error.lineno}"
    lines = [
        f.lineno for f in traceback.extract_tb(error.__traceback__) if Path(f.filename).resolve() == file.resolve()
    ]
    return f", line {lines[-1]}" if lines else ""
