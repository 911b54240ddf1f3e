/* project.c - Computes with the constraints of a system at one state (constraint.h): moves a state onto them, and finds
 * the multipliers. All equations have the matrix S = G W G^T, with the inverse masses W = dv/dp. */
#include "algebra/sizes.h"
#include "system/constraint.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [1] A state is near the constraints if the corrections of its coordinates and of its velocity are at most this part
 * of them: half of the digits of a double. */
#define NEAR 0x1p-26
/* [passes] Newton's method makes at most so many. */
#define MAX_PASSES 50
/* The number of derivatives of the field that are computed at once. */
enum { DIRECTIONS = 8 };

/* Tells whether the masses are constant, so that W is diag(1/m). */
static bool has_constant_W(const tvi_system *system) { return system->form == TVI_SEPARABLE || system->has_masses; }

static void allocate_state(tvi_constraint_work *work, tvi_arena *arena, size_t n)
{
    tvi_arena_allocate_each(arena, n,
                            (double **const[]){&work->moved.q, &work->moved.p, &work->moved.q_low, &work->moved.p_low,
                                               &work->start.q, &work->start.p, &work->start.q_low, &work->start.p_low,
                                               &work->velocity, &work->correction, NULL});
}

void tvi_constraint_allocate(tvi_constraint_work *work, tvi_arena *arena, const tvi_system *system)
{
    const size_t n = (size_t)system->n, m = (size_t)system->constraints->count;
    work->system = system;
    work->W = tvi_arena_allocate_doubles(arena, has_constant_W(system) ? n : n * n);
    work->values_block = tvi_arena_allocate_block(arena, system->constraints->values, 1, 1, 0);
    work->rates_block = tvi_arena_allocate_block(arena, system->constraints->rates, 1, 1, 0);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&work->legendre, arena, system);
        work->field_block = work->legendre.field_block;
    } else work->field_block = tvi_arena_allocate_block(arena, system->field_series, 1, 1, 0);
    work->field_tangents = tvi_arena_allocate_doubles(arena, (size_t)system->field_series->slot_count * DIRECTIONS);
    work->product = tvi_arena_allocate_doubles(arena, n);
    work->S = tvi_arena_allocate_doubles(arena, m * m);
    work->scale = tvi_arena_allocate_doubles(arena, m);
    work->residual = tvi_arena_allocate_doubles(arena, m);
    allocate_state(work, arena, n);
}

/* ---- The field at a state ---------------------------------------------------------------------------------------- */

/* Evaluates the field at the state, and sets work->velocity. */
static tvi_status evaluate_field(tvi_constraint_work *work, double t, const double q[], const double p[])
{
    const tvi_system *system = work->system;
    const size_t n = (size_t)system->n;
    double *v = work->velocity, *block = work->field_block;
    if (system->form == TVI_LAGRANGIAN) {
        memset(v, 0, n * sizeof *v); /* Newton's method starts at rest. */
        const tvi_status status = tvi_legendre_solve(&work->legendre, t, q, p, v);
        if (status != TVI_OK) return tvi_refuse_failed_evaluation("velocities of momenta", status);
    }
    memcpy(block, q, n * sizeof *q);
    if (system->form == TVI_LAGRANGIAN) memcpy(block + n, v, n * sizeof *v);
    if (system->form == TVI_HAMILTONIAN) memcpy(block + n, p, n * sizeof *p);
    tvi_system_write_time(system, block, 1, &t);
    tvi_status status = jet_sweep_values(system->field_series, block, 1) ? TVI_OK : TVI_EDOMAIN;
    for (size_t i = 0; i < n; i++) {
        if (system->form == TVI_SEPARABLE) v[i] = p[i] / system->mass[i];
        if (system->form == TVI_HAMILTONIAN) v[i] = block[system->field_series->output_slot[n + i]];
    }
    if (status == TVI_OK && !tvi_all_finite(system->n, v)) status = TVI_ENONFINITE;
    return tvi_refuse_failed_evaluation("equations", status);
}

