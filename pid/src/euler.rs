//! pid: Euler angles by components (thesis Appendix B). In: angles and their rates. Out: matrices, body rates, and the way back.

/// Sines and cosines of three Euler angles, from which all else follows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sines([(f64, f64); 3]);

impl Sines {
    pub(crate) fn of(euler_rad: [f64; 3]) -> Self {
        Self(euler_rad.map(f64::sin_cos))
    }

    /// Body-to-tunnel matrix (eq. B.14).
    pub(crate) fn t_bef(&self) -> [[f64; 3]; 3] {
        let [(sx, cx), (sy, cy), (sz, cz)] = self.0;
        [
            [cz * cy, -sz * cy, sy],
            [cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -cy * sx],
            [sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx],
        ]
    }

    /// Its time derivative (eq. B.43).
    pub(crate) fn t_bef_rate(&self, [dx, dy, dz]: [f64; 3]) -> [[f64; 3]; 3] {
        let [(sx, cx), (sy, cy), (sz, cz)] = self.0;
        [
            [-dz * sz * cy - dy * cz * sy, -dz * cz * cy + dy * sz * sy, dy * cy],
            [
                dz * (cz * cx - sz * sy * sx) + dy * (cz * cy * sx) + dx * (cz * sy * cx - sz * sx),
                -dz * (cz * sy * sx + sz * cx) - dy * (sz * cy * sx) - dx * (sz * sy * cx + cz * sx),
                dy * sy * sx - dx * cy * cx,
            ],
            [
                dz * (sz * sy * cx + cz * sx) - dy * (cz * cy * cx) + dx * (cz * sy * sx + sz * cx),
                dz * (cz * sy * cx - sz * sx) + dy * (sz * cy * cx) - dx * (sz * sy * sx - cz * cx),
                -dy * sy * cx - dx * cy * sx,
            ],
        ]
    }

    /// Body rates and their derivatives from Euler rates (eqs 3.20-3.23).
    pub(crate) fn rates(&self, [dx, dy, dz]: [f64; 3], [ddx, ddy, ddz]: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let [_, (sy, cy), (sz, cz)] = self.0;
        let pqr = [cy * cz * dx + sz * dy, -cy * sz * dx + cz * dy, sy * dx + dz];
        let pqr_rate = [
            (-dy * sy * cz - dz * cy * sz) * dx + dz * cz * dy + cy * cz * ddx + sz * ddy,
            (dy * sy * sz - dz * cy * cz) * dx - dz * sz * dy - cy * sz * ddx + cz * ddy,
            dy * cy * dx + sy * ddx + ddz,
        ];
        (pqr, pqr_rate)
    }
}

/// Body-to-tunnel matrix of the Euler angles (eq. B.14).
pub(crate) fn t_bef(euler_rad: [f64; 3]) -> [[f64; 3]; 3] {
    Sines::of(euler_rad).t_bef()
}

/// Body rates and their derivatives from Euler angles and rates (eqs 3.20-3.23).
pub(crate) fn rates(euler_rad: [f64; 3], rate: [f64; 3], second: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    Sines::of(euler_rad).rates(rate, second)
}

/// Euler rates and second derivatives from body rates: [`rates`] the other way.
pub(crate) fn euler_rates([_, ry, rz]: [f64; 3], [p, q, r]: [f64; 3], [p_dot, q_dot, r_dot]: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let ((sy, cy), (sz, cz)) = (ry.sin_cos(), rz.sin_cos());
    let inverse = |p: f64, q: f64, r: f64| {
        let dx = (p * cz - q * sz) / cy;
        [dx, p * sz + q * cz, r - sy * dx]
    };
    let d = inverse(p, q, r);
    let (_, moving) = rates([0.0, ry, rz], d, [0.0; 3]);
    (d, inverse(p_dot - moving[0], q_dot - moving[1], r_dot - moving[2]))
}
