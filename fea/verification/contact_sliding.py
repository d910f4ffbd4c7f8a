"""An elastic block pressed on an elastic plane and pushed to and fro: Coulomb's law for the body as a whole.

The top face is lowered and then moved sideways. While anything sticks, the tangential force T grows with the
displacement; when all slides, T = mu N. A closed loop loses the work of friction, without friction nothing.
The blocks are flat (1 : 10), so that tilting does not peel off the trailing edge at mu = 0.8.
"""

from dataclasses import dataclass

import numpy as np

from fea.arrays import F64
from fea.rubber import neo_hookean
from fea.verification.common import Row
from fea.verification.contact_blocks import Block, block_pair, drive, settings

SHEAR_MODULUS_PA, PRESS_M, BEFORE_M, TRAVEL_M = 3.3e5, 3e-5, 2e-5, 4e-4
_CONTACT = {"segments": (0.05e-3, 1e7), "barrier": (0.2e-3, 1e6)}
"""Choices: distance [m] and stiffness [Pa]. The pressure is higher where the block leads, so a soft layer tilts it:
segments of 0.2 mm and 1 MPa give 2 % less than mu 0.1."""
_COUNTED_FROM = 0.85
"""Choice: the end of each way is gross sliding for every coefficient used here."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Loop:
    """Tangential displacement of the top face, tangential and normal force [n] over forward and backward way.

    ``forward`` is the number of states of the forward way, the pressed start included.
    """

    moved_m: F64
    tangential_n: F64
    normal_n: F64
    forward: int
    dofs: int
    iterations: int

    @property
    def ratio(self) -> F64:
        """T / N."""
        return self.tangential_n / self.normal_n

    @property
    def sliding(self) -> tuple[float, float]:
        """Mean T / N of gross sliding forward and backward (negative)."""
        n, last = self.forward, self.moved_m.max()
        there = self.moved_m[:n] >= _COUNTED_FROM * last
        back = self.moved_m[n:] <= (1.0 - _COUNTED_FROM) * last
        return float(self.ratio[:n][there].mean()), float(self.ratio[n:][back].mean())

    @property
    def work_j(self) -> float:
        """Work of the tangential force over the way (trapezoidal rule)."""
        return float(np.trapezoid(self.tangential_n, self.moved_m))


def sliding_loop(friction: float, *, contact: str = "segments", cells: int = 4, steps: int = 8) -> Loop:
    """Press, push by ``TRAVEL_M`` in equal steps and pull back to the start."""
    lower = Block(side_m=9e-3, height_m=0.5e-3, cells=round(1.5 * cells), layers=1)
    upper = Block(side_m=5e-3, height_m=0.5e-3, cells=cells, layers=1, turned_deg=17.0)
    distance, stiffness = _CONTACT[contact]
    options = settings(contact, distance_m=distance, stiffness_pa=stiffness, friction=friction)
    pair = block_pair(lower, upper, neo_hookean(SHEAR_MODULUS_PA, 1e6), options, gap_m=distance + BEFORE_M)
    deep = BEFORE_M + PRESS_M
    down = [[0.0, 0.0, -z] for z in np.linspace(0.0, deep, 5)[1:]]
    there = TRAVEL_M * np.arange(1, steps + 1) / steps
    ways = [[x, 0.0, -deep] for x in (*there, *there[-2::-1], 0.0)]
    states = drive(pair, np.array(down + ways))[len(down) - 1 :]
    force = np.array([s.force_n for s in states])
    return Loop(
        moved_m=np.array([s.moved_m[0] for s in states]),
        tangential_n=force[:, 0],
        normal_n=-force[:, 2],
        forward=steps + 1,
        dofs=len(pair.model.free),
        iterations=sum(s.iterations for s in states),
    )


def sliding(friction: float, *, contact: str = "segments", steps: int = 8) -> Row:
    """Return T / N of gross sliding, half the difference of both ways, against the coefficient.

    The difference takes out the conservative force of facets passing over facets, which changes sign from place to
    place but not with the direction of motion.
    """
    loop = sliding_loop(friction, contact=contact, steps=steps)
    there, back = loop.sliding
    return Row(
        problem=f"block on a frictional plane, mu {friction:g}, {contact}",
        formulation="P2/P0",
        dofs=loop.dofs,
        quantity="tangential over normal force, sliding",
        figure=0.5 * (there - back),
        exact=friction,
    )