/* Computes columns first .. first + count - 1 of the derivatives of L_v by v, or of H_p by p, in W. */
static void compute_columns_of_W(tvi_constraint_work *work, int first, int count)
{
    const tvi_system *system = work->system;
    const jet_tape *tape = system->field_series;
    const int n = system->n;
    double *tangents = work->field_tangents;
    memset(tangents, 0, (size_t)tape->slot_count * (size_t)count * sizeof *tangents);
    for (int j = 0; j < count; j++) tangents[(n + first + j) * count + j] = 1;
    jet_sweep_tangents(tape, work->field_block, tangents, 0, count);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < count; j++)
            work->W[(size_t)i * (size_t)n + (size_t)(first + j)] = tangents[tape->output_slot[n + i] * count + j];
}

/* Computes W at the state at which the field was evaluated. */
static tvi_status compute_W(tvi_constraint_work *work)
{
    const tvi_system *system = work->system;
    const size_t n = (size_t)system->n;
    for (size_t i = 0; i < n && has_constant_W(system); i++) work->W[i] = 1 / system->mass[i];
    if (has_constant_W(system)) return TVI_OK;
    for (int j = 0; j < system->n; j += DIRECTIONS)
        compute_columns_of_W(work, j, system->n - j < DIRECTIONS ? system->n - j : DIRECTIONS);
    tvi_status status = TVI_OK;
    if (system->form == TVI_LAGRANGIAN)
        status = tvi_factor_invert_lanes(&work->legendre.jacobian_factor, 1, work->W, work->W, work->correction);
    if (status == TVI_OK && !tvi_rows_are_finite(system->n, n, system->n, work->W)) status = TVI_ENONFINITE;
    return tvi_refuse_failed_evaluation("inverse masses", status);
}

tvi_status tvi_constraint_set_W(tvi_constraint_work *work, double t, const double q[], const double p[])
{
    if (has_constant_W(work->system)) return compute_W(work);
    const tvi_status status = evaluate_field(work, t, q, p);
    return status == TVI_OK ? compute_W(work) : status;
}

tvi_status tvi_constraint_velocity(tvi_constraint_work *work, double t, const double q[], const double p[], double v[])
{
    const tvi_system *system = work->system;
    if (system->form == TVI_SEPARABLE) {
        for (int i = 0; i < system->n; i++) v[i] = p[i] / system->mass[i];
        return TVI_OK;
    }
    const tvi_status status = evaluate_field(work, t, q, p);
    if (status == TVI_OK && v != work->velocity) memcpy(v, work->velocity, (size_t)system->n * sizeof *v);
    return status;
}

/* ---- The constraints at a state ---------------------------------------------------------------------------------- */

/* Evaluates a tape of the constraints, whose inputs are q, x if it is not NULL, and t if it is used. */
static tvi_status evaluate_tape(const tvi_constraint_work *work, const jet_tape *tape, double *block, double t,
                                const double q[], const double x[])
{
    const size_t n = (size_t)work->system->n, inputs = x ? 2 * n : n;
    memcpy(block, q, n * sizeof *q);
    if (x) memcpy(block + n, x, n * sizeof *x);
    if ((size_t)tape->input_count > inputs) block[inputs] = t;
    tvi_status status = jet_sweep_values(tape, block, 1) ? TVI_OK : TVI_EDOMAIN;
    for (int k = 0; k < tape->output_count && status == TVI_OK; k++)
        if (!isfinite(block[tape->output_slot[k]])) status = TVI_ENONFINITE;
    return tvi_refuse_failed_evaluation(x ? "derivatives of phi" : "phi", status);
}

static tvi_status evaluate_values(tvi_constraint_work *work, double t, const double q[])
{
    return evaluate_tape(work, work->system->constraints->values, work->values_block, t, q, NULL);
}

static tvi_status evaluate_rates(tvi_constraint_work *work, double t, const double q[], const double v[])
{
    return evaluate_tape(work, work->system->constraints->rates, work->rates_block, t, q, v);
}

/* Returns the entry of G that values_block contains. */
static double entry_of_G(const tvi_constraint_work *work, int entry)
{
    const tvi_constraints *constraints = work->system->constraints;
    return work->values_block[constraints->values->output_slot[constraints->count + entry]];
}

static double phi_of(const tvi_constraint_work *work, int k)
{
    return work->values_block[work->system->constraints->values->output_slot[k]];
}

