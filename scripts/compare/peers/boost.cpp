// Peer: Boost.odeint, with compiled loops.
//
// With friction it uses the controlled Dormand-Prince method of order 5, the only adaptive Runge-Kutta method of
// odeint with dense output, on which the Illinois method locates events. Smooth motion uses the controlled Fehlberg
// method of order 8, which needs fewer right-hand sides. Tight tolerances with events are expensive, because no
// method of high order has dense output.
#include "balancer.hpp"

#include <boost/numeric/odeint.hpp>

namespace odeint = boost::numeric::odeint;

struct RightHandSide {
    const Balancer &balancer;
    const Phases &phases;
    long &evaluations;

    void operator()(const State &y, State &out, double) const {
        evaluations++;
        balancer.derivative(y.data(), phases, out.data());
    }
};

static Ending smooth_run(const Balancer &b, const State &start, double end_time, double relative,
                         double absolute, Counts &counts) {
    const Phases phases{1.0, 1.0};
    const RightHandSide rhs{b, phases, counts.evaluations};
    auto stepper = odeint::make_controlled(absolute, relative, odeint::runge_kutta_fehlberg78<State>());
    Ending ending;
    ending.state = start;
    counts.steps += odeint::integrate_adaptive(stepper, rhs, ending.state, 0.0, end_time, 0.1);
    ending.time = end_time;
    return ending;
}

// The first event of a step: time and ball; `ball` is -1 if there is none.
struct Event {
    double time;
    int ball;
};

template <class Stepper>
Event first_event(const Balancer &b, Stepper &stepper, const Phases &s, const Forces &start_forces,
                  const Forces &end_forces, Counts &counts) {
    Event first{std::numeric_limits<double>::infinity(), -1};
    const double from = stepper.previous_time(), to = stepper.current_time();
    State y, scratch;
    const auto value = [&](double time, int ball) {
        stepper.calc_state(time, y);
        if (s[ball] != 0.0) return s[ball] * y[6 + ball];
        counts.evaluations++;
        return b.guard(y.data(), b.derivative(y.data(), s, scratch.data()), s, ball);
    };
    for (int ball = 0; ball < 2; ball++) {
        double after = b.guard(stepper.current_state().data(), end_forces, s, ball);
        if (after > 0.0) continue;
        double before = b.guard(stepper.previous_state().data(), start_forces, s, ball);
        double low = from, high = to;
        // A ball that has just broken away may stop immediately or later in the step.
        for (double part = 1e-3; before <= 0.0 && part < 1.0; part *= 2.0) {
            low = from + part * (to - from);
            before = value(low, ball);
        }
        if (before <= 0.0) high = from;
        while (high - low > 1e-13 * std::max(1.0, to)) {
            double time = high - after * (high - low) / (after - before);
            if (!(low < time && time < high)) time = 0.5 * (low + high);
            const double found = value(time, ball);
            if (found > 0.0) {
                low = time, before = found, after *= 0.5;
            } else {
                high = time, after = found, before *= 0.5;
            }
            if (std::abs(found) < 1e-16) break;
        }
        if (high < first.time) first = {high, ball};
    }
    return first;
}

static Ending run_with_events(const Balancer &b, const State &start, double end_time, double relative,
                              double absolute, Counts &counts) {
    auto stepper = odeint::make_dense_output(absolute, relative, b.quarter(),
                                             odeint::runge_kutta_dopri5<State>());
    Phases s{std::copysign(1.0, start[6]), std::copysign(1.0, start[7])};
    const RightHandSide rhs{b, s, counts.evaluations};
    State scratch;
    Ending ending;
    Rest rest;
    Forces forces = b.derivative(start.data(), s, scratch.data());
    stepper.initialize(start, 0.0, 0.05);
    const auto certified = [&](const State &y) {
        return s[0] == 0.0 && s[1] == 0.0 && rest.certified(b, y.data());
    };
    for (;;) {
        stepper.do_step(rhs);
        counts.steps++;
        // odeint does not expose the last derivative, so the forces at the step's end cost another evaluation.
        const bool sticks = s[0] == 0.0 || s[1] == 0.0;
        Forces end_forces = forces;
        if (sticks) {
            end_forces = b.derivative(stepper.current_state().data(), s, scratch.data());
            counts.evaluations++;
        }
        const Event event = first_event(b, stepper, s, forces, end_forces, counts);
        const double time = event.ball < 0 ? stepper.current_time() : event.time;
        if (time >= end_time) {
            stepper.calc_state(end_time, ending.state);
            ending.time = end_time;
            return ending;
        }
        forces = end_forces;
        if (event.ball >= 0) {
            counts.events++;
            State y;
            stepper.calc_state(event.time, y);
            const bool at_once = event.time == stepper.previous_time();
            b.after_event(y.data(), s, event.ball, at_once);
            forces = b.derivative(y.data(), s, scratch.data());
            counts.evaluations += 2;
            stepper.initialize(y, event.time, stepper.current_time_step());
            if (s[0] == 0.0 && s[1] == 0.0) rest = Rest(b, y.data());
        }
        if (certified(stepper.current_state())) {
            ending = {true, stepper.current_time(), stepper.current_state()};
            return ending;
        }
    }
}

int main(int, char **arguments) {
    return serve(arguments[1], [](const Balancer &b, auto &...rest) {
        return b.smooth() ? smooth_run(b, rest...) : run_with_events(b, rest...);
    });
}
