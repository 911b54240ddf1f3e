/* energy.c - Computes energies (energy.h), and transforms velocities to momenta and back at single states. */
#include "system/energy.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

tvi_status tvi_apply_legendre_transform(const tvi_system *system, const double parameters[], double t, const double q[],
                                        const double input[], double output[], bool to_momenta)
{
    const void *const given[] = {system, q, input, output};
    const char *const name[] = {"system", "q", to_momenta ? "v" : "p", to_momenta ? "p" : "v"};
    if (!system || !q || !input || !output) return tvi_refuse_first_null_pointer(4, given, name);
    const int n = system->n;
    if (!isfinite(t) || !tvi_all_finite(n, q) || !tvi_all_finite(n, input))
        return tvi_refuse_nonfinite_state(n, t, q, name[2], input);
    tvi_legendre_transform legendre;
    void *memory;
    tvi_status status = tvi_legendre_create(&legendre, system, parameters, &memory);
    if (status != TVI_OK) return jet_explain_out_of_memory(status);
    double *result = calloc((size_t)n, sizeof *result);
    if (!result) status = TVI_ENOMEM;
    else if (to_momenta == (system->form != TVI_HAMILTONIAN && system->form != TVI_FIELD))
        status = tvi_legendre_evaluate(&legendre, t, q, input, result);
    else status = tvi_legendre_solve(&legendre, t, q, input, result);
    if (status == TVI_OK && !tvi_all_finite(n, result)) status = TVI_ENONFINITE;
    if (status == TVI_OK) memcpy(output, result, (size_t)n * sizeof *output);
    free(result);
    free(memory);
    return tvi_refuse_failed_evaluation(to_momenta ? "momenta of velocities" : "velocities of momenta", status);
}

tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[], double p[])
{
    return tvi_apply_legendre_transform(system, NULL, t, q, v, p, true);
}

tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[], double v[])
{
    return tvi_apply_legendre_transform(system, NULL, t, q, p, v, false);
}

/* ---- The energy -------------------------------------------------------------------------------------------------- */

void tvi_energy_allocate(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system)
{
    work->system = system;
    work->tape_block = tvi_arena_allocate_block(arena, system->energy.tape, 1, 1, 0);
    if (system->form != TVI_LAGRANGIAN) return;
    tvi_legendre_allocate(&work->legendre, arena, system);
    work->velocity = tvi_arena_allocate_doubles(arena, (size_t)system->n);
}

/* Computes the value of the energy tape, times `sign`, at (q, x, t) for x = v or p. If x is NULL, the tape uses the
 * zeros that its block contains. Returns false if the value does not exist. */
static bool evaluate_energy_tape(const tvi_energy_work *work, double sign, double t, const double q[], const double x[],
                                 double *value)
{
    const jet_tape *tape = work->system->energy.tape;
    const size_t n = (size_t)work->system->n;
    double *block = work->tape_block;
    memcpy(block, q, n * sizeof *q);
    if (x) memcpy(block + n, x, n * sizeof *x);
    if (tape->input_count > work->system->energy.input_count) block[work->system->energy.input_count] = t;
    const bool is_inside = jet_sweep_values(tape, block, 1);
    *value = sign * block[tape->output_slot[0]];
    return is_inside;
}

/* Computes the energy of a system that is not a Lagrangian. Returns false if it has no value. For a separable system,
 * H = V + sum p_i^2 / (2 m_i). V is the value of the energy tape at v = 0 or p = 0, up to the sign. */
static bool compute_explicit_energy(const tvi_energy_work *work, double t, const double q[], const double p[],
                                    double *H)
{
    const tvi_system *system = work->system;
    if (system->form != TVI_SEPARABLE) return evaluate_energy_tape(work, 1, t, q, p, H);
    const bool is_inside = evaluate_energy_tape(work, system->energy.sign, t, q, NULL, H);
    for (int i = 0; i < system->n; i++) *H += p[i] * p[i] / (2 * system->mass[i]);
    return is_inside;
}