static double rate_of(const tvi_constraint_work *work, int k)
{
    return work->rates_block[work->system->constraints->rates->output_slot[k]];
}

/* Returns G_k x. */
static double multiply_row_of_G(const tvi_constraint_work *work, int k, const double x[])
{
    const tvi_constraints *constraints = work->system->constraints;
    double sum = 0;
    for (int e = constraint_row_begin(constraints, k); e < constraints->row_end[k]; e++)
        sum += entry_of_G(work, e) * x[constraints->column[e]];
    return sum;
}

/* Sets x [n] to -G^T y. */
static void multiply_by_G_transposed(const tvi_constraint_work *work, const double y[], double x[])
{
    const tvi_constraints *constraints = work->system->constraints;
    memset(x, 0, (size_t)work->system->n * sizeof *x);
    for (int k = 0; k < constraints->count; k++)
        for (int e = constraint_row_begin(constraints, k); e < constraints->row_end[k]; e++)
            x[tvi_constraint_momentum(constraints, work->system->n, constraints->column[e])] -=
                entry_of_G(work, e) * y[tvi_constraint_multiplier(constraints, k)];
}

/* Adds W x to `to`, [n]. */
static void add_W_product(const tvi_constraint_work *work, const double x[], double to[])
{
    const size_t n = (size_t)work->system->n;
    const bool is_diagonal = has_constant_W(work->system);
    for (size_t i = 0; i < n; i++) {
        if (is_diagonal) to[i] += work->W[i] * x[i];
        for (size_t j = 0; j < (is_diagonal ? 0 : n); j++) to[i] += work->W[i * n + j] * x[j];
    }
}

void tvi_constraint_move(tvi_constraint_work *work, const double y[], double move[])
{
    multiply_by_G_transposed(work, y, work->product);
    memset(move, 0, (size_t)work->system->n * sizeof *move);
    add_W_product(work, work->product, move);
}

tvi_status tvi_constraint_evaluate(tvi_constraint_work *work, double t, const double q[], const double p[],
                                   double value[], double rate[])
{
    tvi_status status = tvi_constraint_velocity(work, t, q, p, work->velocity);
    if (status == TVI_OK) status = evaluate_values(work, t, q);
    if (status == TVI_OK) status = evaluate_rates(work, t, q, work->velocity);
    for (int k = 0; k < work->system->constraints->count && status == TVI_OK; k++) {
        value[k] = phi_of(work, k);
        rate[k] = rate_of(work, k);
    }
    return status;
}

/* ---- The matrix S ------------------------------------------------------------------------------------------------ */

/* Computes the lower triangle of S = G W G^T. */
static void compute_S(tvi_constraint_work *work)
{
    const tvi_constraints *constraints = work->system->constraints;
    const size_t n = (size_t)work->system->n, m = (size_t)constraints->count;
    const bool is_diagonal = has_constant_W(work->system);
    double *row = work->product;
    for (size_t k = 0; k < m; k++) {
        memset(row, 0, n * sizeof *row);
        for (int e = constraint_row_begin(constraints, (int)k); e < constraints->row_end[k]; e++) {
            const int j = constraints->column[e];
            const tvi_W_column of = tvi_constraint_W_column(constraints, (int)n, j);
            if (tvi_constraint_ties_halves(constraints, (int)n, (int)k, j)) continue;
            if (is_diagonal) row[j] = entry_of_G(work, e) * work->W[j];
            for (int i = of.first; i < (is_diagonal ? 0 : of.end); i++)
                row[i] += entry_of_G(work, e) * work->W[(size_t)i * n + (size_t)of.column];
        }
        for (size_t l = 0; l <= k; l++) work->S[k * m + l] = multiply_row_of_G(work, (int)l, row);
    }
}

tvi_status tvi_refuse_dependent(int k, double pivot)
{
    return jet_refuse(TVI_ESINGULAR,
                      "phi[%d] depends on the others (pivot %.1e): it follows from them and is to be left out, "
                      "contradicts them, or the position is singular",
                      k, pivot);
}

