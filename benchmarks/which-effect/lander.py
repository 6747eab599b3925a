"""Equations of motion of the tethered lander: loads of the declared model and of every effect that is a number, and what they
leave of measured accelerations. Axes and signs as in the thesis' Appendix B with its errata; effects by `family.parameter`.
"""
import numpy as np
from reader import rotation

PARAMETERS = ("CA_T0", "CN_sin", "CN_sin3", "Cl_0", "Cl_p", "Cm_sin", "Cm_sin3", "Cm_1", "Cm_2", "Cn_1", "Cn_2", "Cn_sin", "Cn_sin3")
SPEED_M_S = 7.5
SWIVEL_RAD_S = 0.05


def turn(r, v):
    return np.einsum("nij,nj->ni", r, v)


def back(r, v):
    return np.einsum("nji,nj->ni", r, v)


class Knobs(dict):
    """Effects by `family.parameter`; what is not there is zero."""

    def __missing__(self, key):
        return 0.0

    def vector(self, family, names):
        return np.array([self[f"{family}.{n}"] for n in names])


def inertia(veh, k):
    names = ("xx", "yy", "zz", "xy", "xz", "yz")
    xx, yy, zz, xy, xz, yz = (k[f"inertia.{n}_kg_m2"] for n in names)
    return veh.inertia + np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])


def wind(x, v, vw, vw1, k):
    """Air velocity and its rate along the path, tunnel axes."""
    (y, z), (vy, vz) = x[:, 1:].T, v[:, 1:].T
    bowl, gy, gz = k.vector("flow-profile", ("bowl_per_m2", "tilt_y_per_m", "tilt_z_per_m"))
    ay, az, s = k["cross-flow.y_rad"], k["cross-flow.z_rad"], k["swirl.rad_per_m"]
    shape = 1 + bowl * (y * y + z * z) + gy * y + gz * z
    shape1 = 2 * bowl * (y * vy + z * vz) + gy * vy + gz * vz
    ly, lz = ay - s * z, az + s * y
    gust = k.vector("gust", "xyz").T
    # Lateral flow follows the tunnel's speed, or stays as it is.
    side, side1 = (SPEED_M_S + 0 * vw, 0 * vw) if k["cross-flow.steady"] or k["swirl.steady"] else (vw, vw1)
    air = np.stack([-vw * shape, side * ly, side * lz], axis=1) + gust
    rate = np.stack([-vw1 * shape - vw * shape1, side1 * ly - side * s * vz, side1 * lz + side * s * vy], axis=1)
    return air, rate


def aerodynamics(theta, u, u1, w, d, k):
    """Coefficients C_A, C_Y, C_N, C_l, C_m, C_n about the origin."""
    p = dict(zip(PARAMETERS, theta))
    speed = np.linalg.norm(u, axis=1)
    along, y, z = (u / speed[:, None]).T
    s2, hat = y * y + z * z, d / (2 * speed)
    ph, qh, rh = (w * hat[:, None]).T
    plane2 = u[:, 0] ** 2 + u[:, 2] ** 2
    alpha, beta = np.arctan2(u[:, 2], u[:, 0]), np.arcsin(y)
    alpha1 = (u[:, 0] * u1[:, 2] - u1[:, 0] * u[:, 2]) / plane2
    beta1 = (u1[:, 1] - y * (u * u1).sum(axis=1) / speed) / np.sqrt(plane2)
    pitch, yaw = (w[:, 1] + alpha1) * hat / 2, (w[:, 2] - beta1) * hat / 2
    total = np.arctan2(np.sqrt(s2), along)
    ca = p["CA_T0"] * along + k["axial-shape.CA_sin2"] * s2 + k["axial-shape.CA_sin4"] * s2**2
    ca = ca + k["axial-speed.CA_speed"] * (speed / SPEED_M_S - 1) * along
    cn = p["CN_sin"] + p["CN_sin3"] * s2
    rate, side = k["rate-force.CN_q"], k["magnus.CY_p_alpha"]
    cy_, cn_ = -cn * y + k["asymmetry.CY_0"] + rate * rh + side * ph * z, cn * z + k["asymmetry.CN_0"] + rate * qh + side * ph * y
    cl = p["Cl_0"] + ph * (p["Cl_p"] + k["roll-damping-shape.Cl_p_sin2"] * s2 + k["roll-damping-shape.Cl_p_abs_p"] * abs(ph))
    clock = k["roll-periodic.harmonic"] * np.arctan2(y, z)
    wave = k["roll-periodic.Cm_cos"] * np.cos(clock) + k["roll-periodic.Cm_sin"] * np.sin(clock)
    bump = k["damping-shape.bump"] / np.cosh(total / (k["damping-shape.width_rad"] or 1.0)) ** 2
    mag = k["magnus.Cn_p_alpha"] * ph
    cm = (p["Cm_sin"] + p["Cm_sin3"] * s2 + wave) * z + (p["Cm_1"] + p["Cm_2"] * alpha**2 + bump) * pitch
    cn2 = -(p["Cn_sin"] + p["Cn_sin3"] * s2 + wave) * y + (p["Cn_1"] + p["Cn_2"] * beta**2 + bump) * yaw
    return np.stack([ca, cy_, cn_, cl, cm + k["asymmetry.Cm_0"] + mag * y, cn2 + k["asymmetry.Cn_0"] + mag * z], axis=1)