/* Computes H = p.v - L(q, v), with the velocity v for which L_v(q, v) = p. */
static tvi_status compute_lagrangian_energy(tvi_energy_work *work, double t, const double q[], const double p[],
                                            double *H)
{
    double *v = work->velocity;
    memset(v, 0, (size_t)work->system->n * sizeof *v); /* Newton's method starts at rest. */
    const tvi_status status = tvi_legendre_solve(&work->legendre, t, q, p, v);
    if (status != TVI_OK) return status;
    const bool is_inside = evaluate_energy_tape(work, -1, t, q, v, H);
    for (int i = 0; i < work->system->n; i++) *H += p[i] * v[i];
    return is_inside ? TVI_OK : TVI_EDOMAIN;
}

tvi_status tvi_energy_compute(tvi_energy_work *work, double t, const double q[], const double p[], double *H)
{
    tvi_status status;
    if (work->system->form == TVI_LAGRANGIAN) status = compute_lagrangian_energy(work, t, q, p, H);
    else status = compute_explicit_energy(work, t, q, p, H) ? TVI_OK : TVI_EDOMAIN;
    return status == TVI_OK && !isfinite(*H) ? TVI_ENONFINITE : status;
}

void tvi_energy_allocate_long_double(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system)
{
    tvi_energy_allocate(work, arena, system);
    work->long_double_values =
        tvi_arena_allocate(arena, (size_t)system->energy.tape->slot_count * sizeof *work->long_double_values);
}

long double tvi_energy_compute_long_double(tvi_energy_work *work, double t, const double q[], const double p[])
{
    double H;
    if (!compute_explicit_energy(work, t, q, p, &H)) return NAN;
    const jet_tape *tape = work->system->energy.tape;
    for (int i = 0; i < tape->input_count; i++) work->long_double_values[i] = work->tape_block[i];
    jet_sweep_long_double_values(tape, work->tape_block, work->long_double_values);
    return work->long_double_values[tape->output_slot[0]];
}

/* Allocates the memory in which the energy of one state is computed, and sets the parameters. The caller frees the
 * memory that is returned. `parameters` NULL stands for the values in the recording. */
static void *create_energy_work(tvi_energy_work *work, const tvi_system *system, const double parameters[])
{
    tvi_arena arena = {0};
    *work = (tvi_energy_work){0};
    tvi_energy_allocate(work, &arena, system);
    void *memory = tvi_arena_obtain_memory(&arena);
    if (!memory) return NULL;
    tvi_energy_allocate(work, &arena, system);
    tvi_system_prepare_blocks(system, arena.first_tape_block, parameters);
    return memory;
}

tvi_status tvi_energy_with_parameters(const tvi_system *system, const double parameters[], double t, const double q[],
                                      const double p[], double *H)
{
    if (!system || !q || !p || !H)
        return tvi_refuse_first_null_pointer(4, (const void *const[]){system, q, p, H},
                                             (const char *const[]){"system", "q", "p", "H"});
    if (system->record.is_tangent) return jet_refuse(TVI_EUNSUPPORTED, "a tangent system has no energy");
    if (!system->energy.tape) return jet_refuse(TVI_EUNSUPPORTED, "a system made from a force has no energy");
    if (!isfinite(t) || !tvi_all_finite(system->n, q) || !tvi_all_finite(system->n, p))
        return tvi_refuse_nonfinite_state(system->n, t, q, "p", p);
    double energy = 0;
    tvi_energy_work work;
    void *memory = create_energy_work(&work, system, parameters);
    if (!memory) return jet_explain_out_of_memory(TVI_ENOMEM);
    const tvi_status status = tvi_energy_compute(&work, t, q, p, &energy);
    free(memory);
    if (status == TVI_OK) *H = energy;
    return tvi_refuse_failed_evaluation("energy", status);
}

tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    return tvi_energy_with_parameters(system, NULL, t, q, p, H);
}
