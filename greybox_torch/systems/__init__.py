"""Built-in machines, and loading a model by name."""

from greybox_torch.systems.load import BUILT_IN, load_model, model_class
from greybox_torch.systems.reference import defined_here, model_reference
from greybox_torch.systems.robot_arm import RobotArm

__all__ = ["BUILT_IN", "RobotArm", "defined_here", "load_model", "model_class", "model_reference"]