/* Scales S to the diagonal 1. */
static tvi_status scale_S(tvi_constraint_work *work)
{
    const size_t m = (size_t)work->system->constraints->count;
    for (size_t k = 0; k < m; k++) {
        const double size = work->S[k * m + k];
        if (!isfinite(size)) return jet_refuse(TVI_ENONFINITE, "the gradient of phi[%zu] is too large", k);
        if (size < 0)
            return jet_refuse(TVI_ESINGULAR, "the inverse mass along the gradient of phi[%zu] is %g", k, size);
        if (!(size > DBL_MIN))
            return jet_refuse(TVI_ESINGULAR, "the gradient of phi[%zu] is 0: a singular position", k);
        work->scale[k] = 1 / sqrt(size);
        for (size_t l = 0; l <= k; l++) work->S[k * m + l] *= work->scale[k] * work->scale[l];
    }
    return TVI_OK;
}

/* Computes S with the G in values_block and with W, and factors it by Cholesky's method, scaled to the diagonal 1. */
static tvi_status factor_S(tvi_constraint_work *work)
{
    const size_t m = (size_t)work->system->constraints->count;
    compute_S(work);
    const tvi_status status = scale_S(work);
    if (status != TVI_OK) return status;
    for (size_t k = 0; k < m; k++) {
        double *row = work->S + k * m, pivot = row[k];
        for (size_t l = 0; l < k; l++) {
            const double *of_l = work->S + l * m;
            for (size_t i = 0; i < l; i++) row[l] -= row[i] * of_l[i];
            row[l] /= of_l[l];
            pivot -= row[l] * row[l];
        }
        if (!(pivot > tvi_dependent_pivot((int)m))) return tvi_refuse_dependent((int)k, pivot);
        row[k] = sqrt(pivot);
    }
    return TVI_OK;
}

void tvi_constraint_solve(const tvi_constraint_work *work, double y[])
{
    const size_t m = (size_t)work->system->constraints->count;
    for (size_t k = 0; k < m; k++) {
        y[k] *= work->scale[k];
        for (size_t l = 0; l < k; l++) y[k] -= work->S[k * m + l] * y[l];
        y[k] /= work->S[k * m + k];
    }
    for (size_t k = m; k-- > 0;) {
        y[k] /= work->S[k * m + k];
        for (size_t l = 0; l < k; l++) y[l] -= work->S[k * m + l] * y[k];
        y[k] *= work->scale[k];
    }
}

tvi_status tvi_constraint_factor(tvi_constraint_work *work, double t, const double q[], const double p[])
{
    tvi_status status = tvi_constraint_set_W(work, t, q, p);
    if (status == TVI_OK) status = evaluate_values(work, t, q);
    return status == TVI_OK ? factor_S(work) : status;
}

tvi_status tvi_constraint_phi(tvi_constraint_work *work, double t, const double q[], double value[])
{
    const tvi_status status = evaluate_values(work, t, q);
    for (int k = 0; k < work->system->constraints->count && status == TVI_OK; k++) value[k] = phi_of(work, k);
    return status;
}

void tvi_constraint_get_G(const tvi_constraint_work *work, double G[])
{
    for (int e = 0; e < work->system->constraints->entry_count; e++) G[e] = entry_of_G(work, e);
}

/* ---- Multipliers ------------------------------------------------------------------------------------------------- */

/* Sets work->correction to the acceleration a = dv/dt without forces of constraint, at the state at which the field was
 * evaluated, with its W. */
static void compute_free_acceleration(tvi_constraint_work *work)
{
    const tvi_system *system = work->system;
    const jet_tape *tape = system->field_series;
    const int n = system->n, *output = tape->output_slot;
    const double *block = work->field_block;
    double *a = work->correction, *tangents = work->field_tangents;
    for (int i = 0; i < n && system->form == TVI_SEPARABLE; i++) a[i] = block[output[i]] / system->mass[i];
    if (system->form == TVI_SEPARABLE) return;
    /* The derivative of the field along the motion: of H_p as q and p move, and of L_v as q moves. */
    memset(tangents, 0, (size_t)tape->slot_count * sizeof *tangents);
    for (int i = 0; i < n; i++) {
        tangents[i] = work->velocity[i];
        if (system->form == TVI_HAMILTONIAN) tangents[n + i] = -block[output[i]];
    }
    if (system->uses_time) tangents[2 * n] = 1;
    jet_sweep_tangents(tape, block, tangents, 0, 1);
    for (int i = 0; i < n && system->form == TVI_HAMILTONIAN; i++) a[i] = tangents[output[n + i]];
    if (system->form == TVI_HAMILTONIAN) return;
    for (int i = 0; i < n; i++) {
        a[i] = 0;
        work->product[i] = block[output[i]] - tangents[output[n + i]];
    }
    add_W_product(work, work->product, a);
}

