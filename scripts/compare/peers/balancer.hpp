// The balancer's equations for two identical balls, the phases after an event, and the certificate of rest.
// Corresponds to equations.py.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2.
using State = std::array<double, 8>;

// Phase of each ball: 0 sticks, 1 or -1 slips in that direction.
using Phases = std::array<double, 2>;

// Forces on both balls, each over the mass of a ball. `net`: along the ring, without the force between two balls that
// touch; `between`: that force, along the ring.
struct Forces {
    double normal[2], friction[2], net[2], between = 0.0;
};

inline Phases phases_by_speed(const State &y) {
    const auto sign = [](double speed) { return double((speed > 0.0) - (speed < 0.0)); };
    return {sign(y[6]), sign(y[7])};
}

// The disc turns at constant speed.
struct Steady {
    static constexpr bool changes = false;
    double speed, acceleration = 0.0;

    Steady at(double) const { return *this; }
};

// The speed of the disc changes.
struct Changing {
    static constexpr bool changes = true;
    double speed, acceleration;
};

// The disc starts: its speed rises until a time.
struct Ramp {
    static constexpr bool changes = true;
    double speed_at_end, acceleration, end;

    Changing at(double time) const { return {speed_at_end + acceleration * (time - end), acceleration}; }
};

// Each ball moves for itself: the accelerations of both balls by the forces along the ring.
struct Apart {
    double mobile[2];

    void respond(double *along) const {
        for (int i = 0; i < 2; i++) along[i] *= mobile[i];
    }
};

// Tolerance of the friction limit against rounding: within it a resting ball does not break away.
constexpr double slack = 2e-13;

struct Balancer {
    double speed, damping, imbalance, mass, diameter, inertia, friction, drag, rolling;
    // The ramp with which the disc starts, and the angle and law of two balls that touch; zeros without them.
    double acceleration, ramp_time, contact_angle, restitution, ball_friction;

    bool smooth() const { return friction == 0.0; }

    // A quarter of the shortest period of the table in the rotating frame.
    double quarter() const { return 0.5 * M_PI / (std::abs(speed) + 1.0); }

    double mobility() const { return 1.0 / (1.0 + 4.0 * inertia); }

    Apart apart(const Phases &s) const { return {mobility() * s[0] * s[0], mobility() * s[1] * s[1]}; }

    // Writes the time derivative; returns the forces on both balls.
    inline Forces derivative(const double *y, const Phases &s, double *out) const {
        return derivative(y, s, Steady{speed}, apart(s), out);
    }

    // The same for a motion of the disc, and for balls that move apart or together.
    template <class Turning, class Joint>
    [[gnu::always_inline]] Forces derivative(const double *y, const Phases &s, const Turning &disc, const Joint &joint,
                             double *out) const {
        const double omega = disc.speed;
        const double linear = rolling * 2.0 * inertia * diameter * omega;
        const double quadratic = rolling * -4.0 * inertia;
        const double euler = (1.0 - 2.0 * inertia * diameter) * disc.acceleration;
        double sine[2], cosine[2], pressed[2], mu[2], viscous[2];
        double along_x[2], along_y[2], held[2];
        double force_x = 0, force_y = 0;
        for (int i = 0; i < 2; i++) sine[i] = std::sin(y[2 + i]), cosine[i] = std::cos(y[2 + i]);
        for (int i = 0; i < 2; i++) {
            const double v = y[6 + i], w = (omega + v) * (omega + v);
            mu[i] = friction * s[i];
            viscous[i] = drag * v;
            if constexpr (Turning::changes) viscous[i] += euler;
            pressed[i] = w - (linear + quadratic * v) * v;
            along_x[i] = sine[i] + mu[i] * cosine[i];
            along_y[i] = mu[i] * sine[i] - cosine[i];
            held[i] = mu[i] * pressed[i] + viscous[i];
            force_x += mass * cosine[i] * w;
            force_y += mass * sine[i] * w;
        }
        joint.respond(along_x);
        joint.respond(along_y);
        joint.respond(held);
        double xx = 0, xy = 0, yx = 0, yy = 0;
        for (int i = 0; i < 2; i++) {
            const double mass_sine = mass * sine[i], mass_cosine = mass * cosine[i];
            xx += mass_sine * along_x[i];
            xy += mass_sine * along_y[i];
            yx += mass_cosine * along_x[i];
            yy += mass_cosine * along_y[i];
            double lag = held[i];
            if constexpr (Turning::changes) lag -= disc.acceleration;
            force_x -= mass_sine * lag;
            force_y += mass_cosine * lag;
        }
        force_x += imbalance * omega * omega - y[0] - 2.0 * damping * (y[4] - omega * y[1]);
        force_y += -y[1] - 2.0 * damping * (y[5] + omega * y[0]);
        if constexpr (Turning::changes) force_y -= imbalance * disc.acceleration;
        const double a = 1.0 - xx, b = -xy, c = yx, d = 1.0 + yy;
        const double inverse = 1.0 / (a * d - b * c);
        const double a_x = (d * force_x - b * force_y) * inverse;
        const double a_y = (a * force_y - c * force_x) * inverse;
        Forces forces;
        double accelerations[2];
        for (int i = 0; i < 2; i++) {
            double along = sine[i] * a_x - cosine[i] * a_y;
            forces.normal[i] = pressed[i] - cosine[i] * a_x - sine[i] * a_y;
            double slip = mu[i] * forces.normal[i] + drag * y[6 + i];
            if constexpr (Turning::changes) along -= euler;
            forces.net[i] = along - slip;
            forces.friction[i] = s[i] != 0.0 ? slip : along;
            accelerations[i] = forces.net[i];
            out[2 + i] = s[i] * s[i] * y[6 + i];
        }
        joint.respond(accelerations);
        out[6] = accelerations[0];
        out[7] = accelerations[1];
        out[0] = y[4];
        out[1] = y[5];
        out[4] = a_x + 2.0 * omega * y[5] + omega * omega * y[0];
        out[5] = a_y - 2.0 * omega * y[4] + omega * omega * y[1];
        if constexpr (Turning::changes) {
            out[4] += disc.acceleration * y[1];
            out[5] -= disc.acceleration * y[0];
        }
        return forces;
    }

