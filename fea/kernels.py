"""Compiled element forces and stiffness: laws of known types, one element after another, no temporary arrays.

The same formulas as :func:`fea.assembly.element_forces` and :mod:`fea.laws`, which stay the reference, written as
loops. Imported only where numba is installed. Everything that calls another kernel lives in this one file, since
numba's cache of a function notices changes of that function's own file alone. Kernels release Python's lock and have
no threads of their own; :mod:`fea.compiled` runs them on disjoint ranges.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numpy as np

from fea.arrays import F64, I64

OGDEN, ST_VENANT_KIRCHHOFF, NEO_HOOKEAN = 0, 1, 2
_SWEEPS = 30  # of Jacobi's method, which needs four to six
_SERIES_BELOW = 0.3  # six terms of sinh(x)/x are exact to rounding here

_Function = TypeVar("_Function", bound=Callable[..., Any])


def _compiled(function: _Function) -> _Function:
    """Compile on first use and keep the machine code on disk, or in memory where no cache folder is writable."""
    options = {"nogil": True, "error_model": "numpy"}
    try:
        kernel: _Function = numba.njit(cache=True, **options)(function)
    except RuntimeError:
        kernel = numba.njit(**options)(function)
    return kernel


@_compiled
def element_batch(  # noqa: PLR0913 - a compiled function takes arrays, not objects
    kind: int,
    parameters: F64,
    u_m: F64,
    elements: I64,
    members: I64,
    gradients: F64,
    weights: F64,
    tangent: bool,
    force: F64,
    upper: F64,
) -> bool:
    """Fill ``force[e]`` [m, 3] and ``upper[e]`` for elements e of ``members``; False where det F <= 0.

    ``parameters`` starts with the bulk moduli of the element-mean and of the pointwise volumetric energy, then the
    law's own numbers. Without ``tangent``, ``upper`` is left alone.
    """
    points, m = weights.shape[1], elements.shape[1]
    mean_bulk, point_bulk = parameters[0], parameters[1]
    nodal, rank = np.empty((m, 3)), np.empty((m, 3))
    deformations, dets = np.empty((points, 3, 3)), np.empty(points)
    cofactor, P, A = np.zeros(9), np.empty(9), np.empty((9, 9))
    work = np.empty((21, 9))
    inner, K = np.empty((3, 9 * m)), np.empty((m, 9 * m))
    for index in range(members.shape[0]):
        e = members[index]
        for a in range(m):
            for i in range(3):
                nodal[a, i] = u_m[elements[e, a], i]
        volume, dilated = 0.0, 0.0
        for q in range(points):
            dets[q] = _deformation(nodal, gradients, e, q, deformations)
            if not dets[q] > 0.0:
                return False
            volume += weights[e, q]
            dilated += weights[e, q] * dets[q]
        mean_pressure = mean_bulk * (dilated / volume - 1.0)
        force[e] = 0.0
        rank[:] = 0.0
        K[:] = 0.0
        for q in range(points):
            w, F = weights[e, q], deformations[q]
            if kind == OGDEN:
                _ogden(parameters, F, tangent, P, A, work)
            elif kind == ST_VENANT_KIRCHHOFF:
                _st_venant_kirchhoff(parameters, F, tangent, P, A, work)
            else:
                _neo_hookean(parameters, F, dets[q], tangent, P, A, work)
            if mean_bulk > 0.0 or point_bulk > 0.0:
                pressure = mean_pressure + point_bulk * (dets[q] - 1.0)
                _volumetric(F, pressure, point_bulk, tangent, cofactor, P, A)
            for a in range(m):
                for i in range(3):
                    total, mean = 0.0, 0.0
                    for J in range(3):
                        total += P[3 * i + J] * gradients[e, q, a, J]
                        mean += cofactor[3 * i + J] * gradients[e, q, a, J]
                    force[e, a, i] += w * total
                    rank[a, i] += w * mean
            if tangent:
                _add_stiffness(gradients, e, q, w, A, inner, K)
        if tangent:
            _write_upper(K, rank, mean_bulk / volume, upper, e)
    return True


@_compiled
def gather(values: F64, order: I64, pointer: I64, start: int, stop: int, out: F64) -> None:
    """Fill ``out[s]`` with the sum of ``values[order[pointer[s]:pointer[s + 1]]]`` for s in [start, stop)."""
    for s in range(start, stop):
        total = 0.0
        for k in range(pointer[s], pointer[s + 1]):
            total += values[order[k]]
        out[s] = total


@_compiled
def _deformation(nodal: F64, gradients: F64, e: int, q: int, deformations: F64) -> float:
    """Write F = I + du/dX of point q; return det F."""
    F = deformations[q]
    for i in range(3):
        for J in range(3):
            total = 0.0
            for a in range(nodal.shape[0]):
                total += nodal[a, i] * gradients[e, q, a, J]
            F[i, J] = total
        F[i, i] += 1.0
    return (
        F[0, 0] * (F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1])
        - F[0, 1] * (F[1, 0] * F[2, 2] - F[1, 2] * F[2, 0])
        + F[0, 2] * (F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0])
    )


@_compiled
def _add_stiffness(gradients: F64, e: int, q: int, w: float, A: F64, inner: F64, K: F64) -> None:
    """Add w G_aJ A_iJjL G_bL to K[a, (b, i, j)] for nodes b >= a: one long contiguous row per a."""
    m = K.shape[0]
    for J in range(3):
        for b in range(m):
            g0, g1, g2 = gradients[e, q, b, 0], gradients[e, q, b, 1], gradients[e, q, b, 2]
            for i in range(3):
                for j in range(3):
                    row, column = 3 * i + J, 3 * j
                    inner[J, 9 * b + 3 * i + j] = (
                        A[row, column] * g0 + A[row, column + 1] * g1 + A[row, column + 2] * g2
                    )
    for a in range(m):
        g0, g1, g2 = w * gradients[e, q, a, 0], w * gradients[e, q, a, 1], w * gradients[e, q, a, 2]
        for k in range(9 * a, 9 * m):
            K[a, k] += g0 * inner[0, k] + g1 * inner[1, k] + g2 * inner[2, k]


@_compiled
def _write_upper(K: F64, rank: F64, factor: float, upper: F64, e: int) -> None:
    """Add the rank-one term of the mean dilatation and write rows of the upper triangle in (node, component) order."""
    m = K.shape[0]
    position = 0
    for a in range(m):
        for i in range(3):
            scaled = factor * rank[a, i]
            for j in range(i, 3):
                upper[e, position] = K[a, 9 * a + 3 * i + j] + scaled * rank[a, j]
                position += 1
            for b in range(a + 1, m):
                for j in range(3):
                    upper[e, position] = K[a, 9 * b + 3 * i + j] + scaled * rank[b, j]
                    position += 1


@_compiled
def _volumetric(F: F64, pressure: float, bulk: float, tangent: bool, cofactor: F64, P: F64, A: F64) -> None:
    """Add p g to P and p dg/dF + bulk g x g to A, with the cofactor g = dJ/dF, which is returned too."""
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for J in range(3):
            J1, J2 = (J + 1) % 3, (J + 2) % 3
            row = 3 * i + J
            cofactor[row] = F[i1, J1] * F[i2, J2] - F[i1, J2] * F[i2, J1]
            P[row] += pressure * cofactor[row]
            if tangent:
                A[row, 3 * i1 + J1] += pressure * F[i2, J2]
                A[row, 3 * i2 + J2] += pressure * F[i1, J1]
                A[row, 3 * i1 + J2] -= pressure * F[i2, J1]
                A[row, 3 * i2 + J1] -= pressure * F[i1, J2]
    if tangent and bulk > 0.0:
        for row in range(9):
            for column in range(9):
                A[row, column] += bulk * cofactor[row] * cofactor[column]


@_compiled
def _ogden(parameters: F64, F: F64, tangent: bool, P: F64, A: F64, work: F64) -> None:
    """Isochoric Ogden law; ``parameters[2:]`` are coefficients, then exponents (:class:`fea.laws.IsochoricOgden`).

    In the principal frame N_a of C with n_a = F N_a: P = sum S_a n_a N_a, and A is the sum of D_ab (n_a N_a)(n_b N_b),
    of gamma_ab s_ab s_ab over the three pairs with s_ab = n_a N_b + n_b N_a, and of delta_ij S_JL.
    """
    squared, strain, tau, S, power = work[12], work[13], work[14], work[15], work[16]
    D, slope, N, n = work[17], work[18], work[19], work[20]
    _principal_frame(F, squared, N)
    terms = (parameters.shape[0] - 2) // 2
    D[:] = 0.0
    tau[:] = 0.0
    slope[:] = 0.0
    for a in range(3):
        strain[a] = 0.5 * math.log(squared[a])
    mean = (strain[0] + strain[1] + strain[2]) / 3.0
    for term in range(terms):
        c, alpha = parameters[2 + term], parameters[2 + terms + term]
        for a in range(3):
            power[a] = math.exp(alpha * (strain[a] - mean))
        average = (power[0] + power[1] + power[2]) / 3.0
        for a in range(3):
            tau[a] += c * alpha * (power[a] - average)
        if tangent:
            stiffness = c * alpha * alpha
            for a in range(3):
                b = (a + 1) % 3
                D[4 * a] += stiffness * (power[a] + average) / 3.0
                D[3 * a + b] -= stiffness * (power[a] + power[b] - average) / 3.0
                slope[a] += stiffness * _mean_power(power[a], power[b], 0.5 * alpha * (strain[b] - strain[a]))
    for i in range(3):
        for a in range(3):
            n[3 * i + a] = F[i, 0] * N[a] + F[i, 1] * N[3 + a] + F[i, 2] * N[6 + a]
    for a in range(3):
        S[a] = tau[a] / squared[a]
        b = (a + 1) % 3
        for i in range(3):
            for J in range(3):
                work[a, 3 * i + J] = n[3 * i + a] * N[3 * J + a]
                work[3 + a, 3 * i + J] = n[3 * i + a] * N[3 * J + b] + n[3 * i + b] * N[3 * J + a]
    for k in range(9):
        P[k] = S[0] * work[0, k] + S[1] * work[1, k] + S[2] * work[2, k]
    if not tangent:
        return
    for a in range(3):
        b = (a + 1) % 3
        D[4 * a] = (D[4 * a] - 2.0 * tau[a]) / (squared[a] * squared[a])
        D[3 * a + b] /= squared[a] * squared[b]
        D[3 * b + a] = D[3 * a + b]
        shear = 0.5 * slope[a] * _over_tanh(strain[b] - strain[a]) - 0.5 * (tau[a] + tau[b])
        slope[a] = shear / (squared[a] * squared[b])
    for a in range(3):
        for k in range(9):
            work[6 + a, k] = D[3 * a] * work[0, k] + D[3 * a + 1] * work[1, k] + D[3 * a + 2] * work[2, k]
            work[9 + a, k] = slope[a] * work[3 + a, k]
    for row in range(9):
        for k in range(9):
            A[row, k] = (
                work[0, row] * work[6, k]
                + work[1, row] * work[7, k]
                + work[2, row] * work[8, k]
                + work[3, row] * work[9, k]
                + work[4, row] * work[10, k]
                + work[5, row] * work[11, k]
            )
    for J in range(3):
        for L in range(3):
            stress = (
                S[0] * N[3 * J] * N[3 * L] + S[1] * N[3 * J + 1] * N[3 * L + 1] + S[2] * N[3 * J + 2] * N[3 * L + 2]
            )
            for i in range(3):
                A[3 * i + J, 3 * i + L] += stress


@_compiled
def _mean_power(first: float, second: float, x: float) -> float:
    """Return sqrt(first second) sinh(x) / x, where second / first = exp(2 x)."""
    if abs(x) > _SERIES_BELOW:
        return (second - first) / (2.0 * x)
    y = x * x
    series = 1.0 + y / 6.0 * (1.0 + y / 20.0 * (1.0 + y / 42.0 * (1.0 + y / 72.0 * (1.0 + y / 110.0))))
    return math.sqrt(first * second) * series


@_compiled
def _over_tanh(x: float) -> float:
    """Return x / tanh(x)."""
    return 1.0 if abs(x) < 1e-8 else x / math.tanh(x)


@_compiled
def _principal_frame(F: F64, squared: F64, N: F64) -> None:
    """Write eigenvalues [3] and eigenvectors [9] (component, number) of F^T F by cyclic Jacobi rotations.

    Golub & Van Loan, Matrix Computations, section 8.5; accurate and orthonormal also where eigenvalues coincide.
    """
    N[:] = 0.0
    for a in range(3):
        N[4 * a] = 1.0
        squared[a] = F[0, a] * F[0, a] + F[1, a] * F[1, a] + F[2, a] * F[2, a]
        b = (a + 1) % 3
        # off-diagonal entry of the pair (a, a + 1)
        squared[3 + a] = F[0, a] * F[0, b] + F[1, a] * F[1, b] + F[2, a] * F[2, b]
    trace = squared[0] + squared[1] + squared[2]
    for _ in range(_SWEEPS):
        if abs(squared[3]) + abs(squared[4]) + abs(squared[5]) <= 1e-18 * trace:
            return
        for p in range(3):
            q, r = (p + 1) % 3, (p + 2) % 3
            off = squared[3 + p]
            if off == 0.0:
                continue
            theta = 0.5 * (squared[q] - squared[p]) / off
            t = math.copysign(1.0, theta) / (abs(theta) + math.sqrt(theta * theta + 1.0))
            c = 1.0 / math.sqrt(t * t + 1.0)
            s = t * c
            squared[p] -= t * off
            squared[q] += t * off
            squared[3 + p] = 0.0
            with_p, with_q = squared[3 + r], squared[3 + q]  # entries (r, p) and (q, r)
            squared[3 + r] = c * with_p - s * with_q
            squared[3 + q] = s * with_p + c * with_q
            for i in range(3):
                x, y = N[3 * i + p], N[3 * i + q]
                N[3 * i + p] = c * x - s * y
                N[3 * i + q] = s * x + c * y


@_compiled
def _st_venant_kirchhoff(parameters: F64, F: F64, tangent: bool, P: F64, A: F64, work: F64) -> None:
    """S = lambda tr(E) I + 2 mu E with ``parameters[2:]`` = (lambda, mu) (:class:`fea.laws.StVenantKirchhoff`)."""
    lame, mu = parameters[2], parameters[3]
    S, left = work[0], work[1]
    trace = -3.0
    for i in range(3):
        for J in range(3):
            trace += F[i, J] * F[i, J]
            S[3 * i + J] = mu * (F[0, i] * F[0, J] + F[1, i] * F[1, J] + F[2, i] * F[2, J])
            left[3 * i + J] = mu * (F[i, 0] * F[J, 0] + F[i, 1] * F[J, 1] + F[i, 2] * F[J, 2])
    for i in range(3):
        S[4 * i] += 0.5 * lame * trace - mu
    for i in range(3):
        for J in range(3):
            P[3 * i + J] = F[i, 0] * S[J] + F[i, 1] * S[3 + J] + F[i, 2] * S[6 + J]
            if not tangent:
                continue
            for j in range(3):
                for L in range(3):
                    value = lame * F[i, J] * F[j, L] + mu * F[i, L] * F[j, J]
                    if i == j:
                        value += S[3 * J + L]
                    if J == L:
                        value += left[3 * i + j]
                    A[3 * i + J, 3 * j + L] = value


@_compiled
def _neo_hookean(parameters: F64, F: F64, J: float, tangent: bool, P: F64, A: F64, work: F64) -> None:
    """Isochoric neo-Hookean law with ``parameters[2]`` = mu (:class:`fea.rubber.ClosedNeoHookean`)."""
    G, flat = work[0], work[1]
    first = 0.0
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for K in range(3):
            K1, K2 = (K + 1) % 3, (K + 2) % 3
            G[3 * i + K] = (F[i1, K1] * F[i2, K2] - F[i1, K2] * F[i2, K1]) / J
            flat[3 * i + K] = F[i, K]
            first += F[i, K] * F[i, K]
    m = parameters[2] * J ** (-2.0 / 3.0)
    for k in range(9):
        P[k] = m * (flat[k] - first / 3.0 * G[k])
    if not tangent:
        return
    for row in range(9):
        for k in range(9):
            A[row, k] = -2.0 / 3.0 * (P[row] * G[k] + m * G[row] * flat[k])
        A[row, row] += m
    scale = m * first / 3.0
    for i in range(3):
        for j in range(3):
            for K in range(3):
                for L in range(3):
                    A[3 * i + K, 3 * j + L] += scale * G[3 * i + L] * G[3 * j + K]
