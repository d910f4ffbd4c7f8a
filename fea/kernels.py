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

from fea.arrays import F64, I32, I64

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
def element_batch(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
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
    nodal, rank = np.empty((m, 3)), np.empty((m, 3))
    F, dets = np.empty((points, 3, 3)), np.empty(points)
    cofactor, P, A = np.empty(9), np.empty(9), np.empty((9, 9))
    work = np.empty((21, 9))
    inner, K = np.empty((3, 9 * m)), np.empty((m, 9 * m))
    for index in range(members.shape[0]):
        e = members[index]
        for a in range(m):
            for i in range(3):
                nodal[a, i] = u_m[elements[e, a], i]
        volume, dilated = 0.0, 0.0
        for q in range(points):
            dets[q] = _deformation(nodal, gradients[e, q], F[q])
            if not dets[q] > 0.0:
                return False
            volume += weights[e, q]
            dilated += weights[e, q] * dets[q]
        mean_pressure = parameters[0] * (dilated / volume - 1.0)
        force[e] = 0.0
        rank[:] = 0.0
        K[:] = 0.0
        for q in range(points):
            _cofactor(F[q], cofactor)
            _law(kind, parameters, F[q], cofactor, dets[q], tangent, P, A, work)
            pressure = mean_pressure + parameters[1] * (dets[q] - 1.0)
            if pressure != 0.0 or parameters[1] > 0.0:
                _add_volumetric(F[q], cofactor, pressure, parameters[1], tangent, P, A)
            _add_flux(gradients[e, q], weights[e, q], P, force[e])
            if tangent:
                _add_flux(gradients[e, q], weights[e, q], cofactor, rank)
                _add_stiffness(gradients[e, q], weights[e, q], A, work, inner, K)
        if tangent:
            _write_upper(K, rank, parameters[0] / volume, upper[e])
    return True


@_compiled
def gather(values: F64, order: I32, pointer: I64, start: int, stop: int, out: F64) -> None:
    """Fill ``out[s]`` with the sum of ``values[order[pointer[s]:pointer[s + 1]]]`` for s in [start, stop)."""
    for s in range(start, stop):
        total = 0.0
        for k in range(pointer[s], pointer[s + 1]):
            total += values[order[k]]
        out[s] = total


@_compiled
def _deformation(nodal: F64, gradients: F64, F: F64) -> float:
    """Write F = I + du/dX of one point; return det F."""
    for i in range(3):
        for J in range(3):
            total = 0.0
            for a in range(nodal.shape[0]):
                total += nodal[a, i] * gradients[a, J]
            F[i, J] = total
        F[i, i] += 1.0
    det: float = (
        F[0, 0] * (F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1])
        - F[0, 1] * (F[1, 0] * F[2, 2] - F[1, 2] * F[2, 0])
        + F[0, 2] * (F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0])
    )
    return det


@_compiled
def _cofactor(F: F64, cofactor: F64) -> None:
    """Write dJ/dF [9]."""
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for J in range(3):
            J1, J2 = (J + 1) % 3, (J + 2) % 3
            cofactor[3 * i + J] = F[i1, J1] * F[i2, J2] - F[i1, J2] * F[i2, J1]


@_compiled
def _add_flux(gradients: F64, w: float, P: F64, force: F64) -> None:
    """Add w P_iJ G_aJ to force[a, i]."""
    for a in range(force.shape[0]):
        g0, g1, g2 = w * gradients[a, 0], w * gradients[a, 1], w * gradients[a, 2]
        for i in range(3):
            force[a, i] += P[3 * i] * g0 + P[3 * i + 1] * g1 + P[3 * i + 2] * g2


@_compiled
def _add_stiffness(gradients: F64, w: float, A: F64, work: F64, inner: F64, K: F64) -> None:
    """Add w G_aJ A_iJjL G_bL to K[a, (b, i, j)] for nodes b >= a: one long contiguous row per a."""
    m = K.shape[0]
    for J in range(3):
        for L in range(3):
            for i in range(3):
                for j in range(3):
                    work[3 * J + L, 3 * i + j] = A[3 * i + J, 3 * j + L]
    for J in range(3):
        for b in range(m):
            g0, g1, g2 = gradients[b, 0], gradients[b, 1], gradients[b, 2]
            for k in range(9):
                inner[J, 9 * b + k] = work[3 * J, k] * g0 + work[3 * J + 1, k] * g1 + work[3 * J + 2, k] * g2
    for a in range(m):
        g0, g1, g2 = w * gradients[a, 0], w * gradients[a, 1], w * gradients[a, 2]
        # views that start at 0: the compiler sees indices that cannot be negative and uses vector instructions
        row, i0, i1, i2 = K[a, 9 * a :], inner[0, 9 * a :], inner[1, 9 * a :], inner[2, 9 * a :]
        for k in range(row.shape[0]):
            row[k] += g0 * i0[k] + g1 * i1[k] + g2 * i2[k]


