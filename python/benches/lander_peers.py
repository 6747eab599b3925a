"""Flights per core-second of a lander study as a Python user would write it: numpy, scipy, numba.

In: nothing. Out: a table on the terminal. By hand: `pip install numpy scipy numba`, then `python lander_peers.py`.
The same lander, release and tunnel speed as sim/benches/batch.rs: 30 s at 100 Hz. V_W is a formula here, a recorded history
there. One process, threads of numpy's libraries switched off. Best processor time of several; compilation is not counted.
"""
import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import math
import sys
import time

import numba
import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

MASS, IXX, IYY, IZZ, D, HOOK, RING = 0.7873, 0.02113, 0.0138, 0.01379, 0.2125, -0.25, -3.0
DRAG, WEIGHT, G, RHO = 0.0013006426, 0.01645842, 9.80665, 101325.0 / (287.05287 * 299.083649)
P = (6.6620, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289)
AREA = math.pi * D * D / 4
STEPS, H = 3000, 0.01


def equations(np_):
    """The right-hand side over `np_`: scalars for numba, arrays (13, flights) for numpy."""
    sqrt, atan2, sin, cos = np_.sqrt, np_.arctan2, np_.sin, np_.cos

    def rate(t, y):
        p0, p1, p2, v0, v1, v2, a, b, c, d, p, q, r = y
        vw = 7.43 + 0.12 * sin(0.9 * t) + 0.05 * sin(2.3 * t + 1.0) + 0.02 * cos(6.1 * t)
        vwr = 0.108 * cos(0.9 * t) + 0.115 * cos(2.3 * t + 1.0) - 0.122 * sin(6.1 * t)
        s = 2 / (a * a + b * b + c * c + d * d)
        m0, m1, m2 = 1 - s * (c * c + d * d), s * (b * c - a * d), s * (b * d + a * c)
        m3, m4, m5 = s * (b * c + a * d), 1 - s * (b * b + d * d), s * (c * d - a * b)
        m6, m7, m8 = s * (b * d - a * c), s * (c * d + a * b), 1 - s * (b * b + c * c)
        x = v0 + vw
        u, v, w = m0 * x + m3 * v1 + m6 * v2, m1 * x + m4 * v1 + m7 * v2, m2 * x + m5 * v1 + m8 * v2
        x = RING - p0
        ex, ey, ez = m0 * x - m3 * p1 - m6 * p2 - HOOK, m1 * x - m4 * p1 - m7 * p2, m2 * x - m5 * p1 - m8 * p2
        per = 1 / sqrt(ex * ex + ey * ey + ez * ez)
        speed2 = u * u + v * v + w * w
        speed = sqrt(speed2)
        sy, sz, s2 = v / speed, w / speed, (v * v + w * w) / speed2
        qs = 0.5 * RHO * speed2 * AREA
        cn = P[1] + P[2] * s2
        pull = (0.5 * RHO * speed2 * DRAG - WEIGHT) * per
        fx, fy, fz = -qs * P[0] * u / speed + pull * ex, -qs * cn * sy + pull * ey, -qs * cn * sz + pull * ez
        ax, ay, az = fx / MASS + G * m0, fy / MASS + G * m1, fz / MASS + G * m2
        ud, vd, wd = ax + vwr * m0 - (q * w - r * v), ay + vwr * m1 - (r * u - p * w), az + vwr * m2 - (p * v - q * u)
        uw2 = u * u + w * w
        uw = sqrt(uw2)
        alpha_d = (u * wd - ud * w) / uw2
        beta_d = (vd * uw2 - v * (u * ud + w * wd)) / (speed2 * uw)
        alpha, beta, hat = atan2(w, u), atan2(v, uw), 0.5 * D / speed
        cm, qsd = P[5] + P[6] * s2, qs * D
        ml = qsd * (P[3] + P[4] * p * hat)
        mm = qsd * (cm * sz + (P[7] + P[8] * alpha * alpha) * 0.5 * (q + alpha_d) * hat) - HOOK * pull * ez
        mn = qsd * (-cm * sy + (P[9] + P[10] * beta * beta) * 0.5 * (r - beta_d) * hat) + HOOK * pull * ey
        return (
            v0, v1, v2,
            (m0 * fx + m1 * fy + m2 * fz) / MASS + G, (m3 * fx + m4 * fy + m5 * fz) / MASS, (m6 * fx + m7 * fy + m8 * fz) / MASS,
            -0.5 * (b * p + c * q + d * r), 0.5 * (a * p + c * r - d * q), 0.5 * (a * q + d * p - b * r), 0.5 * (a * r + b * q - c * p),
            (ml + (IYY - IZZ) * q * r) / IXX, (mm + (IZZ - IXX) * r * p) / IYY, (mn + (IXX - IYY) * p * q) / IZZ,
        )  # fmt: skip

    return rate