tvi_status tvi_constraint_multipliers(tvi_constraint_work *work, double t, const double q[], const double p[],
                                      double lambda[])
{
    const int m = work->system->constraints->count;
    tvi_status status = evaluate_field(work, t, q, p);
    if (status == TVI_OK) status = compute_W(work);
    if (status == TVI_OK) status = evaluate_values(work, t, q);
    if (status == TVI_OK) status = evaluate_rates(work, t, q, work->velocity);
    if (status == TVI_OK) status = factor_S(work);
    if (status != TVI_OK) return status;
    compute_free_acceleration(work);
    for (int k = 0; k < m; k++) work->residual[k] = multiply_row_of_G(work, k, work->correction) + rate_of(work, m + k);
    tvi_constraint_solve(work, work->residual);
    if (!tvi_all_finite(m, work->residual)) return tvi_refuse_failed_evaluation("multipliers", TVI_ENONFINITE);
    memcpy(lambda, work->residual, (size_t)m * sizeof *lambda);
    return TVI_OK;
}

void tvi_constraint_force(const tvi_constraint_work *work, const double lambda[], double force[])
{
    multiply_by_G_transposed(work, lambda, force);
}

/* ---- Projection -------------------------------------------------------------------------------------------------- */

/* The passes of Newton's method for one half of the state. */
typedef struct {
    double previous; /* The size of the last correction; negative before the first one. */
    bool is_near;    /* The first correction has to be small. */
} projection_passes;

/* Judges a correction relative to what it corrects: TVI_OK if it is the last one, TVI_ENOCONV if another one follows,
 * and TVI_EINVAL if the state is too far away. */
static tvi_status judge_correction(projection_passes *passes, double correction, double size)
{
    const double previous = passes->previous;
    if (previous < 0 && passes->is_near && !(correction <= NEAR * size)) return TVI_EINVAL;
    passes->previous = correction;
    if (correction <= 2 * DBL_EPSILON * size) return TVI_OK;
    /* Corrections near the state that no longer shrink are the roundoff of phi. */
    return previous >= 0 && previous <= NEAR * size && correction >= previous / 2 ? TVI_OK : TVI_ENOCONV;
}

/* Returns the constraint whose phi, or phi', is farthest from 0, as measured by the masses. */
static int find_farthest(const tvi_constraint_work *work, bool is_rate)
{
    int farthest = 0;
    double largest = -1;
    for (int k = 0; k < work->system->constraints->count; k++) {
        const double distance = fabs(is_rate ? rate_of(work, k) : phi_of(work, k)) * work->scale[k];
        if (distance > largest) {
            largest = distance;
            farthest = k;
        }
    }
    return farthest;
}

/* Sets the text for coordinates or momenta that are not near the constraints, or do not come nearer. */
static tvi_status refuse_state(const tvi_constraint_work *work, tvi_status status, bool is_rate)
{
    const int k = find_farthest(work, is_rate);
    if (status == TVI_EINVAL)
        return is_rate ? jet_refuse(status, "dphi[%d]/dt = %g: the velocity is not along the constraints: tvi_project",
                                    k, rate_of(work, k))
                       : jet_refuse(status, "phi[%d] = %g: the state is not on the constraints: tvi_project", k,
                                    phi_of(work, k));
    return is_rate ? jet_refuse(status, "no momenta are found with dphi[%d]/dt = 0", k)
                   : jet_refuse(status, "no coordinates are found with phi[%d] = 0", k);
}

