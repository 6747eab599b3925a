// The same model on boost::odeint, written by hand for speed: the peer of benches/dopri5.rs (dopri5) and benches/batch.rs (the
// classical Runge-Kutta method with a fixed step).
// In: a file of numbers (see read()). Out: nanoseconds of processor time per flight (best and mean), accepted steps, and the states at the samples.
//
// Usage: peer INPUT REPETITIONS STATES_OUT [dopri5 | rk4 | rk4-seen]
// The lander of thesis section 4.1.2 with its tether; V_W by the same piecewise quintic; dense output at the samples, and at
// each of them Euler angles, total angle of attack, airspeed and tether force. Building the quintic is inside the timing, as
// it is in the program's own flight.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <time.h>
#include <vector>

using State = std::array<double, 13>;
namespace odeint = boost::numeric::odeint;

struct Input {
    double rtol, atol, interval, mass, ixx, iyy, izz, diameter, hook_x, ring_x, drag_area, weight, gravity, density;
    std::array<double, 11> p;
    State start;
    std::vector<double> vw;
};

static double number(std::FILE* f) {
    double x;
    if (std::fscanf(f, "%lf", &x) != 1) std::exit(2);
    return x;
}

static Input read(const char* path) {
    std::FILE* f = std::fopen(path, "r");
    if (!f) std::exit(2);
    Input in;
    for (double* x : {&in.rtol, &in.atol, &in.interval, &in.mass, &in.ixx, &in.iyy, &in.izz, &in.diameter, &in.hook_x, &in.ring_x,
                      &in.drag_area, &in.weight, &in.gravity, &in.density})
        *x = number(f);
    for (double& x : in.p) x = number(f);
    for (double& x : in.start) x = number(f);
    in.vw.resize(static_cast<std::size_t>(number(f)));
    for (double& x : in.vw) x = number(f);
    std::fclose(f);
    return in;
}

// Piecewise quintic with derivatives of the polynomial through the seven nearest samples.
struct Smooth {
    double per_interval;
    std::vector<std::array<double, 6>> pieces;

    static void stencil(int at, double w[7][2]) {
        double c[7][3] = {};
        c[0][0] = 1;
        double c1 = 1, c4 = -at;
        for (int i = 1; i < 7; ++i) {
            double c2 = 1, c5 = c4;
            c4 = i - at;
            for (int j = 0; j < i; ++j) {
                const double c3 = i - j;
                c2 *= c3;
                if (j == i - 1) {
                    for (int k = 2; k > 0; --k) c[i][k] = c1 * (k * c[i - 1][k - 1] - c5 * c[i - 1][k]) / c2;
                    c[i][0] = -c1 * c5 * c[i - 1][0] / c2;
                }
                for (int k = 2; k > 0; --k) c[j][k] = (c4 * c[j][k] - k * c[j][k - 1]) / c3;
                c[j][0] = c4 * c[j][0] / c3;
            }
            c1 = c2;
        }
        for (int j = 0; j < 7; ++j) w[j][0] = c[j][1], w[j][1] = c[j][2];
    }

    Smooth(double interval, const std::vector<double>& y) : per_interval(1 / interval) {
        const int n = static_cast<int>(y.size());
        double w[7][7][2];
        for (int at = 0; at < 7; ++at) stencil(at, w[at]);
        auto derivatives = [&](int i, double& d, double& dd) {
            const int first = std::min(std::max(i - 3, 0), n - 7);
            d = dd = 0;
            for (int k = 0; k < 7; ++k) {
                const double e = y[first + k] - y[i];
                d += w[i - first][k][0] * e;
                dd += w[i - first][k][1] * e;
            }
        };
        double v0, a0, v1, a1;
        derivatives(0, v0, a0);
        pieces.reserve(n - 1);
        for (int i = 1; i < n; ++i) {
            derivatives(i, v1, a1);
            const double p = y[i] - y[i - 1] - v0 - 0.5 * a0, q = v1 - v0 - a0, r = a1 - a0;
            pieces.push_back({y[i - 1], v0, 0.5 * a0, 10 * p - 4 * q + 0.5 * r, -15 * p + 7 * q - r, 6 * p - 3 * q + 0.5 * r});
            v0 = v1, a0 = a1;
        }
    }

