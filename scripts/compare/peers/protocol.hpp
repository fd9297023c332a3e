// The protocol between a C++ peer and the runner: a command per line on standard input, a JSON line back. Corresponds to
// serve.py.
#pragma once

#include "balancer.hpp"

#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

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

template <class Numbers> std::string row(const Numbers &values) {
    std::ostringstream text;
    text.precision(17);
    const char *before = "[";
    for (const double value : values) text << before << value, before = ", ";
    return text.str() + "]";
}

// Derivatives, normal and friction forces.
inline std::vector<double> listed(const double *derivative, const Forces &forces) {
    std::vector<double> values(derivative, derivative + 8);
    values.insert(values.end(), forces.normal, forces.normal + 2);
    values.insert(values.end(), forces.friction, forces.friction + 2);
    return values;
}

// Returns the values at a point with a state and the phases of balls that never touch, at constant speed.
inline std::vector<double> values_apart(const Balancer &b, const std::vector<double> &point) {
    double out[8];
    const Forces forces = b.derivative(point.data(), {point[8], point[9]}, out);
    return listed(out, forces);
}

// Answers the runner's commands; the peer is `values_at(balancer, point)` for the check of its right-hand side, and
// `run_one(balancer, start, end_time, relative, absolute, counts)`.
template <class ValuesAt, class RunOne> int serve(const char *cases, ValuesAt values_at, RunOne run_one) {
    std::ifstream file(cases);
    Balancer b;
    double end_time;
    int runs;
    file >> b.speed >> b.damping >> b.imbalance >> b.mass >> b.diameter >> b.inertia >> b.friction >>
        b.drag >> b.rolling >> b.acceleration >> b.ramp_time >> b.contact_angle >> b.restitution >>
        b.ball_friction >> end_time >> runs;
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
            for (std::string line; std::getline(points, line);) {
                std::istringstream numbers(line);
                std::vector<double> point;
                for (double number; numbers >> number;) point.push_back(number);
                rows.push_back(row(values_at(b, point)));
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
        write_list("state", endings, [](const Ending &e) { return row(e.state); });
    }
    return 0;
}
