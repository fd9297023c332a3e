// Balls that cannot pass through each other, as a motion for the loop of boost.cpp: equations, guards, impacts, and the
// decisions where two balls touch. Corresponds to contact.py.
#pragma once

#include "balancer.hpp"
#include "holding.hpp"

// Balls that move apart or together: their accelerations by the forces along the ring of both.
struct Coupled {
    double own[2], other[2];

    void respond(double *along) const {
        const double first = own[0] * along[0] + other[0] * along[1];
        along[1] = own[1] * along[1] + other[1] * along[0];
        along[0] = first;
    }
};

// A gap that opens has this width, so that its guard starts above zero, rad.
constexpr double opened = 1e-13;
// An impact that is slower than this ends in lasting contact.
constexpr double lasting_approach = 1e-6;

struct TouchingBalls {
    static constexpr int guards = 3;
    const Balancer &b;
    const Holding holding;
    Phases s;
    int ahead;  // the ball ahead of two that touch: 1 the second one, -1 the first one, 0 if none touch
    Coupled coupled;

    TouchingBalls(const Balancer &b, const Phases &s, int ahead = 0)
        : b(b), holding(b), s(s), ahead(ahead) {
        couple();
    }

    Forces derivative(const double *y, double, double *out) const {
        Forces forces = b.derivative(y, s, Steady{b.speed}, coupled, out);
        if (ahead != 0 && s[0] != 0.0) press(forces);
        return forces;
    }

    bool needs_forces() const { return s[0] == 0.0 || s[1] == 0.0 || ahead != 0; }
    bool needs_forces(int guard) const {
        if (ahead == 0) return guard < 2 && s[guard] == 0.0;
        return s[0] == 0.0 ? guard == 0 : guard == 1;
    }

    // Positive while the phase of a ball (0, 1) and that of the gaps (2) is valid. Of balls that touch, guard 0 is the
    // speed of both or what holds them, and guard 1 the force between them.
    double guard(const double *y, const Forces &forces, int guard) const {
        if (ahead == 0) return guard < 2 ? b.guard(y, forces, s, guard) : gap(y) + opened;
        if (s[0] == 0.0) return guard == 0 ? holding.reserve(forces, ahead) + slack : 1.0;
        return guard == 0 ? s[0] * y[6] : guard == 1 ? forces.between + slack : 1.0;
    }

    void after_event(State &y, double, int guard, bool at_once) {
        const double turns = std::floor(y[2] / (2.0 * M_PI));
        for (int i = 2; i < 4; i++) y[i] -= 2.0 * M_PI * turns;
        if (guard == 2) {
            meet(y);
        } else if (ahead == 0) {
            if (s[guard] == 0.0) {
                State scratch;
                s[guard] = std::copysign(1.0, derivative(y.data(), 0.0, scratch.data()).friction[guard]);
            } else {
                s[guard] = y[6 + guard] = 0.0;
            }
            b.decide(y.data(), s, Steady{b.speed}, at_once ? guard : -1);
        } else if (guard == 1) {
            ahead = 0;
        } else {
            const bool stops = s[0] != 0.0;
            s = {0.0, 0.0};
            y[6] = y[7] = 0.0;
            if (!(stops && at_once)) decide(y);
        }
        couple();
    }

    bool can_rest() const { return s[0] == 0.0 && s[1] == 0.0; }

    Rest rest(const double *y) const {
        return Rest(b, y, [&](const Forces &forces) {
            return ahead == 0 ? b.reserve(forces) : holding.reserve(forces, ahead);
        });
    }

  private:
    // The width of the narrower gap.
    double gap(const double *y) const {
        const double apart = y[3] - y[2];
        return std::min(apart, 2.0 * M_PI - apart) - b.contact_angle;
    }

    // Sets how the balls answer to forces along the ring. Two balls that move in touch have one acceleration, to which
    // friction between them adds the difference of their forces.
    void couple() {
        if (ahead == 0 || s[0] == 0.0) {
            const Apart apart = b.apart(s);
            coupled = {{apart.mobile[0], apart.mobile[1]}, {0.0, 0.0}};
            return;
        }
        const double shared = 0.5 * b.mobility(), skew = -s[0] * ahead * holding.retards;
        const double first = shared * (1.0 + skew), second = shared * (1.0 - skew);
        coupled = {{first, second}, {second, first}};
    }