    void at(double t, double& value, double& rate) const {
        const double x = t * per_interval, end = static_cast<double>(pieces.size());
        if (x < 0) { value = pieces.front()[0], rate = 0; return; }
        if (x > end) { const auto& k = pieces.back(); value = k[0] + k[1] + k[2] + k[3] + k[4] + k[5], rate = 0; return; }
        const std::size_t i = std::min(static_cast<std::size_t>(x), pieces.size() - 1);
        const double s = x - static_cast<double>(i);
        const auto& k = pieces[i];
        value = k[0] + s * (k[1] + s * (k[2] + s * (k[3] + s * (k[4] + s * k[5]))));
        rate = (k[1] + s * (2 * k[2] + s * (3 * k[3] + s * (4 * k[4] + s * 5 * k[5])))) * per_interval;
    }
};

struct Lander {
    const Input& in;
    const Smooth& wind;
    double area = 0.25 * M_PI * in.diameter * in.diameter;

    static void matrix(const State& y, double m[9]) {
        const double w = y[6], x = y[7], yy = y[8], z = y[9], s = 2 / (w * w + x * x + yy * yy + z * z);
        m[0] = 1 - s * (yy * yy + z * z), m[1] = s * (x * yy - w * z), m[2] = s * (x * z + w * yy);
        m[3] = s * (x * yy + w * z), m[4] = 1 - s * (x * x + z * z), m[5] = s * (yy * z - w * x);
        m[6] = s * (x * z - w * yy), m[7] = s * (yy * z + w * x), m[8] = 1 - s * (x * x + yy * yy);
    }

    // Velocity seen from the air, and the direction from hook to ring, body axes.
    void seen(const State& y, const double m[9], double vw, double b[3], double e[3]) const {
        const double v[3] = {y[3] + vw, y[4], y[5]}, to[3] = {in.ring_x - y[0], -y[1], -y[2]};
        for (int k = 0; k < 3; ++k) {
            b[k] = m[k] * v[0] + m[3 + k] * v[1] + m[6 + k] * v[2];
            e[k] = m[k] * to[0] + m[3 + k] * to[1] + m[6 + k] * to[2];
        }
        e[0] -= in.hook_x;
        const double per = 1 / std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
        e[0] *= per, e[1] *= per, e[2] *= per;
    }

    void operator()(const State& y, State& dy, double t) const {
        double m[9], b[3], e[3], vw, vw_rate;
        wind.at(t, vw, vw_rate);
        matrix(y, m);
        seen(y, m, vw, b, e);
        const double u = b[0], v = b[1], w = b[2], p = y[10], q = y[11], r = y[12];
        const double cross2 = v * v + w * w, speed2 = u * u + cross2, speed = std::sqrt(speed2), per = 1 / speed;
        const double sy = v * per, sz = w * per, s2 = cross2 * per * per, qs = 0.5 * in.density * speed2 * area;
        const double cn = in.p[1] + in.p[2] * s2;
        const double pull = 0.5 * in.density * speed2 * in.drag_area - in.weight;
        const double fx = -qs * in.p[0] * u * per + pull * e[0], fy = -qs * cn * sy + pull * e[1], fz = -qs * cn * sz + pull * e[2];
        const double k = 1 / in.mass;
        const double ax = fx * k + in.gravity * m[0], ay = fy * k + in.gravity * m[1], az = fz * k + in.gravity * m[2];
        // The air accelerates by -vw_rate along tunnel X; in body axes that is -vw_rate times the matrix' first row.
        const double ud = ax + vw_rate * m[0] - (q * w - r * v), vd = ay + vw_rate * m[1] - (r * u - p * w),
                     wd = az + vw_rate * m[2] - (p * v - q * u);
        const double uw2 = u * u + w * w, uw = std::sqrt(uw2);
        const double alpha_dot = (u * wd - ud * w) / uw2, beta_dot = (vd * speed2 - v * (u * ud + v * vd + w * wd)) / (speed2 * uw);
        const double alpha = std::atan2(w, u), beta = std::atan2(v, uw), hat = 0.5 * in.diameter * per;
        const double cm_static = in.p[5] + in.p[6] * s2, qsd = qs * in.diameter;
        const double l = qsd * (in.p[3] + in.p[4] * p * hat);
        const double mm = qsd * (cm_static * sz + (in.p[7] + in.p[8] * alpha * alpha) * 0.5 * (q + alpha_dot) * hat) - in.hook_x * pull * e[2];
        const double n = qsd * (-cm_static * sy + (in.p[9] + in.p[10] * beta * beta) * 0.5 * (r - beta_dot) * hat) + in.hook_x * pull * e[1];
        dy[0] = y[3], dy[1] = y[4], dy[2] = y[5];
        dy[3] = (m[0] * fx + m[1] * fy + m[2] * fz) * k + in.gravity;
        dy[4] = (m[3] * fx + m[4] * fy + m[5] * fz) * k;
        dy[5] = (m[6] * fx + m[7] * fy + m[8] * fz) * k;
        dy[6] = -0.5 * (y[7] * p + y[8] * q + y[9] * r);
        dy[7] = 0.5 * (y[6] * p + y[8] * r - y[9] * q);
        dy[8] = 0.5 * (y[6] * q + y[9] * p - y[7] * r);
        dy[9] = 0.5 * (y[6] * r + y[7] * q - y[8] * p);
        dy[10] = (l + (in.iyy - in.izz) * q * r) / in.ixx;
        dy[11] = (mm + (in.izz - in.ixx) * r * p) / in.iyy;
        dy[12] = (n + (in.ixx - in.iyy) * p * q) / in.izz;
    }
};