def tether(veh, x, r, v, w, q, cm, k):
    """Pull on the line and its moment about the c.m., body axes; x and v are the c.m.'s."""
    arm = veh.hook + k.vector("hook", ("x_m", "y_m", "z_m")) - cm
    ring = veh.ring + k.vector("ring", ("x_m", "y_m", "z_m")) + [0, k["tether-geometry.ring_y_m"], k["tether-geometry.ring_z_m"]]
    to_ring = back(r, ring - x) - arm
    length = np.linalg.norm(to_ring, axis=1)
    direction = to_ring / length[:, None]
    rate = -(direction * (back(r, v) + np.cross(w, arm))).sum(axis=1)
    drag = veh.drag_area * (1 + k["tether-geometry.pull_excess"]) + k["tether-geometry.drag_m2"]
    weight = veh.line_weight * (1 + k["tether-geometry.weight_excess"]) + k["tether-geometry.weight_n"]
    nominal = np.linalg.norm(veh.ring) - np.linalg.norm(veh.hook)
    pull = (q * drag - weight) * (1 + k["tether-length.per_m"] * (length - nominal))
    if k["tether-line-rate.n_s_per_m"]:
        pull = np.maximum(pull + k["tether-line-rate.n_s_per_m"] * rate, np.minimum(pull, 0))
    f = direction * pull[:, None]
    swivel = -k["swivel-friction.torque_n_m"] * np.tanh(w[:, :1] / SWIVEL_RAD_S)
    return f, np.cross(arm, f) + swivel * [1.0, 0.0, 0.0]


def touch(t, number, k):
    """Force and moment of a pulse inside one run, body axes."""
    x = (t - k["contact.start_s"]) / max(k["contact.duration_s"], 1e-3)
    shape = np.where((x >= 0) & (x < 1) & (number == k["contact.run"]), 2 * np.sin(np.pi * x) ** 2, 0.0) / max(k["contact.duration_s"], 1e-3)
    f = k.vector("contact", ("impulse_x_n_s", "impulse_y_n_s", "impulse_z_n_s"))
    m = k.vector("contact", ("angular_x_n_m_s", "angular_y_n_m_s", "angular_z_n_m_s"))
    return shape[:, None] * f, shape[:, None] * m


def loads(veh, theta, k, t, number, x, r, v, w, vw, vw1, rho):
    """Specific force (N/kg) and angular acceleration of the c.m.'s motion that the model gives, body axes."""
    cm = veh.cm + k.vector("center-of-mass", ("x_m", "y_m", "z_m"))
    air, air1 = wind(x, v, vw, vw1, k)
    u = back(r, v - air)
    q = 0.5 * rho * (u * u).sum(axis=1)
    mass = veh.mass + k["mass.mass_kg"]
    pull, pull_moment = tether(veh, x, r, v, w, q, cm, k)
    hit, hit_moment = touch(t, number, k)
    air_mass = k.vector("apparent-mass", ("axial_kg", "radial_kg", "radial_kg"))
    weight = back(r, np.broadcast_to([veh.gravity, 0.0, 0.0], u.shape))
    rates = weight - back(r, air1) - np.cross(w, u)
    specific = np.zeros_like(u)
    # Damping and apparent mass need the acceleration that the force gives: a fixed point, near at once.
    for _ in range(4 if air_mass.any() else 2):
        u1 = specific + rates
        c = aerodynamics(theta, u, u1, w, veh.diameter, k)
        aero = (q * veh.area)[:, None] * np.stack([-c[:, 0], c[:, 1], -c[:, 2]], axis=1)
        specific = (aero + pull + hit - air_mass * u1 - np.cross(w, air_mass * u)) / mass
    m = (q * veh.area * veh.diameter)[:, None] * c[:, 3:] + np.cross(aero, cm) + pull_moment + hit_moment
    own, across = inertia(veh, k), np.diag([0.0, 1.0, 1.0]) * k["apparent-mass.transverse_kg_m2"]
    turning = own + across * (1 - k["apparent-mass.unturned"])
    return specific, (m - np.cross(u, air_mass * u) - np.cross(w, w @ turning.T)) @ np.linalg.inv(own + across).T


