// Peer: Boost.odeint, with compiled loops.
//
// With friction it uses the controlled Dormand-Prince method of order 5, the only adaptive Runge-Kutta method of
// odeint with dense output, on which the Illinois method locates events. Smooth motion uses the controlled Fehlberg
// method of order 8, which needs fewer right-hand sides. Tight tolerances with events are expensive, because no
// method of high order has dense output.
#include "free_balls.hpp"
#include "protocol.hpp"
#include "touching_balls.hpp"

#include <boost/numeric/odeint.hpp>

namespace odeint = boost::numeric::odeint;

static Ending smooth_run(const Balancer &b, const State &start, double end_time, double relative,
                         double absolute, Counts &counts) {
    const Phases phases{1.0, 1.0};
    const auto rhs = [&](const State &y, State &out, double) {
        counts.evaluations++;
        b.derivative(y.data(), phases, out.data());
    };
    auto stepper = odeint::make_controlled(absolute, relative, odeint::runge_kutta_fehlberg78<State>());
    Ending ending;
    ending.state = start;
    counts.steps += odeint::integrate_adaptive(stepper, rhs, ending.state, 0.0, end_time, 0.1);
    ending.time = end_time;
    return ending;
}

// The first event of a step: time and guard; `guard` is -1 if there is none.
struct Event {
    double time;
    int guard;
};

template <class Motion, class Stepper>
Event first_event(const Motion &motion, Stepper &stepper, const Forces &start_forces,
                  const Forces &end_forces, Counts &counts) {
    Event first{std::numeric_limits<double>::infinity(), -1};
    const double from = stepper.previous_time(), to = stepper.current_time();
    State y, scratch;
    const auto value = [&](double time, int guard) {
        stepper.calc_state(time, y);
        Forces forces{};
        if (motion.needs_forces(guard)) {
            counts.evaluations++;
            forces = motion.derivative(y.data(), time, scratch.data());
        }
        return motion.guard(y.data(), forces, guard);
    };
    for (int guard = 0; guard < Motion::guards; guard++) {
        double after = motion.guard(stepper.current_state().data(), end_forces, guard);
        if (after > 0.0) continue;
        double before = motion.guard(stepper.previous_state().data(), start_forces, guard);
        double low = from, high = to;
        // A ball that has just broken away may stop immediately or later in the step.
        for (double part = 1e-3; before <= 0.0 && part < 1.0; part *= 2.0) {
            low = from + part * (to - from);
            before = value(low, guard);
        }
        if (before <= 0.0) high = from;
        while (high - low > 1e-13 * std::max(1.0, to)) {
            double time = high - after * (high - low) / (after - before);
            if (!(low < time && time < high)) time = 0.5 * (low + high);
            const double found = value(time, guard);
            if (found > 0.0) {
                low = time, before = found, after *= 0.5;
            } else {
                high = time, after = found, before *= 0.5;
            }
            if (std::abs(found) < 1e-16) break;
        }
        if (high < first.time) first = {high, guard};
    }
    return first;
}

// Computes a motion with events from `begin` until rest or `end`.
template <class Motion>
Ending run_with_events(Motion &motion, const State &start, double begin, double end, double relative,
                       double absolute, Counts &counts) {
    const Balancer &b = motion.b;
    auto stepper = odeint::make_dense_output(absolute, relative, b.quarter(),
                                             odeint::runge_kutta_dopri5<State>());
    const auto rhs = [&](const State &y, State &out, double time) {
        counts.evaluations++;
        motion.derivative(y.data(), time, out.data());
    };
    State scratch;
    Ending ending;
    Rest rest;
    if (motion.can_rest()) rest = motion.rest(start.data());
    Forces forces = motion.derivative(start.data(), begin, scratch.data());
    stepper.initialize(start, begin, 0.05);
    for (;;) {
        stepper.do_step(rhs);
        counts.steps++;
        // odeint does not expose the last derivative, so the forces at the step's end cost another evaluation.
        Forces end_forces = forces;
        if (motion.needs_forces()) {
            const double time = stepper.current_time();
            end_forces = motion.derivative(stepper.current_state().data(), time, scratch.data());
            counts.evaluations++;
        }
        const Event event = first_event(motion, stepper, forces, end_forces, counts);
        const double time = event.guard < 0 ? stepper.current_time() : event.time;
        if (time >= end) {
            stepper.calc_state(end, ending.state);
            ending.time = end;
            return ending;
        }
        forces = end_forces;
        if (event.guard >= 0) {
            counts.events++;
            State y;
            stepper.calc_state(event.time, y);
            motion.after_event(y, event.time, event.guard, event.time == stepper.previous_time());
            forces = motion.derivative(y.data(), event.time, scratch.data());
            counts.evaluations += 2;
            stepper.initialize(y, event.time, stepper.current_time_step());
            if (motion.can_rest()) rest = motion.rest(y.data());
        }
        if (motion.can_rest() && rest.certified(b, stepper.current_state().data())) {
            ending = {true, stepper.current_time(), stepper.current_state()};
            return ending;
        }
    }
}

// The disc starts, if it does, and then turns steadily.
static Ending run_apart(const Balancer &b, State y, double end, double relative, double absolute,
                        Counts &counts) {
    Phases s = phases_by_speed(y);
    if (b.ramp_time > 0.0) {
        FreeBalls motion(b, Ramp{b.speed, b.acceleration, b.ramp_time}, s, y, 0.0);
        y = run_with_events(motion, y, 0.0, b.ramp_time, relative, absolute, counts).state;
        s = motion.s;
    }
    FreeBalls motion(b, Steady{b.speed}, s, y, b.ramp_time);
    return run_with_events(motion, y, b.ramp_time, end, relative, absolute, counts);
}

static Ending run_in_contact(const Balancer &b, State y, double end, double relative, double absolute,
                             Counts &counts) {
    y[3] = y[2] + std::fmod(y[3] - y[2] + 2.0 * M_PI, 2.0 * M_PI);
    TouchingBalls motion(b, phases_by_speed(y));
    return run_with_events(motion, y, 0.0, end, relative, absolute, counts);
}

// Returns the values at a point with state and phases, and with the ball ahead of two that touch or the time.
static std::vector<double> values_at(const Balancer &b, const std::vector<double> &point) {
    const Phases s{point[8], point[9]};
    double out[8];
    if (b.contact_angle > 0.0) {
        const TouchingBalls motion(b, s, point[10]);
        const Forces forces = motion.derivative(point.data(), 0.0, out);
        auto values = listed(out, forces);
        values.push_back(forces.between);
        return values;
    }
    if (b.ramp_time == 0.0 || point[10] >= b.ramp_time) return values_apart(b, point);
    const auto disc = Ramp{b.speed, b.acceleration, b.ramp_time}.at(point[10]);
    const Forces forces = b.derivative(point.data(), s, disc, b.apart(s), out);
    return listed(out, forces);
}

int main(int, char **arguments) {
    return serve(arguments[1], values_at, [](const Balancer &b, auto &...rest) {
        return b.smooth()               ? smooth_run(b, rest...)
               : b.contact_angle > 0.0 ? run_in_contact(b, rest...)
                                       : run_apart(b, rest...);
    });
}
