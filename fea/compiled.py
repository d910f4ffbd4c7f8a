"""Whether and how elements are assembled by compiled kernels: numba where it is installed, NumPy everywhere else.

A law runs compiled if its type is one the kernels know, exactly: a subclass or a wrapper may compute anything, so it
goes the NumPy way.
"""

import importlib.util
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fea.arrays import F64, I64
from fea.laws import IsochoricOgden, Law, StVenantKirchhoff
from fea.ranges import all_ranges
from fea.rubber import ClosedNeoHookean, PointwiseVolume

_LAYOUT: tuple[Literal["C", "W"], ...] = ("C", "W")
_ELEMENTS = 256  # elements a task: some milliseconds, many tasks a thread so that none waits long for another


def kernel_name() -> str:
    """Return what assembles elements here, for provenance."""
    return "numba" if importlib.util.find_spec("numba") is not None else "NumPy"


@dataclass(frozen=True, kw_only=True, eq=False)
class CompiledLaw:
    """A law as the kernels take it.

    Attributes
    ----------
    kind : int
        One of the constants of :mod:`fea.kernels`.
    parameters : array
        Bulk moduli of the element-mean and the pointwise volumetric energy [Pa], then the law's own numbers.
    """

    kind: int
    parameters: F64

    def fill(
        self, u_m: F64, elements: I64, members: I64, shapes: tuple[F64, F64], force: F64, upper: F64 | None
    ) -> bool:
        """Fill the members' rows of ``force`` [n_elements, m, 3] and ``upper`` [n_elements, 3m (3m + 1) / 2].

        ``shapes`` holds gradients and weights (:func:`fea.assembly.element_gradients`), ``u_m`` is [n_nodes, 3]. Only
        forces are computed if ``upper`` is None. False where det F <= 0.
        """
        from fea.kernels import element_batch  # noqa: PLC0415 - optional dependency

        target = np.empty((0, 0)) if upper is None else upper
        # one layout, hence one compilation: elements come transposed from scikit-fem
        u_m, elements = np.require(u_m, np.float64, _LAYOUT), np.require(elements, np.int64, _LAYOUT)

        def work(start: int, stop: int) -> bool:
            return element_batch(
                self.kind,
                self.parameters,
                u_m,
                elements,
                members[start:stop],
                *shapes,
                upper is not None,
                force,
                target,
            )

        return all_ranges(work, len(members), _ELEMENTS)


def compiled_law(law: Law) -> CompiledLaw | None:
    """Return the law for the kernels (numba must be installed), or None for a type they do not know."""
    from fea import kernels  # noqa: PLC0415 - optional dependency

    inner, point_bulk = law, 0.0
    if type(law) is PointwiseVolume:
        inner, point_bulk = law.law, law.point_bulk_modulus_pa
    own: tuple[float, ...]
    if type(inner) is IsochoricOgden:
        kind, own = kernels.OGDEN, (*inner.coefficients_pa, *inner.exponents)
    elif type(inner) is StVenantKirchhoff:
        kind, own = kernels.ST_VENANT_KIRCHHOFF, (inner.lame_pa, inner.shear_modulus_pa)
    elif type(inner) is ClosedNeoHookean:
        kind, own = kernels.NEO_HOOKEAN, (inner.shear_modulus_pa,)
    else:
        return None
    return CompiledLaw(kind=kind, parameters=np.array([inner.bulk_modulus_pa, point_bulk, *own]))
