/* tangent.c - Multiplies tangent vectors by the derivative M of a step, D <- M D, by the same method on the lifted
 * system (docs/method.md section 10). Each column takes one lifted step, whose history is cleared before. */
#include "run/tangent.h"
#include "method/method.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void free_tangent(tvi_tangent *tangent)
{
    if (!tangent) return;
    tvi_integrator_free(tangent->integrator);
    tvi_system_free(tangent->system);
    free(tangent->Q);
    free(tangent->flow);
    free(tangent->start);
    free(tangent->end);
    free(tangent);
}

/* Allocates the blocks that a rescaled system needs. */
static tvi_status take_blocks(tvi_integrator *it, tvi_tangent *tangent)
{
    const jet_tape *flow = it->stepped->field_values, *change = tangent->system->energy;
    const size_t numbers = (size_t)flow->slots + (size_t)change->slots;
    tangent->flow = malloc(numbers * sizeof *tangent->flow);
    if (!tangent->flow) return TVI_ENOMEM;
    tangent->change = tangent->flow + flow->slots;
    jet_tape_prepare(flow, tangent->flow, 1, 1);
    jet_tape_prepare(change, tangent->change, 1, 1);
    it->stats.bytes += numbers * sizeof *tangent->flow;
    return TVI_OK;
}

static tvi_status create(tvi_tangent **out, tvi_integrator *it)
{
    const size_t n = (size_t)it->stepped->n;
    const size_t parameters = (size_t)tvi_system_parameters(it->system);
    tvi_tangent *tangent = *out = calloc(1, sizeof *tangent);
    if (!tangent) return TVI_ENOMEM;
    tangent->n = it->stepped->n;
    tangent->Q = calloc(8 * n + 3 * parameters, sizeof *tangent->Q);
    if (!tangent->Q) return TVI_ENOMEM;
    tangent->P = tangent->Q + 2 * n;
    tangent->column = tangent->P + 2 * n;
    tangent->gradient = tangent->column + 2 * n + parameters;
    tangent->values = tangent->gradient + 2 * n;
    const tvi_lift lift = tvi_method_of(&it->options)->pairs_momenta ? TVI_LIFT_PAIRED : TVI_LIFT_SEPARABLE;
    tvi_status status = tvi_system_lift(&tangent->system, it->stepped, lift);
    if (status == TVI_OK && tvi_is_rescaled(it)) status = take_blocks(it, tangent);
    if (status != TVI_OK) return status;
    tangent->paired = tangent->system->form != TVI_SEPARABLE;
    tvi_options options = it->options;
    options.max_tail = -1;   /* the step itself is checked */
    options.compiled = NULL; /* the generated code is for the system, not for its lift */
    return tvi_integrator_create(&tangent->integrator, tangent->system, &options);
}

/* Provides memory for more columns, and keeps the contents. */
static tvi_status widen(tvi_integrator *it, int columns)
{
    tvi_tangent *tangent = it->tangent;
    if (columns <= tangent->columns) return TVI_OK;
    const size_t row = (2 * (size_t)it->system->n + (size_t)tvi_system_parameters(it->system)) * sizeof(double);
    double **const both[] = {&tangent->start, &tangent->end};
    for (int i = 0; i < 2; i++) {
        double *D = (size_t)columns > SIZE_MAX / row ? NULL : realloc(*both[i], (size_t)columns * row);
        if (!D) return jet_refuse_memory(TVI_ENOMEM);
        *both[i] = D;
    }
    it->stats.bytes += 2 * (size_t)(columns - tangent->columns) * row;
    tangent->columns = columns;
    return TVI_OK;
}

/* Creates the integrator's tangent when it is first used, and provides memory for the columns. */
tvi_status tvi_integrator_provide_tangent(tvi_integrator *it, int columns)
{
    if (!it->tangent) {
        tvi_tangent *tangent;
        const tvi_status status = create(&tangent, it);
        if (status != TVI_OK) {
            free_tangent(tangent);
            return jet_refuse_memory(status);
        }
        it->tangent = tangent;
        it->free_tangent = free_tangent;
        it->stats.bytes +=
            sizeof *tangent + 8 * (size_t)tangent->n * sizeof *tangent->Q + tangent->integrator->stats.bytes;
    }
    return widen(it, columns);
}

/* The power of two that scales a column to the size of the state, so that neither dominates the corrector's measure. M
 * is linear, and powers of two are exact. */
