/* chain.c - Chains of pendulums in two kinds of coordinates (chain.h). */
#include "chain.h"

#include "experiments/experiment.h"

#include <math.h>

/* The velocity of each mass is that of the one before it and of its own link. */
static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const chain *c = ctx;
    jet x_rate = jet_const(0), y_rate = jet_const(0), y = jet_const(0), L = jet_const(0);
    (void)t;
    for (int j = 0; j < c->links; j++) {
        const jet cosine = jet_cos(q[j]), turning = jet_mul(c->length, v[j]);
        x_rate = jet_add(x_rate, jet_mul(turning, cosine));
        y_rate = jet_add(y_rate, jet_mul(turning, jet_sin(q[j])));
        y = jet_sub(y, jet_mul(c->length, cosine));
        L = jet_add(L, jet_sub(jet_mul(0.5, jet_add(jet_sqr(x_rate), jet_sqr(y_rate))), jet_mul(c->g, y)));
    }
    return L;
}

tvi_system *chain_of_angles(const chain *c, double q[], double p[])
{
    tvi_system *system;
    for (int j = 0; j < c->links; j++) q[j] = c->angle[j];
    experiment_insist(tvi_system_lagrangian(&system, c->links, lagrangian, (void *)c), "angles");
    experiment_insist(tvi_momentum(system, 0, q, c->turning, p), "angles");
    return system;
}

static jet potential(const jet q[], jet t, void *ctx)
{
    const chain *c = ctx;
    jet sum = jet_const(0);
    (void)t;
    for (int j = 0; j < c->links; j++) sum = jet_add(sum, q[2 * j + 1]);
    return jet_mul(c->g, sum);
}

/* (|link|^2 - length^2) / 2 */
static void links(const jet q[], jet t, jet value[], void *ctx)
{
    const chain *c = ctx;
    (void)t;
    for (int j = 0; j < c->links; j++) {
        const jet x = j ? jet_sub(q[2 * j], q[2 * j - 2]) : q[0], y = j ? jet_sub(q[2 * j + 1], q[2 * j - 1]) : q[1];
        value[j] = jet_mul(0.5, jet_sub(jet_add(jet_sqr(x), jet_sqr(y)), c->length * c->length));
    }
}

tvi_system *chain_of_places(const chain *c, double q[], double p[])
{
    tvi_system *system, *constrained;
    double x[2] = {0}, v[2] = {0};
    for (int j = 0; j < c->links; j++) {
        const double turning = c->length * c->turning[j];
        q[2 * j] = x[0] += c->length * sin(c->angle[j]), q[2 * j + 1] = x[1] -= c->length * cos(c->angle[j]);
        p[2 * j] = v[0] += turning * cos(c->angle[j]), p[2 * j + 1] = v[1] += turning * sin(c->angle[j]);
    }
    experiment_insist(tvi_system_potential(&system, 2 * c->links, NULL, potential, (void *)c), "places");
    experiment_insist(tvi_system_constrained(&constrained, system, c->links, links, (void *)c), "places");
    tvi_system_free(system);
    return constrained;
}

double chain_distance(const chain *c, const double angle[], const double place[])
{
    double x = 0, y = 0, worst = 0;
    for (int j = 0; j < c->links; j++) {
        x += c->length * sin(angle[j]), y -= c->length * cos(angle[j]);
        worst = fmax(worst, hypot(x - place[2 * j], y - place[2 * j + 1]));
    }
    return worst / (c->length * c->links);
}