struct Sample {
    double t;
    State y;
    double euler[3], alpha_t, speed, pull, vw;
};

static void observe(const Smooth& wind, const Lander& lander, const Input& in, Sample& s) {
    double m[9], b[3], e[3], rate;
    wind.at(s.t, s.vw, rate);
    Lander::matrix(s.y, m);
    lander.seen(s.y, m, s.vw, b, e);
    s.euler[0] = std::atan2(-m[5], m[8]), s.euler[1] = std::atan2(m[2], std::hypot(m[0], m[1])), s.euler[2] = std::atan2(-m[1], m[0]);
    s.speed = std::sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    s.alpha_t = std::atan2(std::hypot(b[1], b[2]), b[0]);
    s.pull = 0.5 * in.density * s.speed * s.speed * in.drag_area - in.weight;
}

static std::size_t fly(const Input& in, std::vector<Sample>& out) {
    const Smooth wind(in.interval, in.vw);
    const Lander lander{in, wind};
    auto stepper = odeint::make_dense_output(in.atol, in.rtol, odeint::runge_kutta_dopri5<State>());
    stepper.initialize(in.start, 0.0, 1e-3);
    out.clear();
    std::size_t steps = 0;
    const std::size_t count = in.vw.size();
    State y = in.start;
    for (std::size_t k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) * in.interval;
        if (k > 0) {
            while (stepper.current_time() < t) stepper.do_step(lander), ++steps;
            stepper.calc_state(t, y);
        }
        Sample s{t, y, {}, 0, 0, 0, 0};
        observe(wind, lander, in, s);
        out.push_back(s);
    }
    return steps;
}

// Fixed steps of the interval by the classical method of fourth order; the states alone, or all that a sample has.
static std::size_t fly_rk4(const Input& in, std::vector<Sample>& out, bool seen) {
    const Smooth wind(in.interval, in.vw);
    const Lander lander{in, wind};
    odeint::runge_kutta4<State> stepper;
    const std::size_t count = in.vw.size();
    out.clear();
    out.reserve(count);
    State y = in.start;
    for (std::size_t k = 0; k < count; ++k) {
        if (k > 0) stepper.do_step(lander, y, static_cast<double>(k - 1) * in.interval, in.interval);
        Sample s{static_cast<double>(k) * in.interval, y, {}, 0, 0, 0, 0};
        if (seen) observe(wind, lander, in, s);
        out.push_back(s);
    }
    return count - 1;
}

static double processor_ns() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

int main(int argc, char** argv) {
    if (argc != 4 && argc != 5) return 2;
    const std::string method = argc == 5 ? argv[4] : "dopri5";
    const Input in = read(argv[1]);
    const int repetitions = std::atoi(argv[2]);
    std::vector<Sample> samples;
    std::size_t steps = 0;
    double best = 1e300, total = 0;
    for (int k = 0; k < repetitions; ++k) {
        std::vector<Sample> fresh;
        // As in the flights beside it: adaptive ones take fresh memory, those of fixed steps use theirs again.
        if (method != "dopri5") fresh.swap(samples);
        const double start = processor_ns();
        steps = method == "dopri5" ? fly(in, fresh) : fly_rk4(in, fresh, method == "rk4-seen");
        const double ns = processor_ns() - start;
        best = std::min(best, ns), total += ns;
        samples.swap(fresh);
    }
    std::FILE* f = std::fopen(argv[3], "w");
    if (!f) return 2;
    for (const Sample& s : samples) {
        for (double x : s.y) std::fprintf(f, "%.17g ", x);
        std::fprintf(f, "\n");
    }
    std::fclose(f);
    std::printf("%.1f %.1f %zu\n", best, total / repetitions, steps);
}
