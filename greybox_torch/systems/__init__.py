"""Built-in machines, and loading a model by name."""

from greybox_torch.systems.load import BUILT_IN, load_model
from greybox_torch.systems.robot_arm import RobotArm

__all__ = ["BUILT_IN", "RobotArm", "load_model"]
