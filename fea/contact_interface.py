"""What Newton's method needs of a contact."""

from dataclasses import dataclass
from typing import Protocol

import scipy.sparse as sp

from fea.arrays import F64


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactState:
    """Contact forces at a displacement.

    Attributes
    ----------
    force_n : array [n_nodes, 3]
        Forces of the contact on the nodes (minus the gradient of its energy).
    hessian : csr_array [3 n_nodes, 3 n_nodes]
        Hessian of its energy [N/m], upper triangle.
    """

    force_n: F64
    hessian: sp.csr_array


class Contact(Protocol):
    """What Newton's method needs of a contact."""

    def evaluate(self, u_m: F64, *, project: bool = True) -> ContactState:
        """Return forces and Hessian at displacements [n_nodes, 3]; ``project`` makes it positive semi-definite."""
        ...

    def force_n(self, u_m: F64) -> F64:
        """Return the forces alone [n_nodes, 3]."""
        ...

    def energy(self, u_m: F64) -> float:
        """Return the energy [J]; the forces are its gradient where the contact is held."""
        ...

    def held(self, u_m: F64, /) -> "Contact":
        """Return the contact that has an energy and these forces at u: friction with the normal forces of u."""
        ...

    def following(self, u_m: F64, /) -> "Contact":
        """Return the contact of the next load step, after converging at u."""
        ...

    def step_bound(self, u_m: F64, trial_m: F64) -> float:
        """Return the fraction in [0, 1] of the straight way from u to the trial on which nothing touches."""
        ...
