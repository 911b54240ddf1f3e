/* quad.c - Computes the systems of quad.h, and their curves. type1_quad.c has the methods. */
#include "system_quad.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

/* ---- Systems ---------------------------------------------------------------------------------------------------- */

static quad_system *system_of(jet_graph *graph, int n, const double mass[], jet force[])
{
    if (jet_graph_check_outputs(graph, n, force) != TVI_OK) return NULL;
    quad_system *system = quad_allocate(1, sizeof *system);
    system->n = n;
    system->mass = quad_vector(n);
    for (int i = 0; i < n; i++) system->mass[i] = mass ? mass[i] : 1;
    system->force = quad_compile(graph, n, force);
    return system;
}

/* An open graph and its n + 1 inputs q, t. */
static jet_graph *open_graph(int n, jet **inputs)
{
    jet_graph *graph = jet_graph_create(n + 1);
    if (!graph) abort();
    *inputs = quad_allocate((size_t)n + 1, sizeof **inputs);
    for (int i = 0; i <= n; i++) (*inputs)[i] = jet_graph_input(graph, i);
    return graph;
}

quad_system *quad_system_force(int n, const double mass[], tvi_force_fn *force, void *ctx)
{
    jet *inputs, *F = quad_allocate((size_t)n, sizeof *F);
    jet_graph *graph = open_graph(n, &inputs);
    for (int i = 0; i < n; i++) F[i] = jet_make_unset_poison();
    force(inputs, inputs[n], F, ctx);
    quad_system *system = system_of(graph, n, mass, F);
    jet_graph_free(graph);
    free(inputs);
    free(F);
    return system;
}

/* F = -dV/dq. */
quad_system *quad_system_potential(int n, const double mass[], tvi_potential_fn *potential, void *ctx)
{
    jet *inputs, *F = quad_allocate((size_t)n, sizeof *F);
    jet_graph *graph = open_graph(n, &inputs);
    jet V = potential(inputs, inputs[n], ctx);
    quad_system *system = NULL;
    if (jet_graph_check_outputs(graph, 1, &V) == TVI_OK) {
        if (!jet_record_gradient(graph, V, n, F)) abort();
        for (int i = 0; i < n; i++) F[i] = jet_neg(F[i]);
        system = system_of(graph, n, mass, F);
        if (system) system->potential = quad_compile(graph, 1, &V);
    }
    jet_graph_free(graph);
    free(inputs);
    free(F);
    return system;
}

void quad_system_free(quad_system *system)
{
    if (!system) return;
    quad_release(&system->force);
    quad_release(&system->potential);
    free(system->mass);
    free(system);
}

/* The outputs of the program at numbers. */
static void values(const quad_program *program, int n, quad t, const quad q[], quad output[])
{
    quad *all = quad_vector(program->series);
    memcpy(all, q, (size_t)n * sizeof *q);
    all[n] = t;
    quad_run_program(program, all, 1, 0);
    for (int i = 0; i < program->outputs; i++) output[i] = all[program->output[i]];
    free(all);
}

void quad_force(const quad_system *system, quad t, const quad q[], quad F[])
{
    values(&system->force, system->n, t, q, F);
}

quad quad_energy(const quad_system *system, quad t, const quad q[], const quad p[])
{
    if (!system->potential.outputs) return nanq("");
    quad H;
    values(&system->potential, system->n, t, q, &H);
    for (int i = 0; i < system->n; i++) H += p[i] * p[i] / (2 * system->mass[i]);
    return H;
}

/* ---- The curve -------------------------------------------------------------------------------------------------- */

/* m (k+1)(k+2) c_{k+2} = [s^k] F(g(s), t + s), one order at a time (method.md section 2). */
void quad_expand(const quad_system *system, quad t, const quad q[], const quad v[], int degree, quad c[])
{
    const int n = system->n, length = degree + 1;
    const quad_program *force = &system->force;
    quad *all = quad_vector(force->series * length);
    memcpy(c, q, (size_t)n * sizeof *c);
    memcpy(c + n, v, (size_t)n * sizeof *c);
    for (int k = 0; k + 2 <= degree; k++) {
        for (int i = 0; i < n; i++) all[i * length + k] = c[k * n + i];
        all[n * length + k] = k == 0 ? t : k == 1;
        quad_run_program(force, all, length, k);
        for (int i = 0; i < n; i++)
            c[(k + 2) * n + i] = all[force->output[i] * length + k] / (system->mass[i] * (k + 1) * (k + 2));
    }
    free(all);
}

/* x = sum_{k <= degree} c_k s^k. */
void quad_position(int n, int degree, const quad c[], quad s, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 0; k--) x[i] = x[i] * s + c[k * n + i];
    }
}

/* x = sum_{1 <= k <= degree} k c_k s^(k-1). */
void quad_velocity(int n, int degree, const quad c[], quad s, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 1; k--) x[i] = x[i] * s + k * c[k * n + i];
    }
}

void quad_taylor(const quad_system *system, int degree, quad h, long steps, quad *t, quad q[], quad p[])
{
    const int n = system->n;
    const quad t0 = *t;
    quad *v = quad_vector(n), *c = quad_vector((degree + 1) * n);
    for (int i = 0; i < n; i++) v[i] = p[i] / system->mass[i];
    for (long step = 0; step < steps; step++) {
        quad_expand(system, t0 + step * h, q, v, degree, c);
        quad_position(n, degree, c, h, q);
        quad_velocity(n, degree, c, h, v);
    }
    for (int i = 0; i < n; i++) p[i] = v[i] * system->mass[i];
    *t = t0 + steps * h;
    free(v);
    free(c);
}