    // Adds the force between two balls that move in touch.
    void press(Forces &forces) const {
        forces.between = ahead * (forces.net[0] - forces.net[1]) / (2.0 - 2.0 * b.friction * b.ball_friction);
        for (int i = 0; i < 2; i++) {
            const double side = i == 0 ? -ahead : ahead;
            const double normal = (holding.tangent + side * s[0] * b.ball_friction) * forces.between;
            forces.normal[i] += normal;
            forces.friction[i] += b.friction * s[i] * normal;
        }
    }

    // The impact of both balls by Newton's law, with Coulomb friction between them, and the phases after it.
    void meet(State &y) {
        const int side = y[3] - y[2] < M_PI ? 1 : -1;
        y[3] = y[2] + (side > 0 ? b.contact_angle : 2.0 * M_PI - b.contact_angle);
        const double opening = side * (y[7] - y[6]), rolling = y[6] + y[7];
        const bool lasts = -opening < lasting_approach;
        const double after = lasts ? 0.0 : -b.restitution * opening;
        const double own = 1.0 + 4.0 * b.inertia - b.mass, other = b.mass * std::cos(b.contact_angle);
        const double impulse = 0.5 * (own + other) * (after - opening);
        const double slowed = 2.0 * holding.lever * b.ball_friction * impulse / (own - other);
        const double left = std::copysign(std::max(0.0, std::abs(rolling) - slowed), rolling);
        const double speeds[2] = {0.5 * (left - side * after), 0.5 * (left + side * after)};
        for (int i = 0; i < 2; i++) {
            const double change = speeds[i] - y[6 + i];
            y[4] += b.mass * std::sin(y[2 + i]) * change;
            y[5] -= b.mass * std::cos(y[2 + i]) * change;
            y[6 + i] = speeds[i];
        }
        s = phases_by_speed(y);
        ahead = lasts ? side : 0;
        if (ahead == 0) {
            b.decide(y.data(), s, Steady{b.speed}, -1);
        } else if (s[0] == 0.0) {
            decide(y);
        } else {
            couple();
            State scratch;
            if (derivative(y.data(), 0.0, scratch.data()).between < -slack) ahead = 0;
        }
    }

    // Decides between stick and slip, touch and separation, of two balls at rest that touch: the first way that meets all
    // conditions up to rounding, or else the one that fails them least.
    void decide(const State &y) {
        // Phases of the ball behind and of the one ahead, and whether they stay in touch.
        static constexpr double ways[][3] = {{0, 0, 1}, {1, 1, 1},   {-1, -1, 1}, {0, 1, 0},
                                             {-1, 0, 0}, {-1, 1, 0}, {1, 1, 0},   {-1, -1, 0}};
        const int side = ahead, front = side > 0 ? 1 : 0;
        int best = 0;
        double most = -std::numeric_limits<double>::infinity();
        const auto assume = [&](int way) {
            s[1 - front] = ways[way][0];
            s[front] = ways[way][1];
            ahead = ways[way][2] != 0.0 ? side : 0;
            couple();
        };
        for (int way = 0; way < 8 && most < -0.1 * slack; way++) {
            assume(way);
            const double reserve = least_reserve(y, side);
            if (reserve > most) most = reserve, best = way;
        }
        assume(best);
    }

    // The least of all quantities that must not be negative for the assumed phases of two balls at rest.
    double least_reserve(const State &y, int side) const {
        State out;
        const Forces forces = derivative(y.data(), 0.0, out.data());
        if (ahead != 0 && s[0] == 0.0) return holding.reserve(forces, ahead);
        double least = ahead != 0 ? forces.between : side * (out[7] - out[6]);
        for (int i = 0; i < 2; i++) {
            const double stick = b.friction * forces.normal[i] - std::abs(forces.friction[i]);
            least = std::min(least, s[i] == 0.0 ? stick : s[i] * out[6 + i]);
        }
        return least;
    }
};
