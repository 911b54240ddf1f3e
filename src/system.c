/* system.c - records the user's function and lowers it to the tapes that the steppers run. */
#include "system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Making a system ---------------------------------------------------------------------------------------------- */

static tvi_status check_masses(int n, const double mass[])
{
    for (int i = 0; mass && i < n; i++) {
        if (!isfinite(mass[i])) return TVI_ENONFINITE;
        if (mass[i] <= 0) return TVI_EINVAL;
    }
    return TVI_OK;
}

/* A system without tapes, and the graph's inputs q[0..n-1], t in `input`. */
static tvi_status open_system(tvi_system **out, int n, const double mass[], jet **input)
{
    tvi_system *system = calloc(1, sizeof *system);
    *input = malloc((size_t)(n + 1) * sizeof **input);
    if (system) {
        system->n = n;
        system->mass = malloc((size_t)n * sizeof *system->mass);
        system->graph = jet_graph_create(n + 1);
    }
    if (!system || !*input || !system->mass || !system->graph) {
        tvi_system_free(system);
        free(*input);
        return TVI_ENOMEM;
    }
    for (int i = 0; i < n; i++) system->mass[i] = mass ? mass[i] : 1;
    for (int i = 0; i <= n; i++) (*input)[i] = jet_graph_input(system->graph, i);
    *out = system;
    return TVI_OK;
}

/* The tapes of the recorded force, and of V where it is given. */
static tvi_status close_system(tvi_system *system, jet force[], jet *potential)
{
    const int n = system->n;
    tvi_status status = jet_graph_accept(system->graph, n, force);
    if (status == TVI_OK && potential) status = jet_graph_accept(system->graph, 1, potential);
    if (status != TVI_OK) return status;
    jet_graph_close(system->graph);
    system->force_series = jet_tape_create(system->graph, n, n, force, JET_TAPE_SERIES);
    system->force_values = jet_tape_create(system->graph, n, n, force, JET_TAPE_VALUES);
    if (potential) system->potential = jet_tape_create(system->graph, n, 1, potential, JET_TAPE_VALUES);
    if (!system->force_series || !system->force_values || (potential && !system->potential)) return TVI_ENOMEM;
    system->uses_time = system->force_series->inputs > n;
    return TVI_OK;
}

static tvi_status record_force(tvi_system *system, const jet input[], tvi_force_fn *function, void *ctx)
{
    const int n = system->n;
    jet *force = malloc((size_t)n * sizeof *force);
    if (!force) return TVI_ENOMEM;
    for (int i = 0; i < n; i++) force[i] = jet_unset();
    function(input, input[n], force, ctx);
    const tvi_status status = close_system(system, force, NULL);
    free(force);
    return status;
}

/* F = -dV/dq. */
static tvi_status record_potential(tvi_system *system, const jet input[], tvi_potential_fn *function, void *ctx)
{
    const int n = system->n;
    jet V = function(input, input[n], ctx);
    tvi_status status = jet_graph_accept(system->graph, 1, &V);
    if (status != TVI_OK) return status;
    jet *force = malloc((size_t)n * sizeof *force);
    if (!force) return TVI_ENOMEM;
    status = jet_gradient(system->graph, V, n, force) ? TVI_OK : TVI_ENOMEM;
    for (int i = 0; i < n; i++) force[i] = jet_neg(force[i]);
    if (status == TVI_OK) status = close_system(system, force, &V);
    free(force);
    return status;
}

static tvi_status make_system(tvi_system **out, int n, const double mass[], tvi_force_fn *force,
                              tvi_potential_fn *potential, void *ctx)
{
    if (!out) return TVI_EINVAL;
    *out = NULL;
    if (n < 1 || (!force && !potential)) return TVI_EINVAL;
    tvi_status status = check_masses(n, mass);
    if (status != TVI_OK) return status;
    tvi_system *system;
    jet *input;
    status = open_system(&system, n, mass, &input);
    if (status != TVI_OK) return status;
    status = force ? record_force(system, input, force, ctx) : record_potential(system, input, potential, ctx);
    free(input);
    if (status == TVI_OK) *out = system;
    else tvi_system_free(system);
    return status;
}

tvi_status tvi_system_force(tvi_system **out, int n, const double mass[], tvi_force_fn *force, void *ctx)
{
    return make_system(out, n, mass, force, NULL, ctx);
}

tvi_status tvi_system_potential(tvi_system **out, int n, const double mass[], tvi_potential_fn *potential, void *ctx)
{
    return make_system(out, n, mass, NULL, potential, ctx);
}

void tvi_system_free(tvi_system *system)
{
    if (!system) return;
    jet_tape_free(system->force_series);
    jet_tape_free(system->force_values);
    jet_tape_free(system->potential);
    jet_graph_free(system->graph);
    free(system->mass);
    free(system);
}

/* ---- Asking a system ---------------------------------------------------------------------------------------------- */

int tvi_system_dimension(const tvi_system *system) { return system ? system->n : 0; }

static bool all_finite(int n, const double x[])
{
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

static tvi_status potential_energy(const tvi_system *system, double t, const double q[], double *V)
{
    const jet_tape *tape = system->potential;
    double *x = malloc((size_t)tape->slots * sizeof *x);
    if (!x) return TVI_ENOMEM;
    jet_tape_prepare(tape, x, 1, 1);
    memcpy(x, q, (size_t)system->n * sizeof *x);
    if (tape->inputs > system->n) x[system->n] = t;
    const bool inside = jet_sweep_values(tape, x, 1);
    *V = x[tape->output[0]];
    free(x);
    return inside ? TVI_OK : TVI_EDOMAIN;
}

tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    if (!system || !q || !p || !H) return TVI_EINVAL;
    if (!system->potential) return TVI_EUNSUPPORTED;
    if (!isfinite(t) || !all_finite(system->n, q) || !all_finite(system->n, p)) return TVI_ENONFINITE;
    double V;
    const tvi_status status = potential_energy(system, t, q, &V);
    if (status != TVI_OK) return status;
    double T = 0;
    for (int i = 0; i < system->n; i++) T += p[i] * p[i] / (2 * system->mass[i]);
    if (!isfinite(T + V)) return TVI_ENONFINITE;
    *H = T + V;
    return TVI_OK;
}

/* out = in * mass^power, power = 1 or -1. */
static tvi_status legendre(const tvi_system *system, double t, const double q[], const double in[], double out[], int power)
{
    if (!system || !q || !in || !out) return TVI_EINVAL;
    if (!isfinite(t) || !all_finite(system->n, q) || !all_finite(system->n, in)) return TVI_ENONFINITE;
    for (int i = 0; i < system->n; i++) out[i] = power > 0 ? in[i] * system->mass[i] : in[i] / system->mass[i];
    return TVI_OK;
}

tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[], double p[])
{
    return legendre(system, t, q, v, p, 1);
}

tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[], double v[])
{
    return legendre(system, t, q, p, v, -1);
}
