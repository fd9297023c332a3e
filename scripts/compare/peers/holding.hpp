// Whether friction holds two balls that stick and touch, for any forces between them.
//
// With the force u >= 0 between the balls along the ring and the friction r between them, |r| <= mu_b u, each over the
// mass of a ball, both balls stick if four inequalities in u and r hold. The largest common reserve of the four is a
// linear programme; its dual has few vertices, which depend on the machine only. Each is a sum of three inequalities in
// which u and r vanish, and the reserve is the least of these sums.
#pragma once

#include "balancer.hpp"

#include <vector>

struct Holding {
    double friction;  // of the ring
    double tangent;   // normal force over the force along the ring between two balls
    double lever;     // retarding force of a ball over the friction between two balls
    double retards;   // retarding force of two balls that move in touch, over the difference of their forces
    std::vector<std::array<double, 4>> sums;

    explicit Holding(const Balancer &b) {
        friction = b.friction;
        tangent = std::tan(0.5 * b.contact_angle);
        lever = 1.0 / std::cos(0.5 * b.contact_angle) + tangent;
        retards = (b.ball_friction * lever + friction * tangent) / (1.0 - friction * b.ball_friction);
        // Coefficients of u and r: the ball behind forwards and backwards, the ball ahead likewise, and |r| <= mu_b u.
        const double out = 1.0 + friction * tangent, in = 1.0 - friction * tangent;
        const double less = lever - friction, more = lever + friction;
        const double rows[6][2] = {{-out, -less}, {in, more}, {in, -more}, {-out, less},
                                   {-b.ball_friction, 1.0}, {-b.ball_friction, -1.0}};
        const auto cross = [&](int i, int j) { return rows[i][0] * rows[j][1] - rows[i][1] * rows[j][0]; };
        for (int i = 0; i < 6; i++)
            for (int j = i + 1; j < 6; j++)
                for (int k = j + 1; k < 6; k++) add({i, j, k}, {cross(j, k), cross(k, i), cross(i, j)});
    }

    // The reserve of friction, for the forces on both balls without the force between them; `ahead`: which is ahead.
    double reserve(const Forces &forces, int ahead) const {
        double bounds[4];
        for (int place = 0; place < 2; place++) {
            const int ball = (place == 1) == (ahead > 0) ? 1 : 0;
            const double limit = friction * forces.normal[ball];
            bounds[2 * place] = limit - forces.friction[ball];
            bounds[2 * place + 1] = limit + forces.friction[ball];
        }
        double least = std::numeric_limits<double>::infinity();
        for (const auto &sum : sums) {
            double reserve = 0.0;
            for (int row = 0; row < 4; row++) reserve += sum[row] * bounds[row];
            least = std::min(least, reserve);
        }
        return least;
    }

  private:
    // Adds a sum of three inequalities if all its weights have one sign.
    void add(const std::array<int, 3> &rows, const std::array<double, 3> &weights) {
        std::array<double, 4> sum{};
        double total = 0.0;
        for (int place = 0; place < 3; place++) {
            if (!(weights[place] * weights[0] > 0.0)) return;
            if (rows[place] < 4) sum[rows[place]] = weights[place], total += weights[place];
        }
        for (double &weight : sum) weight /= total;
        sums.push_back(sum);
    }
};
