"""Grey-box models: declarations, ports, constraints and the base class."""

from greybox_torch.model.declarations import Input, Output, Parameter, State
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.ports import Actuator, Balance, Body, Coupling, Port, driving_body
from greybox_torch.model.signals import Signals

__all__ = [
    "Actuator",
    "Balance",
    "Body",
    "Coupling",
    "GreyBoxModel",
    "Input",
    "Output",
    "Parameter",
    "Port",
    "Signals",
    "State",
    "driving_body",
]
