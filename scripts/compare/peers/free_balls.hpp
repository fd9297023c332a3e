// Balls that never touch, as a motion for the loop of boost.cpp: equations, guards and phases.
#pragma once

#include "balancer.hpp"

// `Disc`: how the disc turns, `Steady` or `Ramp`.
template <class Disc> struct FreeBalls {
    static constexpr int guards = 2;
    const Balancer &b;
    Disc disc;
    Phases s{};

    // Phases at a start: those of a motion before, or by the speeds alone.
    FreeBalls(const Balancer &b, const Disc &disc, const Phases &s, State &y, double time)
        : b(b), disc(disc), s(s) {
        b.decide(y.data(), this->s, disc.at(time), -1);
    }

    Forces derivative(const double *y, double time, double *out) const {
        return b.derivative(y, s, disc.at(time), b.apart(s), out);
    }

    // Whether any guard depends on forces.
    bool needs_forces() const { return s[0] == 0.0 || s[1] == 0.0; }
    bool needs_forces(int guard) const { return s[guard] == 0.0; }

    // Positive while the phase of a ball is valid.
    double guard(const double *y, const Forces &forces, int guard) const {
        return b.guard(y, forces, s, guard);
    }

    void after_event(State &y, double time, int guard, bool at_once) {
        b.after_event(y.data(), s, disc.at(time), guard, at_once);
    }

    bool can_rest() const { return !Disc::changes && s[0] == 0.0 && s[1] == 0.0; }

    Rest rest(const double *y) const {
        return Rest(b, y, [&](const Forces &forces) { return b.reserve(forces); });
    }
};
