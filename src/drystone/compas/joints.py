"""The joint law of a `Problem`: its contact model and its joint model."""

from __future__ import annotations

from typing import Any

from drystone.common.errors import ModelError
from drystone.model.joint_law import JointLaw

#: The contact model that a joint of drystone can be.
MOHR_COULOMB = "MohrCoulomb"


def joint_law(properties: Any) -> JointLaw:
    """The law of every joint, from `ContactProperties`.

    Friction, cohesion ``c`` [Pa] and tension cutoff ``t_c`` [Pa] are those of `MohrCoulomb`; a
    joint does not dilate, as those of the solvers of compas_dem do not.  ``kn`` and ``kt`` of the
    joint model are taken per area [Pa/m], as compas_3dec takes them.

    Raises
    ------
    ModelError
        There is no contact model, or it is of a kind that joints here cannot be.
    """
    contact, joint = properties.contact_model, properties.joint_model
    if contact is None:
        raise ModelError(
            ['contact model: is missing: call problem.set_contact_model("MohrCoulomb", mu=...)']
        )
    if type(contact).__name__ != MOHR_COULOMB:
        raise ModelError(
            [
                f"contact model: {type(contact).__name__} is none that drystone has: take "
                "MohrCoulomb, or give solve a joint=ds.JointLaw(...)"
            ]
        )
    return JointLaw(
        friction_coefficient=float(contact.mu),
        cohesion=float(contact.c or 0.0),
        tensile_strength=float(contact.t_c or 0.0),
        normal_stiffness=_stiffness(joint, "kn"),
        shear_stiffness=_stiffness(joint, "kt"),
    )


def _stiffness(joint: Any, name: str) -> float | None:
    value = getattr(joint, name, None)
    return None if value is None else float(value)


def check_stiffness(joint: JointLaw) -> None:
    """Raise `ModelError` where a curve cannot be traced for want of a stiffness."""
    if joint.normal_stiffness is None or joint.shear_stiffness is None:
        raise ModelError(
            [
                "joint model: is missing or incomplete: call problem.set_joint_model(kn=..., "
                "kt=...), in Pa/m; joints of drystone are elastic"
            ]
        )
