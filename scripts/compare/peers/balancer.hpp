// The balancer's equations for two identical balls, the phases after an event, the certificate of rest, and the
// protocol with the runner, shared by the C++ peers. Corresponds to equations.py and serve.py.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

// x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2.
using State = std::array<double, 8>;

// Phase of each ball: 0 sticks, 1 or -1 slips in that direction.
using Phases = std::array<double, 2>;

struct Forces {
    double normal[2], friction[2];
};

// Tolerance of the friction limit against rounding: within it a resting ball does not break away.
constexpr double slack = 2e-13;

struct Balancer {
    double speed, damping, imbalance, mass, diameter, inertia, friction, drag, rolling;

    bool smooth() const { return friction == 0.0; }

    // A quarter of the shortest period of the table in the rotating frame.
    double quarter() const { return 0.5 * M_PI / (std::abs(speed) + 1.0); }

    // Writes the time derivative; returns the forces on both balls.
    inline Forces derivative(const double *y, const Phases &s, double *out) const {
        const double mobility = 1.0 / (1.0 + 4.0 * inertia);
        const double linear = rolling * 2.0 * inertia * diameter * speed;
        const double quadratic = rolling * -4.0 * inertia;
        double sine[2], cosine[2], pressed[2], free[2], mu[2], viscous[2];
        double xx = 0, xy = 0, yx = 0, yy = 0, force_x = 0, force_y = 0;
        for (int i = 0; i < 2; i++) {
            const double v = y[6 + i], w = (speed + v) * (speed + v);
            sine[i] = std::sin(y[2 + i]);
            cosine[i] = std::cos(y[2 + i]);
            free[i] = s[i] * s[i];
            mu[i] = friction * s[i];
            viscous[i] = drag * v;
            pressed[i] = w - (linear + quadratic * v) * v;
            const double mobile = mass * mobility * free[i];
            const double along_x = mobile * (sine[i] + mu[i] * cosine[i]);
            const double along_y = mobile * (mu[i] * sine[i] - cosine[i]);
            const double held = mobile * (mu[i] * pressed[i] + viscous[i]);
            xx += sine[i] * along_x;
            xy += sine[i] * along_y;
            yx += cosine[i] * along_x;
            yy += cosine[i] * along_y;
            force_x += mass * cosine[i] * w - sine[i] * held;
            force_y += mass * sine[i] * w + cosine[i] * held;
        }
        force_x += imbalance * speed * speed - y[0] - 2.0 * damping * (y[4] - speed * y[1]);
        force_y += -y[1] - 2.0 * damping * (y[5] + speed * y[0]);
        const double a = 1.0 - xx, b = -xy, c = yx, d = 1.0 + yy;
        const double inverse = 1.0 / (a * d - b * c);
        const double a_x = (d * force_x - b * force_y) * inverse;
        const double a_y = (a * force_y - c * force_x) * inverse;
        Forces forces;
        for (int i = 0; i < 2; i++) {
            const double along = sine[i] * a_x - cosine[i] * a_y;
            forces.normal[i] = pressed[i] - cosine[i] * a_x - sine[i] * a_y;
            const double slip = mu[i] * forces.normal[i] + viscous[i];
            forces.friction[i] = free[i] > 0.0 ? slip : along;
            out[2 + i] = free[i] * y[6 + i];
            out[6 + i] = free[i] * mobility * (along - slip);
        }
        out[0] = y[4];
        out[1] = y[5];
        out[4] = a_x + 2.0 * speed * y[5] + speed * speed * y[0];
        out[5] = a_y - 2.0 * speed * y[4] + speed * speed * y[1];
        return forces;
    }

    // The guard of a ball's phase, positive while it is valid: the sliding speed, or the friction reserve.
    double guard(const double *y, const Forces &forces, const Phases &s, int ball) const {
        if (s[ball] != 0.0) return s[ball] * y[6 + ball];
        return friction * forces.normal[ball] - std::abs(forces.friction[ball]) + slack;
    }

