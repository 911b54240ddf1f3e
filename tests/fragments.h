/* fragments.h - Declares what the fragments of pages stand in: tests/fragments.awk puts it before them. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <tvi_bodies.h>
#include <tvi_rigid.h>

static const double pi = 3.14159;
static bool all_checked = true;

static jet potential(const jet q[], jet t, void *ctx) /* of Kepler's problem */
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static tvi_status checked(const char *call, tvi_status status)
{
    if (status != TVI_OK) printf("%s: %s\n", call, tvi_last_error());
    all_checked = all_checked && status == TVI_OK;
    return status;
}

/* The integrator has something to save and goes on, with finite numbers. */
static bool ends_well(const char *where, tvi_integrator *integrator, double t, double q[], double p[])
{
    const double before = t;
    if (!integrator) {
        printf("%s: no integrator: %s\n", where, tvi_last_error());
        return false;
    }
    const tvi_status status = tvi_step(integrator, 0.01, &t, q, p);
    printf("%s: %s\n", where, tvi_integrator_stats(integrator)->is_compiled ? "compiled" : "recorded");
    return status == TVI_OK && t > before && isfinite(q[0]) && isfinite(p[0]);
}

#define START                                                                                                          \
    static char memory[1 << 16];                                                                                       \
    void *buffer = memory;                                                                                             \
    double t = 0, t_end = 10, duration = 10, h = 0.1, q[] = {1, 0}, p[] = {0, 0.8};                                    \
    tvi_observer *observer = NULL;                                                                                     \
    tvi_options options = tvi_options_default();                                                                       \
    tvi_system *system = NULL, *rescaled = NULL, *driven = NULL, *constrained = NULL;                                  \
    tvi_integrator *integrator = NULL, *other = NULL;                                                                  \
    if (tvi_system_potential(&system, 2, NULL, potential, NULL) != TVI_OK) return false;                               \
    if (tvi_integrator_create(&integrator, system, NULL) != TVI_OK) return false;                                      \
    if (tvi_integrator_create(&other, system, NULL) != TVI_OK) return false;                                           \
    if (tvi_integrate(integrator, h, 3, &t, q, p, NULL, NULL) != TVI_OK) return false;                                 \
    (void)buffer, (void)t_end, (void)duration, (void)observer, (void)options, (void)rescaled, (void)driven,            \
        (void)constrained, (void)pi, (void)pendulum;