def start():
    # Body to tunnel T = Rx Ry Rz, angles 0, 0.314, 0.305 rad.
    x, y, z, w = Rotation.from_euler("XYZ", [0.0, 0.314, 0.305]).as_quat()
    return np.array([0, 0, 0, 0, 0, 0, w, x, y, z, 0.2, 0.4, 0.0])


RATE_NUMPY = equations(np)
RATE_NUMBA = numba.njit(equations(np), error_model="numpy")


def rk4_numpy(y):
    """`y`: (13, flights). All flights in step."""
    states = np.empty((STEPS + 1, *y.shape))
    states[0] = y
    for n in range(STEPS):
        t = n * H
        k1 = np.array(RATE_NUMPY(t, y))
        k2 = np.array(RATE_NUMPY(t + H / 2, y + H / 2 * k1))
        k3 = np.array(RATE_NUMPY(t + H / 2, y + H / 2 * k2))
        k4 = np.array(RATE_NUMPY(t + H, y + H * k3))
        y = y + H / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states[n + 1] = y
    return states


@numba.njit(error_model="numpy")
def rk4_numba(y):
    states = np.empty((STEPS + 1, 13))
    states[0] = y
    z, total = np.empty(13), np.empty(13)
    for n in range(STEPS):
        for i in range(13):
            z[i], total[i] = y[i], y[i]
        for stage in range(4):
            ahead = 0.0 if stage == 0 else (0.5 if stage < 3 else 1.0)
            weight = 1.0 / 6.0 if stage in (0, 3) else 1.0 / 3.0
            nxt = 0.5 if stage < 2 else 1.0
            k = RATE_NUMBA((n + ahead) * H, (z[0], z[1], z[2], z[3], z[4], z[5], z[6], z[7], z[8], z[9], z[10], z[11], z[12]))
            for i, ki in enumerate(k):
                z[i] = y[i] + nxt * H * ki
                total[i] += weight * H * ki
        for i in range(13):
            y[i] = total[i]
        states[n + 1] = y
    return states


@numba.njit
def rate_for_scipy(t, y):
    return np.array(RATE_NUMBA(t, (y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8], y[9], y[10], y[11], y[12])))


def best(work, repetitions):
    work()
    times = []
    for _ in range(repetitions):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def main():
    y = start()
    t = np.arange(STEPS + 1) * H
    exact = solve_ivp(rate_for_scipy, (0, t[-1]), y, "DOP853", t, rtol=1e-12, atol=1e-14).y.T

    def scipy_(rate, method, rtol):
        return lambda: solve_ivp(rate, (0, t[-1]), y, method, t, rtol=rtol, atol=0.01 * rtol).y.T

    print(f"Python {sys.version.split()[0]}, numpy {np.__version__}, scipy {scipy.__version__}, numba {numba.__version__}")
    side = np.repeat(y[:, None], 256, axis=1)
    rows = [
        ("numpy, RK4 0.01 s, 256 flights as arrays", 256, lambda: rk4_numpy(side)[:, :, 0], 2),
        ("numba, RK4 0.01 s, scalar", 1, lambda: rk4_numba(y.copy()), 60),
        ("scipy RK45 1e-9, right-hand side by numba", 1, scipy_(rate_for_scipy, "RK45", 1e-9), 3),
        ("scipy DOP853 1e-9, right-hand side by numba", 1, scipy_(rate_for_scipy, "DOP853", 1e-9), 5),
        ("scipy DOP853 1e-9, right-hand side in Python", 1, scipy_(lambda t, y: np.array(RATE_NUMPY(t, y)), "DOP853", 1e-9), 1),
    ]
    for name, flights, work, repetitions in rows:
        error = np.abs(work() - exact).max()
        print(f"{name:46s} {flights / best(work, repetitions):9.1f} flights/s a core, error {error:.1e}")


if __name__ == "__main__":
    main()