    // Decides the phases of both balls after an event. `at_once`: the ball stops at the instant of its break-away, and
    // sticks.
    void after_event(double *y, Phases &s, int ball, bool at_once) const {
        double scratch[8];
        for (int i = 0; i < 2; i++) y[2 + i] -= 2.0 * M_PI * std::floor(y[2 + i] / (2.0 * M_PI));
        if (s[ball] == 0.0) {
            s[ball] = std::copysign(1.0, derivative(y, s, scratch).friction[ball]);
        } else {
            s[ball] = 0.0;
            y[6 + ball] = 0.0;
        }
        for (bool changed = true; changed;) {
            const Forces forces = derivative(y, s, scratch);
            changed = false;
            for (int i = 0; i < 2; i++) {
                const bool stays = s[i] != 0.0 || (at_once && i == ball);
                const double limit = friction * forces.normal[i] + slack;
                if (!stays && std::abs(forces.friction[i]) > limit) {
                    s[i] = std::copysign(1.0, forces.friction[i]);
                    changed = true;
                }
            }
        }
    }
};

// The table's rest point while both balls stick, and the largest distance from it (squared, in phase space) at which
// neither ball ever breaks away (src/classification/certificate.rs).
struct Rest {
    double x = 0.0, y = 0.0, allowed = -1.0;

    Rest() = default;
    Rest(const Balancer &b, const double *state) {
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
        double least = std::numeric_limits<double>::infinity();
        for (int i = 2; i < 4; i++) {
            const double sine = std::sin(state[i]), cosine = std::cos(state[i]);
            const double normal = square * (1.0 + cosine * x + sine * y);
            const double friction = square * std::abs(sine * x - cosine * y);
            least = std::min(least, (b.friction * normal - friction) / (1.0 + b.friction));
        }
        if (least > 0.0) allowed = least * least / (1.0 + 4.0 * b.damping * b.damping);
    }

    bool certified(const Balancer &b, const double *state) const {
        const double u = state[0] - x, v = state[1] - y;
        const double u_dot = state[4] - b.speed * v, v_dot = state[5] + b.speed * u;
        return u * u + v * v + u_dot * u_dot + v_dot * v_dot <= allowed;
    }
};

// The end of one run.
struct Ending {
    bool rest = false;
    double time = 0.0;
    State state{};
};

// The counts of all runs.
struct Counts {
    long steps = 0, evaluations = 0, events = 0;
};

inline double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

template <class Values, class Value>
void write_list(const char *name, const Values &values, Value value) {
    std::cout << ", \"" << name << "\": [";
    for (std::size_t i = 0; i < values.size(); i++) std::cout << (i ? ", " : "") << value(values[i]);
    std::cout << ']';
}

inline std::string row(const double *values, int count) {
    std::ostringstream text;
    text.precision(17);
    for (int i = 0; i < count; i++) text << (i ? ", " : "[") << values[i];
    return text.str() + "]";
}

// Answers the runner's commands; the peer is `run_one(balancer, start, end_time, relative, absolute, counts)`.
template <class RunOne> int serve(const char *cases, RunOne run_one) {
    std::ifstream file(cases);
    Balancer b;
    double end_time;
    int runs;
    file >> b.speed >> b.damping >> b.imbalance >> b.mass >> b.diameter >> b.inertia >> b.friction >>
        b.drag >> b.rolling >> end_time >> runs;
    std::vector<State> starts(runs);
    for (auto &start : starts)
        for (auto &value : start) file >> value;
    std::cout.precision(17);
    for (std::string command; std::cin >> command; std::cout << "}" << std::endl) {
        if (command == "check") {
            std::string path;
            std::cin >> path;
            std::ifstream points(path);
            std::vector<std::string> rows;
            for (std::array<double, 10> point; points >> point[0];) {
                for (int i = 1; i < 10; i++) points >> point[i];
                double out[12];
                const Forces forces = b.derivative(point.data(), {point[8], point[9]}, out);
                for (int i = 0; i < 2; i++) out[8 + i] = forces.normal[i], out[10 + i] = forces.friction[i];
                rows.push_back(row(out, 12));
            }
            std::cout << "{\"check\": true";
            write_list("values", rows, [](const std::string &text) { return text; });
            continue;
        }
        double relative, absolute;
        std::cin >> relative >> absolute;
        Counts counts;
        std::vector<Ending> endings;
        const double before = cpu_seconds();
        for (const State &start : starts)
            endings.push_back(run_one(b, start, end_time, relative, absolute, counts));
        std::cout << "{\"cpu_s\": " << cpu_seconds() - before << ", \"steps\": " << counts.steps
                  << ", \"evaluations\": " << counts.evaluations << ", \"events\": " << counts.events;
        write_list("rest", endings, [](const Ending &e) { return e.rest ? "true" : "false"; });
        write_list("time", endings, [](const Ending &e) { return e.time; });
        write_list("state", endings, [](const Ending &e) { return row(e.state.data(), 8); });
    }
    return 0;
}