/* Moves moved_q onto phi = 0 along W G^T, with the W of the state at the start. */
static tvi_status project_coordinates(tvi_constraint_work *work, double t, bool is_near)
{
    const int n = work->system->n, m = work->system->constraints->count;
    projection_passes passes = {-1, is_near};
    tvi_status judged = TVI_ENOCONV;
    for (int pass = 0; pass < MAX_PASSES && judged == TVI_ENOCONV; pass++) {
        tvi_status status = evaluate_values(work, t, work->moved.q);
        if (status == TVI_OK) status = factor_S(work);
        if (status != TVI_OK) return status;
        for (int k = 0; k < m; k++) work->residual[k] = phi_of(work, k) + multiply_row_of_G(work, k, work->moved.q_low);
        tvi_constraint_solve(work, work->residual);
        tvi_constraint_move(work, work->residual, work->correction);
        if (!tvi_all_finite(n, work->correction)) break;
        judged = judge_correction(&passes, tvi_largest_magnitude(n, work->correction, 1),
                                  tvi_largest_magnitude(n, work->moved.q, 1));
        for (int i = 0; i < n && judged != TVI_EINVAL; i++)
            work->moved.q[i] =
                tvi_two_sum(work->moved.q[i], work->moved.q_low[i] + work->correction[i], &work->moved.q_low[i]);
    }
    return judged == TVI_OK ? TVI_OK : refuse_state(work, judged, false);
}

/* Moves moved_p onto phi' = 0 along G^T, at moved_q. */
static tvi_status project_momenta(tvi_constraint_work *work, double t, bool is_near)
{
    const int n = work->system->n, m = work->system->constraints->count;
    projection_passes passes = {-1, is_near};
    tvi_status judged = TVI_ENOCONV, status = evaluate_values(work, t, work->moved.q);
    for (int pass = 0; pass < MAX_PASSES && status == TVI_OK && judged == TVI_ENOCONV; pass++) {
        const bool is_new = pass == 0 || !has_constant_W(work->system); /* W, and so S */
        status = evaluate_field(work, t, work->moved.q, work->moved.p);
        if (status == TVI_OK && is_new) status = compute_W(work);
        if (status == TVI_OK) add_W_product(work, work->moved.p_low, work->velocity);
        if (status == TVI_OK) status = evaluate_rates(work, t, work->moved.q, work->velocity);
        if (status == TVI_OK && is_new) status = factor_S(work);
        if (status != TVI_OK) return status;
        for (int k = 0; k < m; k++) work->residual[k] = rate_of(work, k);
        tvi_constraint_solve(work, work->residual);
        tvi_constraint_move(work, work->residual, work->correction);
        const double size = tvi_largest_magnitude(n, work->velocity, 1);
        if (!tvi_all_finite(n, work->correction)) break;
        judged = judge_correction(&passes, tvi_largest_magnitude(n, work->correction, 1), size);
        multiply_by_G_transposed(work, work->residual, work->correction);
        for (int i = 0; i < n && judged != TVI_EINVAL; i++)
            work->moved.p[i] =
                tvi_two_sum(work->moved.p[i], work->moved.p_low[i] + work->correction[i], &work->moved.p_low[i]);
    }
    return status != TVI_OK || judged == TVI_OK ? status : refuse_state(work, judged, true);
}

tvi_status tvi_constraint_project(tvi_constraint_work *work, double t, double q[], double q_low[], double p[],
                                  double p_low[], bool is_near)
{
    const size_t bytes = (size_t)work->system->n * sizeof *q;
    memcpy(work->moved.q, q, bytes);
    memcpy(work->moved.p, p, bytes);
    memcpy(work->moved.q_low, q_low, bytes);
    memcpy(work->moved.p_low, p_low, bytes);
    tvi_status status = tvi_constraint_set_W(work, t, q, p);
    if (status == TVI_OK) status = project_coordinates(work, t, is_near);
    if (status == TVI_OK) status = project_momenta(work, t, is_near);
    if (status != TVI_OK) return status;
    memcpy(q, work->moved.q, bytes);
    memcpy(p, work->moved.p, bytes);
    memcpy(q_low, work->moved.q_low, bytes);
    memcpy(p_low, work->moved.p_low, bytes);
    return TVI_OK;
}