    // How much friction two balls that stick can do without.
    double reserve(const Forces &forces) const {
        const auto of_ball = [&](int i) { return friction * forces.normal[i] - std::abs(forces.friction[i]); };
        return std::min(of_ball(0), of_ball(1));
    }

    // The guard of a ball's phase, positive while it is valid: the sliding speed, or the friction reserve.
    double guard(const double *y, const Forces &forces, const Phases &s, int ball) const {
        if (s[ball] != 0.0) return s[ball] * y[6 + ball];
        return friction * forces.normal[ball] - std::abs(forces.friction[ball]) + slack;
    }

    // Decides the phases of both balls after an event. `at_once`: the ball stops at the instant of its break-away, and
    // sticks.
    template <class Turning>
    void after_event(double *y, Phases &s, const Turning &disc, int ball, bool at_once) const {
        double scratch[8];
        for (int i = 0; i < 2; i++) y[2 + i] -= 2.0 * M_PI * std::floor(y[2 + i] / (2.0 * M_PI));
        if (s[ball] == 0.0) {
            s[ball] = std::copysign(1.0, derivative(y, s, disc, apart(s), scratch).friction[ball]);
        } else {
            s[ball] = 0.0;
            y[6 + ball] = 0.0;
        }
        decide(y, s, disc, at_once ? ball : -1);
    }

    // Lets balls that stick break away where friction cannot hold them. The ball `stays` sticks in any case.
    template <class Turning> void decide(const double *y, Phases &s, const Turning &disc, int stays) const {
        double scratch[8];
        for (bool changed = true; changed;) {
            const Forces forces = derivative(y, s, disc, apart(s), scratch);
            changed = false;
            for (int i = 0; i < 2; i++) {
                const double limit = friction * forces.normal[i] + slack;
                if (s[i] == 0.0 && i != stays && std::abs(forces.friction[i]) > limit) {
                    s[i] = std::copysign(1.0, forces.friction[i]);
                    changed = true;
                }
            }
        }
    }
};

// The table's rest point while both balls stick, and the largest distance from it (squared, in phase space) at which
// neither ball ever breaks away (src/model/certificate.rs).
struct Rest {
    double x = 0.0, y = 0.0, allowed = -1.0;

    Rest() = default;
    // `reserve`: the least reserve of friction for normal and friction forces of both balls.
    template <class Reserve> Rest(const Balancer &b, const double *state, Reserve reserve) {
        const double square = b.speed * b.speed;
        double force_x = b.imbalance, force_y = 0.0;
        for (int i = 2; i < 4; i++) {
            force_x += b.mass * std::cos(state[i]);
            force_y += b.mass * std::sin(state[i]);
        }
        const double real = 1.0 - square, imaginary = 2.0 * b.damping * b.speed;
        const double scale = square / (real * real + imaginary * imaginary);
        x = scale * (real * force_x + imaginary * force_y);
        y = scale * (real * force_y - imaginary * force_x);
        Forces forces;
        for (int i = 0; i < 2; i++) {
            const double sine = std::sin(state[2 + i]), cosine = std::cos(state[2 + i]);
            forces.normal[i] = square * (1.0 + cosine * x + sine * y);
            forces.friction[i] = square * (cosine * y - sine * x);
        }
        const double least = reserve(forces) / (1.0 + b.friction);
        if (least > 0.0) allowed = least * least / (1.0 + 4.0 * b.damping * b.damping);
    }

    bool certified(const Balancer &b, const double *state) const {
        const double u = state[0] - x, v = state[1] - y;
        const double u_dot = state[4] - b.speed * v, v_dot = state[5] + b.speed * u;
        return u * u + v * v + u_dot * u_dot + v_dot * v_dot <= allowed;
    }
};