static int exponent_of(int n, const double q[], const double p[], const double column[])
{
    const double size_q = tvi_largest(n, q, 1), size_p = tvi_largest(n, p, 1);
    const double of_q = tvi_largest(n, column, 1) / (size_q > 0 ? size_q : 1);
    const double of_p = tvi_largest(n, column + n, 1) / (size_p > 0 ? size_p : 1);
    int exponent = 0;
    if (isfinite(of_q) && isfinite(of_p)) (void)frexp(fmax(of_q, of_p), &exponent);
    return exponent;
}

/* Sets the parameters of the step and their rates, which are those of the column at its scale. */
static tvi_status set_parameters(const tvi_integrator *it, const tvi_lifted_step *step, int exponent)
{
    tvi_tangent *tangent = it->tangent;
    const int parameters = tvi_system_parameters(it->system);
    const double *column = tangent->column + 2 * tangent->n;
    for (int i = 0; i < parameters; i++) {
        tangent->values[i] = step->parameters[i];
        tangent->values[parameters + i] = ldexp(column[i], -exponent);
    }
    return tvi_integrator_set_parameters(tangent->integrator, tangent->values);
}

/* Sets the lifted state: the state at the start of the step, and the scaled column. */
static void place_column(const tvi_integrator *it, const tvi_lifted_step *step, int exponent)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    const size_t bytes = (size_t)n * sizeof(double);
    double *dq = tangent->Q + n, *dp = tangent->P + (tangent->paired ? 0 : n);
    memcpy(tangent->Q, step->start->q, bytes);
    memcpy(tangent->P + (tangent->paired ? n : 0), step->start->p, bytes);
    for (int i = 0; i < n; i++) {
        dq[i] = ldexp(tangent->column[i], -exponent);
        dp[i] = ldexp(tangent->column[n + i], -exponent);
    }
}

/* Computes column <- M column. */
static tvi_status step_column(const tvi_integrator *it, const tvi_lifted_step *step)
{
    tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    double *dq = tangent->Q + n, *dp = tangent->P + (tangent->paired ? 0 : n), *column = tangent->column;
    double t = step->start->q[n];
    const int exponent = exponent_of(n, step->start->q, step->start->p, column);
    place_column(it, step, exponent);
    tvi_integrator_reset(tangent->integrator);
    tvi_status status = set_parameters(it, step, exponent);
    if (status == TVI_OK) status = tvi_step(tangent->integrator, step->h, &t, tangent->Q, tangent->P);
    for (int i = 0; i < n && status == TVI_OK; i++) {
        column[i] = ldexp(dq[i], exponent);
        column[n + i] = ldexp(dp[i], exponent);
    }
    return status;
}

/* ---- At equal times ---------------------------------------------------------------------------------------------- */

/* Computes K_q and K_p of a rescaled system at a state. */
static tvi_status differentiate(const tvi_integrator *it, const double parameters[], const double q[], const double p[])
{
    const jet_tape *tape = it->stepped->field_values;
    const tvi_tangent *tangent = it->tangent;
    const size_t n = (size_t)tangent->n, bytes = n * sizeof *q;
    memcpy(tangent->flow, q, bytes);
    memcpy(tangent->flow + n, p, bytes);
    jet_tape_set_parameters(tape, tangent->flow, 1, tvi_system_parameters(it->system), 1, parameters);
    if (!jet_sweep_values(tape, tangent->flow, 1)) return TVI_EDOMAIN;
    for (size_t i = 0; i < 2 * n; i++) tangent->gradient[i] = tangent->flow[tape->output[i]];
    return TVI_OK;
}

/* Sets the change of e in the column. A neighbour at the same time has its own e, with which K is 0 as well: dK = 0,
 * and K_e = g. */
static tvi_status set_energy(const tvi_integrator *it, const tvi_lifted_step *step)
{
    const tvi_tangent *tangent = it->tangent;
    const jet_tape *tape = tangent->system->energy;
    const int n = tangent->n, e = 2 * n - 1;
    tvi_status status = differentiate(it, step->parameters, step->start->q, step->start->p);
    if (status == TVI_OK) status = set_parameters(it, step, 0);
    if (status != TVI_OK) return status;
    place_column(it, step, 0);
    memcpy(tangent->change, tangent->Q, 4 * (size_t)n * sizeof *tangent->Q);
    jet_tape_set_parameters(tape, tangent->change, 1, tvi_system_parameters(tangent->system), 1, tangent->values);
    const bool inside = jet_sweep_values(tape, tangent->change, 1);
    tangent->column[e] = -tangent->change[tape->output[0]] / tangent->gradient[e];
    return inside ? TVI_OK : TVI_EDOMAIN;
}

/* Projects the column to the time of the orbit. After a step in s the neighbour is at another time, and is moved back
 * along the flow: dq - dt K_p / g, dp + dt K_q / g. */