@_compiled
def _write_upper(K: F64, rank: F64, factor: float, upper: F64) -> None:
    """Add the rank-one term of the mean dilatation and write rows of the upper triangle in (node, component) order."""
    m = K.shape[0]
    position = 0
    for a in range(m):
        for i in range(3):
            scaled = factor * rank[a, i]
            for j in range(i, 3):
                upper[position] = K[a, 9 * a + 3 * i + j] + scaled * rank[a, j]
                position += 1
            for b in range(a + 1, m):
                for j in range(3):
                    upper[position] = K[a, 9 * b + 3 * i + j] + scaled * rank[b, j]
                    position += 1


@_compiled
def _add_volumetric(F: F64, cofactor: F64, pressure: float, bulk: float, tangent: bool, P: F64, A: F64) -> None:
    """Add p g to P and p dg/dF + bulk g x g to A, with the cofactor g = dJ/dF."""
    for row in range(9):
        P[row] += pressure * cofactor[row]
    if not tangent:
        return
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for J in range(3):
            J1, J2 = (J + 1) % 3, (J + 2) % 3
            row = 3 * i + J
            A[row, 3 * i1 + J1] += pressure * F[i2, J2]
            A[row, 3 * i2 + J2] += pressure * F[i1, J1]
            A[row, 3 * i1 + J2] -= pressure * F[i2, J1]
            A[row, 3 * i2 + J1] -= pressure * F[i1, J2]
    for row in range(9):
        for k in range(9):
            A[row, k] += bulk * cofactor[row] * cofactor[k]


@_compiled
def _law(  # noqa: PLR0913, PLR0917 - a compiled function takes arrays, not objects
    kind: int, parameters: F64, F: F64, cofactor: F64, J: float, tangent: bool, P: F64, A: F64, work: F64
) -> None:
    """Write P [9] and, if asked for, A [9, 9] of the law of this kind; ``work`` is scratch [21, 9]."""
    if kind == OGDEN:
        _ogden(parameters, F, tangent, P, A, work)
    elif kind == ST_VENANT_KIRCHHOFF:
        _st_venant_kirchhoff(parameters, F, P, work)
        if tangent:
            _st_venant_kirchhoff_tangent(parameters, F, A, work)
    else:
        _neo_hookean(parameters, F, cofactor, J, P, work)
        if tangent:
            _neo_hookean_tangent(P, A, work)


@_compiled
def _ogden(parameters: F64, F: F64, tangent: bool, P: F64, A: F64, work: F64) -> None:
    """Isochoric Ogden law; ``parameters[2:]`` are coefficients, then exponents (:class:`fea.laws.IsochoricOgden`).

    In the principal frame N_a of C with n_a = F N_a: P = sum S_a n_a N_a, and A is the sum of D_ab (n_a N_a)(n_b N_b),
    of gamma_ab s_ab s_ab over the three pairs with s_ab = n_a N_b + n_b N_a, and of delta_ij S_JL.
    """
    squared, strain, tau, S = work[12], work[13], work[14], work[15]
    D, gamma, N, n = work[17], work[18], work[19], work[20]
    _principal_frame(F, squared, N)
    for a in range(3):
        strain[a] = 0.5 * math.log(squared[a])
    _ogden_principal(parameters, strain, tangent, tau, D, gamma, work[16])
    for i in range(3):
        for a in range(3):
            n[3 * i + a] = F[i, 0] * N[a] + F[i, 1] * N[3 + a] + F[i, 2] * N[6 + a]
    for a in range(3):
        S[a] = tau[a] / squared[a]
        for i in range(3):
            for J in range(3):
                work[a, 3 * i + J] = n[3 * i + a] * N[3 * J + a]
    for k in range(9):
        P[k] = S[0] * work[0, k] + S[1] * work[1, k] + S[2] * work[2, k]
    if tangent:
        # from logarithmic strain to Green strain
        for a in range(3):
            b = (a + 1) % 3
            D[4 * a] = (D[4 * a] - 2.0 * tau[a]) / (squared[a] * squared[a])
            D[3 * a + b] /= squared[a] * squared[b]
            D[3 * b + a] = D[3 * a + b]
            gamma[a] = (gamma[a] - 0.5 * (tau[a] + tau[b])) / (squared[a] * squared[b])
        _spectral_tangent(D, gamma, S, A, work)