def small_turn(a):
    """Rotation Rx Ry Rz of constant small angles."""
    
    return rotation(np.array([a]))[0]


def euler_to_rates(e):
    """Matrix from Euler angle rates to body rates, and the three derivatives it needs."""
    (_, sy, sz), (_, cy, cz) = np.sin(e).T, np.cos(e).T
    zero, one = np.zeros_like(sy), np.ones_like(sy)
    m = np.moveaxis(np.array([[cy * cz, sz, zero], [-cy * sz, cz, zero], [sy, zero, one]]), -1, 0)
    dy = np.moveaxis(np.array([[-sy * cz, zero, zero], [sy * sz, zero, zero], [cy, zero, zero]]), -1, 0)
    dz = np.moveaxis(np.array([[-cy * sz, cz, zero], [-cy * cz, -sz, zero], [zero, zero, zero]]), -1, 0)
    return m, dy, dz


def residual(seg, veh, theta, k=None, inside=None):
    """Acceleration of the origin (m/s2) and angular acceleration (rad/s2) that the model leaves, body axes, (samples, 6): measured
    less model. Measured accelerations stand on the left alone, so that no column of a regression has their noise in it.

    `inside(seg, specific, w, w1)` may add to specific force and angular acceleration (a part that swings)."""
    k = Knobs(k or {})
    rate, size = 1 + k["time-base.rate"], 1 + k["length-scale.scale"]
    turned = small_turn(k.vector("pose-misalignment", ("x_rad", "y_rad", "z_rad")))
    cm = veh.cm + k.vector("center-of-mass", ("x_m", "y_m", "z_m"))
    r = rotation(seg.e[0]) @ turned.T
    m, dy, dz = euler_to_rates(seg.e[0])
    e1 = seg.e[1] * rate
    w = turn(m, e1) @ turned.T
    slide = turn(dy * e1[:, 1, None, None] + dz * e1[:, 2, None, None], e1)
    x, v = seg.x[0] / size + r @ cm, seg.x[1] * rate / size + turn(r, np.cross(w, cm))
    late = k["wind-delay.delay_s"] - k["pose-delay.delay_s"]
    vw, vw1 = (np.interp(seg.t + late, seg.t, c) for c in (seg.vw[0], seg.vw[1] * rate))
    vw, vw1 = vw / (1 + k["wind-scale.scale"]), vw1 / (1 + k["wind-scale.scale"])
    specific, w1 = loads(veh, theta, k, seg.t / rate, seg.number, x, r, v, w, vw, vw1, seg.rho)
    if inside:
        more = inside(seg, specific, w, w1)
        specific, w1 = specific + more[0], w1 + more[1]
    origin = turn(r, specific - np.cross(w1, cm) - np.cross(w, np.cross(w, cm))) + [veh.gravity, 0, 0]
    e2 = np.linalg.solve(m, (w1 @ turned - slide)[:, :, None])[:, :, 0]
    model = seg.lowpass(np.concatenate([origin * size, e2], axis=1) / rate**2)
    force = back(seg.thin(r), seg.thin(seg.x[2]) - model[:, :3])
    angular = turn(seg.thin(m), seg.thin(seg.e[2]) - model[:, 3:])
    return np.concatenate([force, angular], axis=1)


def expected_noise(seg):
    """Standard deviation of the six residuals that white noise of the measured size gives, by double differentiation."""
    return seg.noise_gain * seg.noise[:6]