static tvi_status project(const tvi_integrator *it, const tvi_lifted_step *step)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    const tvi_status status = differentiate(it, step->parameters, tangent->Q, tangent->P + (tangent->paired ? n : 0));
    const double ds = tangent->column[n - 1] / tangent->gradient[2 * n - 1];
    for (int i = 0; i < n; i++) {
        tangent->column[i] -= tangent->gradient[n + i] * ds;
        tangent->column[n + i] += tangent->gradient[i] * ds;
    }
    return status;
}

/* Copies the user's column. In a rescaled system the change of e is 0 so far. */
static void read_column(const tvi_integrator *it, const double D[], size_t stride)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = it->system->n, dimension = tangent->n, parameters = tvi_system_parameters(it->system);
    double *dq = tangent->column, *dp = dq + dimension, *rate = dp + dimension;
    memset(dq, 0, 2 * (size_t)dimension * sizeof *dq);
    for (int row = 0; row < n; row++) {
        dq[row] = D[(size_t)row * stride];
        dp[row] = D[(size_t)(n + row) * stride];
    }
    for (int i = 0; i < parameters; i++) rate[i] = D[(size_t)(2 * n + i) * stride];
}

/* Multiplies one column, out = M column, in rows of `stride`. */
static tvi_status move_column(const tvi_integrator *it, const tvi_lifted_step *step, double out[], size_t stride)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = it->system->n;
    const bool rescaled = tangent->flow != NULL;
    const double *dq = tangent->column, *dp = dq + tangent->n;
    tvi_status status = rescaled ? set_energy(it, step) : TVI_OK;
    if (status == TVI_OK) status = step_column(it, step);
    if (status == TVI_OK && rescaled) status = project(it, step);
    for (int row = 0; row < n; row++) {
        out[(size_t)row * stride] = dq[row];
        out[(size_t)(n + row) * stride] = dp[row];
    }
    if (status != TVI_OK || (tvi_all_finite(n, dq) && tvi_all_finite(n, dp))) return status;
    return jet_refuse(TVI_ENONFINITE, "it overflows");
}

tvi_status tvi_columns_move(const tvi_integrator *it, const tvi_lifted_step *step, const tvi_columns *columns,
                            const tvi_columns *out)
{
    const size_t stride = (size_t)columns->columns * columns->spacing, out_stride = (size_t)out->columns * out->spacing;
    for (int i = 0; i < columns->columns; i++) {
        read_column(it, columns->D + (size_t)i * columns->spacing, stride);
        const tvi_status status = move_column(it, step, out->D + (size_t)i * out->spacing, out_stride);
        if (status != TVI_OK) return jet_refuse(status, "column %d of D: %s", i, jet_refusal());
    }
    return TVI_OK;
}

tvi_status tvi_columns_check(const tvi_integrator *it, const tvi_columns *columns)
{
    const int rows = 2 * it->system->n + tvi_system_parameters(it->system);
    for (int row = 0; row < rows; row++)
        for (int i = 0; i < columns->columns; i++)
            if (!isfinite(columns->D[((size_t)row * (size_t)columns->columns + (size_t)i) * columns->spacing]))
                return jet_refuse(TVI_ENONFINITE, "row %d of D is not finite", row);
    return TVI_OK;
}

tvi_status tvi_step_tangent(tvi_integrator *it, double h, double *t, double q[], double p[], double D[], int columns)
{
    const tvi_run_arguments given = {it, t, q, p, h};
    if (!it) return tvi_refuse_run(given, "");
    if (!it->is_in_observer) it->has_dense = false;
    if (!t || !q || !p || !D || columns < 1 || h == 0 || !isfinite(h))
        return tvi_refuse_run(given, D ? "columns is not positive" : "D is NULL");
    const tvi_columns own = {D, columns, 1};
    tvi_status status = tvi_columns_check(it, &own);
    if (status == TVI_OK) status = tvi_integrator_provide_tangent(it, columns);
    if (status == TVI_OK) status = tvi_integrator_begin(it, *t, q, p);
    if (status != TVI_OK) return status;
    const tvi_columns moved = {it->tangent->end, columns, 1};
    it->tangent->step = 0;
    status = tvi_columns_move(it, &(tvi_lifted_step){&it->state, it->parameters, h}, &own, &moved);
    if (status == TVI_OK) status = tvi_step(it, h, t, q, p);
    if (status == TVI_OK) memcpy(D, moved.D, 2 * (size_t)it->system->n * (size_t)columns * sizeof *D);
    return status;
}
