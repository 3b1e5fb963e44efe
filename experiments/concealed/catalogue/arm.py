"""The catalogue of the arm.

`accept` lists the (port, mechanism) pairs that name the effect, its twins on such data included; `near` those that a
reasonable engineer could defend; `ports` the places that count as located. Twins, and why:

- A constant torque is the same at the motor, at the actuator and, but for a constant twist, at gearbox and arm.
- A delay of the input and one of the output differ by a shift of time only, and the plant does not depend on time.
- Gravity turns once in a turn of any of the three bodies, which differ by a small twist.

Left out, because torque and motor speed alone cannot show them: `input_gain` and `sensor_gain` (J is fixed, yet a gain
that scales torque, or speed, is taken up by friction, stiffness and the other constants only in part; which of the two it was,
and whether it was not J that is wrong, nothing tells), Coulomb, viscous and Stribeck friction at the motor (parameters of the
plain model), and nonlinear stiffness of the gear spring (likewise, `k_g3`).
"""

from __future__ import annotations

from experiments.concealed.catalogue.arm_couplings import coupling_effects
from experiments.concealed.catalogue.arm_drive import drive_effects
from experiments.concealed.catalogue.arm_forces import force_effects
from experiments.concealed.catalogue.arm_friction import friction_effects
from experiments.concealed.catalogue.arm_outside import outside_effects
from experiments.concealed.catalogue.arm_sharp import sharp_effects
from experiments.concealed.effects import Effect

CATALOGUE: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        *friction_effects(),
        *force_effects(),
        *coupling_effects(),
        *drive_effects(),
        *outside_effects(),
        *sharp_effects(),
    )
}
LIBRARY = tuple(name for name, effect in CATALOGUE.items() if not (effect.outside or effect.sharp))
OUTSIDE = tuple(name for name, effect in CATALOGUE.items() if effect.outside)
