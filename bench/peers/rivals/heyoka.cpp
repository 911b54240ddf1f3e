// heyoka.cpp - runs the Taylor integrator of heyoka. This file calls heyoka and has nothing of it: the user builds and
// installs it, and `make peers HEYOKA=DIR` names the prefix.
#include "peers/peer.h"

#include <heyoka/config.hpp>
#include <heyoka/expression.hpp>
#include <heyoka/kw.hpp>
#include <heyoka/math.hpp>
#include <heyoka/model/nbody.hpp>
#include <heyoka/taylor.hpp>

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace
{

using heyoka::expression;
using equations = std::vector<std::pair<expression, expression>>;

const double tolerances[] = {1e-6, 1e-9, 1e-12, 2.220446049250313e-16, 0};

const double *settings(const peer *, const problem *) { return tolerances; }

expression cube_of_distance(const std::vector<expression> &d)
{
    std::vector<expression> squares;
    for (const auto &x : d) squares.push_back(heyoka::pow(x, 2.));
    return heyoka::pow(heyoka::sum(squares), -1.5);
}

// Accelerations of bodies in the plane, of one body that a mass of 1 at 0 attracts, or of Henon and Heiles.
std::vector<expression> accelerations(const problem *p, const std::vector<expression> &q)
{
    if (p->bodies == 0) return {-q[0] - 2. * q[0] * q[1], -q[1] - q[0] * q[0] + q[1] * q[1]};
    const int axes = p->axes;
    if (p->bodies == 1) {
        const auto r_3 = cube_of_distance(q);
        return {-q[0] * r_3, -q[1] * r_3};
    }
    std::vector<std::vector<expression>> terms(q.size());
    for (int i = 0; i < p->bodies; i++)
        for (int j = 0; j < i; j++) {
            std::vector<expression> d;
            for (int k = 0; k < axes; k++) d.push_back(q[axes * i + k] - q[axes * j + k]);
            const auto r_3 = cube_of_distance(d);
            for (int k = 0; k < axes; k++) {
                terms[axes * i + k].push_back((-p->G * p->mass[j]) * r_3 * d[k]);
                terms[axes * j + k].push_back((p->G * p->mass[i]) * r_3 * d[k]);
            }
        }
    std::vector<expression> a;
    for (const auto &of : terms) a.push_back(heyoka::sum(of));
    return a;
}

// The state is x, v of one body after the other.
equations equations_of(const problem *p)
{
    if (p->axes == 3) {
        const std::vector<double> masses(p->mass, p->mass + p->bodies);
        return heyoka::model::nbody(p->bodies, heyoka::kw::masses = masses, heyoka::kw::Gconst = p->G);
    }
    std::vector<expression> q, v;
    for (int i = 0; i < p->n; i++) {
        q.emplace_back(std::string("q").append(std::to_string(i)));
        v.emplace_back(std::string("v").append(std::to_string(i)));
    }
    const auto a = accelerations(p, q);
    equations all;
    for (int i = 0; i < p->n; i += p->axes) {
        for (int k = 0; k < p->axes; k++) all.push_back(heyoka::prime(q[i + k]) = v[i + k]);
        for (int k = 0; k < p->axes; k++) all.push_back(heyoka::prime(v[i + k]) = a[i + k]);
    }
    return all;
}

struct heyoka_run {
    const problem *of;
    heyoka::taylor_adaptive<double> integrator;
};

std::vector<double> start_of(const problem *p)
{
    std::vector<double> state;
    for (int i = 0; i < p->n; i += p->axes) {
        state.insert(state.end(), p->q + i, p->q + i + p->axes);
        state.insert(state.end(), p->v + i, p->v + i + p->axes);
    }
    return state;
}

// The machine code is made once, and kept to the end of the program.
void *open_run(const peer *, const problem *p, double setting)
{
    static std::map<std::pair<const problem *, double>, heyoka_run> runs;
    const auto key = std::make_pair(p, setting);
    const auto start = start_of(p);
    auto at = runs.find(key);
    if (at == runs.end())
        at = runs.emplace(key, heyoka_run{p, heyoka::taylor_adaptive<double>(equations_of(p), start,
                                                                             heyoka::kw::tol = setting)})
                 .first;
    auto &integrator = at->second.integrator;
    for (std::size_t i = 0; i < start.size(); i++) integrator.get_state_data()[i] = start[i];
    integrator.set_time(0);
    return &at->second;
}

bool go(void *run, double q[])
{
    auto *r = static_cast<heyoka_run *>(run);
    const int axes = r->of->axes;
    const auto outcome = std::get<0>(r->integrator.propagate_until(r->of->t_end));
    for (int i = 0; i < r->of->n; i++) q[i] = r->integrator.get_state()[2 * (i / axes) * axes + i % axes];
    return outcome == heyoka::taylor_outcome::time_limit;
}

void close_run(void *) {}

const char *version() { return HEYOKA_VERSION_STRING; }

const peer peers[] = {{"heyoka", 0, settings, open_run, go, close_run}, {}};

} // namespace

const peer_program peers_of_heyoka = {"heyoka", version, peers};
