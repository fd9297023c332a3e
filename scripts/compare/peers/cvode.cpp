// Peer: SUNDIALS CVODE with its root finding.
//
// Adams' method with fixed-point iteration: the motion is not stiff, and BDF takes 1.5 times as long. Friction is
// expensive, because a multistep method restarts with order 1 after every event, some hundred times per run, and
// every step goes through function pointers and vectors on the heap. Written for SUNDIALS 6.
#include "protocol.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <stdexcept>

struct Problem {
    const Balancer *balancer;
    Phases phases;
};

static int right_hand_side(sunrealtype, N_Vector y, N_Vector out, void *data) {
    const auto &problem = *static_cast<Problem *>(data);
    problem.balancer->derivative(NV_DATA_S(y), problem.phases, NV_DATA_S(out));
    return 0;
}

static int guards(sunrealtype, N_Vector y, sunrealtype *out, void *data) {
    const auto &[balancer, phases] = *static_cast<Problem *>(data);
    Forces forces{};
    State scratch;
    if (phases[0] == 0.0 || phases[1] == 0.0)
        forces = balancer->derivative(NV_DATA_S(y), phases, scratch.data());
    for (int i = 0; i < 2; i++) out[i] = balancer->guard(NV_DATA_S(y), forces, phases, i);
    return 0;
}

// A solver that is created once and restarted for every run and after every event.
class Solver {
  public:
    Solver() {
        SUNContext_Create(nullptr, &context);
        y = N_VNew_Serial(8, context);
        memory = CVodeCreate(CV_ADAMS, context);
        CVodeInit(memory, right_hand_side, 0.0, y);
        CVodeSetUserData(memory, &problem);
        CVodeSetNonlinearSolver(memory, SUNNonlinSol_FixedPoint(y, 0, context));
        CVodeSetMaxNumSteps(memory, 1000000);
    }

    Ending run(const Balancer &b, const State &start, double end_time, double relative, double absolute,
               Counts &counts) {
        problem = {&b, {std::copysign(1.0, start[6]), std::copysign(1.0, start[7])}};
        double *values = NV_DATA_S(y);
        std::copy(start.begin(), start.end(), values);
        CVodeReInit(memory, 0.0, y);
        CVodeSStolerances(memory, relative, absolute);
        CVodeSetStopTime(memory, end_time);
        int directions[2] = {-1, -1};
        CVodeRootInit(memory, b.smooth() ? 0 : 2, b.smooth() ? nullptr : guards);
        if (!b.smooth()) {
            CVodeSetRootDirection(memory, directions);
            CVodeSetNoInactiveRootWarn(memory);
            CVodeSetMaxStep(memory, b.quarter());
        }
        Phases &s = problem.phases;
        Rest rest;
        Ending ending;
        double time = 0.0, last_event = -1.0;
        while (time < end_time && !ending.rest) {
            // While both balls stick every step is checked for rest, otherwise only events.
            const bool stuck = s[0] == 0.0 && s[1] == 0.0;
            const int result = CVode(memory, end_time, y, &time, stuck ? CV_ONE_STEP : CV_NORMAL);
            if (result < 0) throw std::runtime_error("CVODE failed");
            if (result == CV_ROOT_RETURN) {
                int found[2];
                CVodeGetRootInfo(memory, found);
                counts.events++;
                take(counts);
                const bool at_once = time - last_event < 1e-12;
                last_event = time;
                const Phases before = s;
                for (int ball = 0; ball < 2; ball++)
                    if (found[ball] && s[ball] == before[ball])
                        b.after_event(values, s, ball, at_once);
                CVodeReInit(memory, time, y);
                if (s[0] == 0.0 && s[1] == 0.0) rest = Rest(b, values, [&](const Forces &forces) { return b.reserve(forces); });
            }
            if (s[0] == 0.0 && s[1] == 0.0) ending.rest = rest.certified(b, values);
        }
        take(counts);
        ending.time = time;
        std::copy(values, values + 8, ending.state.begin());
        return ending;
    }

  private:
    SUNContext context;
    N_Vector y;
    void *memory;
    Problem problem;

    // Adds the counts since the last start.
    void take(Counts &counts) {
        long steps, evaluations, conditions;
        CVodeGetNumSteps(memory, &steps);
        CVodeGetNumRhsEvals(memory, &evaluations);
        CVodeGetNumGEvals(memory, &conditions);
        const bool sticks = problem.phases[0] == 0.0 || problem.phases[1] == 0.0;
        counts.steps += steps;
        counts.evaluations += evaluations + (sticks ? conditions : 0);
    }
};

int main(int, char **arguments) {
    Solver solver;
    return serve(arguments[1], values_apart, [&](auto &...rest) { return solver.run(rest...); });
}
