"""A model by its name: a built-in system, or ``file.py:Class``."""

from __future__ import annotations

import ast
import importlib.util
import sys
from contextlib import suppress
from pathlib import Path
from types import ModuleType

from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.check import check_equations
from greybox_torch.reading import check_file
from greybox_torch.systems.robot_arm import RobotArm
from greybox_torch.systems.user_code import users_code

BUILT_IN: dict[str, type[GreyBoxModel]] = {RobotArm.name: RobotArm}


def load_model(name: str) -> GreyBoxModel:
    """The model called ``name``, with its declared values.

    Raises:
        UserError: no such built-in system, no such file, the file raises or does not define the class, or the equations of the
            class raise.
    """
    if name in BUILT_IN:
        return _named(BUILT_IN[name](), name)
    found = model_class(name)
    file, _, class_name = name.rpartition(":")
    path = Path(file)
    place = f"model file {file}, class {class_name}"
    try:
        with users_code(path, place, "creating it"):
            model = found()
        with users_code(path, place, "trying its equations"):
            check_equations(model)
        return _named(model, f"{path.resolve()}:{class_name}")
    except UserError as error:
        raise UserError(str(error) if str(error).startswith(place) else f"{place}: {error}") from None


def model_class(name: str) -> type[GreyBoxModel]:
    """The class called ``name``, of which no object is made yet.

    Raises:
        UserError: no such built-in system, no such file, or the file raises or does not define the class.
    """
    if name in BUILT_IN:
        return BUILT_IN[name]
    file, separator, class_name = name.rpartition(":")
    if not separator or not file.endswith(".py"):
        if name.endswith(".py") and Path(name).is_file():
            raise UserError(
                f"model '{name}' is a file; expected the class in it as well, such as {name}:{_class_in(name)}"
            )
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
    return found


def _named(model: GreyBoxModel, name: str) -> GreyBoxModel:
    model.loaded_as = name
    return model


def _class_in(file: str) -> str:
    """A model's class that a file defines, read and not run; one for an example where there is none."""
    with suppress(OSError, ValueError, SyntaxError, RecursionError):
        for node in ast.parse(Path(file).read_bytes()).body:
            if isinstance(node, ast.ClassDef):
                bases = [ast.unparse(base) for base in node.bases]
                if any(base.rpartition(".")[2] == GreyBoxModel.__name__ for base in bases):
                    return node.name
    return "Motor"


def _run(file: Path) -> ModuleType:
    check_file(file, "a model file such as my_motor.py", "model file")
    spec = importlib.util.spec_from_file_location(f"greybox_user_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise UserError(f"model file {file}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    place = f"model file {file}"
    try:
        with users_code(file, place, "running it"):
            spec.loader.exec_module(module)
    except UserError as error:
        raise UserError(str(error) if str(error).startswith(place) else f"{place}: {error}") from None
    return module