@_compiled
def _ogden_principal(parameters: F64, strain: F64, tangent: bool, tau: F64, D: F64, slope: F64, power: F64) -> None:
    """Write tau_a, d tau_a / d e_b (on and above the cyclic diagonal) and (tau_b - tau_a) / (2 tanh(e_b - e_a))."""
    terms = (parameters.shape[0] - 2) // 2
    mean = (strain[0] + strain[1] + strain[2]) / 3.0
    D[:] = 0.0
    tau[:] = 0.0
    slope[:] = 0.0
    for term in range(terms):
        c, alpha = parameters[2 + term], parameters[2 + terms + term]
        for a in range(3):
            power[a] = math.exp(alpha * (strain[a] - mean))
        average = (power[0] + power[1] + power[2]) / 3.0
        for a in range(3):
            b = (a + 1) % 3
            tau[a] += c * alpha * (power[a] - average)
            if tangent:
                stiffness = c * alpha * alpha
                D[4 * a] += stiffness * (power[a] + average) / 3.0
                D[3 * a + b] -= stiffness * (power[a] + power[b] - average) / 3.0
                slope[a] += stiffness * _mean_power(power[a], power[b], 0.5 * alpha * (strain[b] - strain[a]))
    for a in range(3):
        slope[a] *= 0.5 * _over_tanh(strain[(a + 1) % 3] - strain[a])


@_compiled
def _spectral_tangent(D: F64, gamma: F64, S: F64, A: F64, work: F64) -> None:
    """Write A from the dyads n_a N_a in ``work[:3]`` and the frames N, n in ``work[19:]``."""
    N, n = work[19], work[20]
    for a in range(3):
        b = (a + 1) % 3
        for i in range(3):
            for J in range(3):
                work[3 + a, 3 * i + J] = n[3 * i + a] * N[3 * J + b] + n[3 * i + b] * N[3 * J + a]
        for k in range(9):
            work[6 + a, k] = D[3 * a] * work[0, k] + D[3 * a + 1] * work[1, k] + D[3 * a + 2] * work[2, k]
            work[9 + a, k] = gamma[a] * work[3 + a, k]
    for row in range(9):
        t0, t1, t2 = work[0, row], work[1, row], work[2, row]
        s0, s1, s2 = work[3, row], work[4, row], work[5, row]
        for k in range(9):
            normal = t0 * work[6, k] + t1 * work[7, k] + t2 * work[8, k]
            A[row, k] = normal + s0 * work[9, k] + s1 * work[10, k] + s2 * work[11, k]
    for J in range(3):
        for L in range(3):
            stress = S[0] * N[3 * J] * N[3 * L]
            stress += S[1] * N[3 * J + 1] * N[3 * L + 1] + S[2] * N[3 * J + 2] * N[3 * L + 2]
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
def _st_venant_kirchhoff(parameters: F64, F: F64, P: F64, work: F64) -> None:
    """S = lambda tr(E) I + 2 mu E with ``parameters[2:]`` = (lambda, mu) (:class:`fea.laws.StVenantKirchhoff`)."""
    lame, mu, S, left = parameters[2], parameters[3], work[0], work[1]
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


@_compiled
def _st_venant_kirchhoff_tangent(parameters: F64, F: F64, A: F64, work: F64) -> None:
    """Write A; S and mu F F^T are in ``work``."""
    lame, mu, S, left = parameters[2], parameters[3], work[0], work[1]
    for i in range(3):
        for J in range(3):
            row = 3 * i + J
            for j in range(3):
                for L in range(3):
                    A[row, 3 * j + L] = lame * F[i, J] * F[j, L] + mu * F[i, L] * F[j, J]
            for k in range(3):
                A[row, 3 * i + k] += S[3 * J + k]
                A[row, 3 * k + J] += left[3 * i + k]


@_compiled
def _neo_hookean(parameters: F64, F: F64, cofactor: F64, J: float, P: F64, work: F64) -> None:
    """Isochoric neo-Hookean law with ``parameters[2]`` = mu (:class:`fea.rubber.ClosedNeoHookean`)."""
    G, flat = work[0], work[1]
    first = 0.0
    for i in range(3):
        for K in range(3):
            G[3 * i + K] = cofactor[3 * i + K] / J
            flat[3 * i + K] = F[i, K]
            first += F[i, K] * F[i, K]
    m = parameters[2] * J ** (-2.0 / 3.0)
    for k in range(9):
        P[k] = m * (flat[k] - first / 3.0 * G[k])
    work[2, 0], work[2, 1] = m, m * first / 3.0


@_compiled
def _neo_hookean_tangent(P: F64, A: F64, work: F64) -> None:
    """Write A; F^-T, F and the two moduli are in ``work``."""
    G, flat, m, scale = work[0], work[1], work[2, 0], work[2, 1]
    for row in range(9):
        for k in range(9):
            A[row, k] = -2.0 / 3.0 * (P[row] * G[k] + m * G[row] * flat[k])
        A[row, row] += m
    for i in range(3):
        for j in range(3):
            for K in range(3):
                for L in range(3):
                    A[3 * i + K, 3 * j + L] += scale * G[3 * i + L] * G[3 * j + K]
