"""Machines in MuJoCo's language. What is concealed is a set of changes to the description, by "JOINT.ATTRIBUTE" or "ATTRIBUTE".

MuJoCo's usual rule (semi-implicit Euler) is of first order in its step: at 0.5 ms its error stands above an encoder's noise, and at 5e-5 s
it is still seen in machines whose inertia changes with position. Its Runge-Kutta rule of fourth order leaves no more than the noise at
2e-4 s, in the same time of computation. Constraints (dry friction, stops) are made stiff: by default a joint that should stick creeps for
20 ms.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

STEP, ROUGH_STEP = 2e-4, 5e-4
"""Of the integrator [s]: for what is recorded, and for the search of a scale."""
GRAVITY = 9.81
STIFF = 'solreffriction="0.002 1" solimpfriction="0.99 0.999 0.001"'

Changes = Mapping[str, float]


def document(bodies: str, rest: str, changes: Changes, *, step: float) -> str:
    """The whole description. `tilt` [rad] turns gravity away from -z, towards `tilt_axis` (0: x, 1: y); `density` is that of the air."""
    tilt = changes.get("tilt", 0.0)
    pull = [0.0, 0.0, -GRAVITY * np.cos(tilt)]
    pull[int(changes.get("tilt_axis", 0.0))] = GRAVITY * np.sin(tilt)
    gravity = " ".join(f"{g:.12g}" for g in pull)
    return (
        f'<mujoco><compiler angle="radian" autolimits="true"/>'
        f'<option timestep="{step}" integrator="RK4" gravity="{gravity}" density="{changes.get("density", 0.0):.9g}" '
        f'tolerance="1e-12" iterations="50"><flag contact="disable"/></option>'
        f"<worldbody>{bodies}</worldbody>{rest}</mujoco>"
    )


def joint(name: str, kind: str, axis: str, changes: Changes, *, damping: float) -> str:
    """A joint with its damping; `NAME.frictionloss`, `NAME.damping` (added), `NAME.upper` (a stop) may be concealed in it."""
    stop = changes.get(f"{name}.upper")
    limit = (
        ""
        if stop is None
        else f'range="-1000 {stop:.9g}" solreflimit="{_reference(name, changes)}" solimplimit="0.9 0.99 0.001"'
    )
    return (
        f'<joint name="{name}" type="{kind}" axis="{axis}" damping="{damping + changes.get(f"{name}.damping", 0.0):.12g}" '
        f'frictionloss="{changes.get(f"{name}.frictionloss", 0.0):.12g}" {STIFF} {limit}/>'
    )


def inertial(mass: float, position: str, inertia: tuple[float, float, float]) -> str:
    """Mass [kg], centre of mass [m] and the three moments about it [kg m^2]."""
    return f'<inertial mass="{mass:.12g}" pos="{position}" diaginertia="{" ".join(f"{i:.12g}" for i in inertia)}"/>'


def motors(joints: Sequence[str], changes: Changes) -> str:
    """A motor at each joint, of gain 1; `gain`, `limit` (of the force) and `lag` [s] may be concealed in the first."""
    found = []
    for i, name in enumerate(joints):
        own = changes if i == 0 else {}
        limit = f'forcerange="{-own["limit"]:.12g} {own["limit"]:.12g}"' if "limit" in own else ""
        lag = f'dyntype="filterexact" dynprm="{own["lag"]:.12g}"' if "lag" in own else ""
        gain = f'gainprm="{own.get("gain", 1.0):.12g}"'
        found.append(f'<general name="{name}" joint="{name}" {gain} {limit} {lag}/>')
    return f"<actuator>{''.join(found)}</actuator>"


def _reference(name: str, changes: Changes) -> str:
    """Time constant [s] and damping ratio of a stop."""
    return f"{changes.get(f'{name}.stop_time', 0.01):.9g} {changes.get(f'{name}.stop_damping', 0.5):.9g}"


def spring(
    name: str, coefficients: Mapping[str, float], *, stiffness: float, damping: float = 0.0, band: float = 0.0
) -> str:
    """A spring and a damper on a sum of joint positions; the spring is slack within +- `band`."""
    terms = "".join(f'<joint joint="{joint}" coef="{c:g}"/>' for joint, c in coefficients.items())
    return (
        f'<tendon><fixed name="{name}" stiffness="{stiffness:.12g}" damping="{damping:.12g}" '
        f'springlength="{-band:.12g} {band:.12g}">{terms}</fixed></tendon>'
    )


def slack_spring(joint: str, changes: Changes) -> str:
    """The spring to the base that may be concealed at a joint; nothing where it is not."""
    stiffness = changes.get(f"{joint}.spring")
    return (
        ""
        if stiffness is None
        else spring(f"{joint}_spring", {joint: 1.0}, stiffness=stiffness, band=changes[f"{joint}.band"])
    )
