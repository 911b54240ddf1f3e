/* tangent.c - Multiplies tangent vectors, the columns of D, by the Jacobian matrix M of a step: D <- M D (tangent.h).
 * For each column the same method makes one step of the lifted system (docs/method.md section 10). Before this step the
 * history of the lifted integrator is cleared, so that the columns do not depend on one another. In a run the vectors
 * before and after the last step are stored, since the vectors at a point inside the step are computed from the vectors
 * before the step. */
#include "integrator/tangent.h"
#include "integrator/columns.h"
#include "method/method.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A step whose Jacobian matrix is wanted: the state at its start, the parameters that it is made with, and its size. */
typedef struct {
    const tvi_run_state *start;
    const double *parameters;
    double h;
} differentiated_step;

/* The memory of an integrator for tangent vectors. n is the number of coordinates of the system that is stepped. */
struct tvi_tangent {
    int n;                     /* coordinates of the stepped system: one more than the user's if it is rescaled */
    bool are_momenta_swapped;  /* true if the momenta of the coordinates (q, dq) are (dp, p), not (p, dp) */
    tvi_system *lifted_system; /* the lifted system, with coordinates (q, dq) */
    tvi_integrator *lifted_integrator; /* makes steps of the lifted system */
    double *lifted_q, *lifted_p;       /* [2n] each, the state of the lifted system */
    double *column;                    /* [2n + parameters] the tangent vector that is being multiplied */
    double *gradient;                  /* [2n] the derivatives K_q and K_p of a rescaled system's Hamiltonian K */
    double *field_block;  /* memory in which the tape of K_q and K_p is evaluated; NULL if the system is not rescaled */
    double *energy_block; /* memory in which the lifted energy is evaluated, the change of K along a tangent vector */
    /* [2 parameters] The parameters of the lifted system: the integrator's values, then the components of the tangent
     * vector that belong to the parameters. */
    double *parameters_and_rates;
    tvi_step_columns last_step;   /* the columns of the integrator's last step */
    tvi_columns_at_once *at_once; /* the memory for columns that are moved at once; NULL if none have been */
};

void tvi_step_columns_exchange(tvi_integrator *it, tvi_step_columns *columns)
{
    const tvi_step_columns own = it->tangent->last_step;
    it->tangent->last_step = *columns;
    *columns = own;
}

void tvi_step_columns_free(tvi_step_columns *columns)
{
    free(columns->at_start);
    free(columns->at_end);
}

static void free_tangent(tvi_tangent *tangent)
{
    if (!tangent) return;
    tvi_at_once_free(tangent->at_once);
    tvi_integrator_free(tangent->lifted_integrator);
    tvi_system_free(tangent->lifted_system);
    free(tangent->lifted_q);
    free(tangent->field_block);
    tvi_step_columns_free(&tangent->last_step);
    free(tangent);
}

/* Allocates the memory in which a rescaled system evaluates the derivatives of K, and the change of K along a
 * column. */
static tvi_status allocate_tape_blocks(tvi_integrator *it, tvi_tangent *tangent)
{
    const jet_tape *flow = it->stepped->field_values, *change = tangent->lifted_system->energy.tape;
    const size_t numbers = (size_t)flow->slot_count + (change ? (size_t)change->slot_count : 0);
    tangent->field_block = malloc(numbers * sizeof *tangent->field_block);
    if (!tangent->field_block) return TVI_ENOMEM;
    jet_tape_write_constants(flow, tangent->field_block, 1, 1);
    if (change) tangent->energy_block = tangent->field_block + flow->slot_count;
    if (change) jet_tape_write_constants(change, tangent->energy_block, 1, 1);
    it->stats.bytes += numbers * sizeof *tangent->field_block;
    return TVI_OK;
}

static tvi_status create_tangent(tvi_tangent **out, tvi_integrator *it)
{
    const size_t n = (size_t)it->stepped->n;
    const size_t parameters = (size_t)tvi_system_parameters(it->system);
    tvi_tangent *tangent = *out = calloc(1, sizeof *tangent);
    if (!tangent) return TVI_ENOMEM;
    tangent->n = it->stepped->n;
    tangent->lifted_q = calloc(8 * n + 3 * parameters, sizeof *tangent->lifted_q);
    if (!tangent->lifted_q) return TVI_ENOMEM;
    tangent->lifted_p = tangent->lifted_q + 2 * n;
    tangent->column = tangent->lifted_p + 2 * n;
    tangent->gradient = tangent->column + 2 * n + parameters;
    tangent->parameters_and_rates = tangent->gradient + 2 * n;
    const tvi_lift lift = tvi_find_method(&it->options)->needs_conjugate_momenta ? TVI_LIFT_PAIRED : TVI_LIFT_SEPARABLE;
    tvi_status status = tvi_system_create_lift(&tangent->lifted_system, it->stepped, lift);
    if (status == TVI_OK && tvi_is_rescaled(it)) status = allocate_tape_blocks(it, tangent);
    if (status != TVI_OK) return status;
    tangent->are_momenta_swapped = tangent->lifted_system->form != TVI_SEPARABLE;
    tvi_options options = it->options;
    options.max_tail = -1;   /* The guard checks the integrator's own step only. */
    options.compiled = NULL; /* The generated code computes steps of the system itself, not of the lifted system. */
    return tvi_integrator_create(&tangent->lifted_integrator, tangent->lifted_system, &options);
}

/* Allocates memory for more columns of a run, and keeps the contents. */
static tvi_status reserve_tangent_columns(tvi_integrator *it, int column_count)
{
    tvi_tangent *tangent = it->tangent;
    if (column_count <= tangent->last_step.capacity) return TVI_OK;
    const size_t row = (2 * (size_t)it->system->n + (size_t)tvi_system_parameters(it->system)) * sizeof(double);
    double **const both[] = {&tangent->last_step.at_start, &tangent->last_step.at_end};
    for (int i = 0; i < 2; i++) {
        double *D = (size_t)column_count > SIZE_MAX / row ? NULL : realloc(*both[i], (size_t)column_count * row);
        if (!D) return jet_explain_out_of_memory(TVI_ENOMEM);
        *both[i] = D;
    }
    it->stats.bytes += 2 * (size_t)(column_count - tangent->last_step.capacity) * row;
    tangent->last_step.capacity = column_count;
    return TVI_OK;
}

/* Allocates the memory for tangent vectors when an integrator first uses them, or when it needs more columns. */
tvi_status tvi_integrator_allocate_tangents(tvi_integrator *it, int column_count)
{
    if (!it->tangent) {
        tvi_tangent *tangent;
        const tvi_status status = create_tangent(&tangent, it);
        if (status != TVI_OK) {
            free_tangent(tangent);
            return jet_explain_out_of_memory(status);
        }
        it->tangent = tangent;
        it->free_tangent = free_tangent;
        it->stats.bytes += sizeof *tangent + 8 * (size_t)tangent->n * sizeof *tangent->lifted_q +
                           tangent->lifted_integrator->stats.bytes;
    }
    return reserve_tangent_columns(it, column_count);
}

/* Returns the exponent of the power of two that scales a column to the size of the state. The norm of the lifted step's
 * corrector then gives the state and the column the same weight. M is linear and powers of two are exact, so the scale
 * does not change the result. On constraints the components that belong to parameters count, too, relative to these: a
 * column of a parameter that moves nothing has the roundoff of phi_c, which must not become as large as the state. */
static int find_tangent_scaling_exponent(const tvi_integrator *it, const differentiated_step *step,
                                         const double column[])
{
    const int n = it->stepped->n, parameters = it->system->constraints ? tvi_system_parameters(it->system) : 0;
    const double size_q = tvi_largest_magnitude(n, step->start->q, 1),
                 size_p = tvi_largest_magnitude(n, step->start->p, 1);
    const double of_q = tvi_largest_magnitude(n, column, 1) / (size_q > 0 ? size_q : 1);
    const double of_p = tvi_largest_magnitude(n, column + n, 1) / (size_p > 0 ? size_p : 1);
    double largest = fmax(of_q, of_p);
    int exponent = 0;
    for (int i = 0; i < parameters; i++)
        largest = fmax(largest, fabs(column[2 * n + i]) / fmax(fabs(step->parameters[i]), 1));
    if (isfinite(of_q) && isfinite(of_p)) (void)frexp(largest, &exponent);
    return exponent;
}

/* Sets the parameters of the lifted system: the values that the step is made with, and the components of the column
 * that belong to the parameters, divided by 2^tangent_binary_exponent. */
static tvi_status set_lifted_parameters(const tvi_integrator *it, const differentiated_step *step,
                                        int tangent_binary_exponent)
{
    tvi_tangent *tangent = it->tangent;
    const int parameters = tvi_system_parameters(it->system);
    const double *column = tangent->column + 2 * tangent->n;
    for (int i = 0; i < parameters; i++) {
        tangent->parameters_and_rates[i] = step->parameters[i];
        tangent->parameters_and_rates[parameters + i] = ldexp(column[i], -tangent_binary_exponent);
    }
    return tvi_integrator_set_parameters(tangent->lifted_integrator, tangent->parameters_and_rates);
}

/* Sets the state of the lifted system, which consists of the state at the start of the step and of the column, a
 * tangent vector, divided by 2^tangent_binary_exponent. */
static void set_state_and_scaled_tangent(const tvi_integrator *it, const differentiated_step *step,
                                         int tangent_binary_exponent)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    const size_t bytes = (size_t)n * sizeof(double);
    double *dq = tangent->lifted_q + n, *dp = tangent->lifted_p + (tangent->are_momenta_swapped ? 0 : n);
    memcpy(tangent->lifted_q, step->start->q, bytes);
    memcpy(tangent->lifted_p + (tangent->are_momenta_swapped ? n : 0), step->start->p, bytes);
    for (int i = 0; i < n; i++) {
        dq[i] = ldexp(tangent->column[i], -tangent_binary_exponent);
        dp[i] = ldexp(tangent->column[n + i], -tangent_binary_exponent);
    }
}

/* Moves the tangent vector of the lifted state onto the constraints: dq along W G^T to phi_q dq = 0, and dp along G^T
 * until this holds for the rates, too. */
static tvi_status put_tangent_onto_constraints(const tvi_integrator *it, double t)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = tangent->n, m = it->system->constraints->count;
    tvi_constraint_work of_state = it->constraint_work, *lifted = &tangent->lifted_integrator->constraint_work;
    double *q = tangent->lifted_q, *p = tangent->lifted_p, *value = lifted->residual, *rate = lifted->scale;
    double *dp = p + (tangent->are_momenta_swapped ? 0 : n);
    tvi_status status = tvi_constraint_factor(&of_state, t, q, p + (tangent->are_momenta_swapped ? n : 0));
    for (int half = 0; half < 2 && status == TVI_OK; half++) {
        status = tvi_constraint_evaluate(lifted, t, q, p, value, rate);
        if (status != TVI_OK) break;
        double *off = (half ? rate : value) + m, *onto = of_state.correction;
        tvi_constraint_solve(&of_state, off);
        if (half) tvi_constraint_force(&of_state, off, onto);
        else tvi_constraint_move(&of_state, off, onto);
        for (int i = 0; i < n; i++) (half ? dp : q + n)[i] += onto[i];
    }
    return status;
}

/* Computes column <- M column, where M is the Jacobian matrix of the step in its own variable, the time or the s of a
 * rescaled system. In a rescaled system a call of project_column_to_fixed_time must follow. */
static tvi_status multiply_column_at_fixed_s(const tvi_integrator *it, const differentiated_step *step)
{
    tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    double *dq = tangent->lifted_q + n, *dp = tangent->lifted_p + (tangent->are_momenta_swapped ? 0 : n),
           *column = tangent->column;
    double t = step->start->q[n];
    const int exponent = find_tangent_scaling_exponent(it, step, column);
    set_state_and_scaled_tangent(it, step, exponent);
    tvi_integrator_reset(tangent->lifted_integrator);
    tvi_status status = set_lifted_parameters(it, step, exponent);
    if (status == TVI_OK && it->system->constraints) status = put_tangent_onto_constraints(it, t);
    if (status == TVI_OK)
        status = tvi_step(tangent->lifted_integrator, step->h, &t, tangent->lifted_q, tangent->lifted_p);
    for (int i = 0; i < n && status == TVI_OK; i++) {
        column[i] = ldexp(dq[i], exponent);
        column[n + i] = ldexp(dp[i], exponent);
    }
    return status;
}

/* ---- Neighbouring orbits at equal times -------------------------------------------------------------------------- */

/* Computes the gradient (K_q, K_p) of a rescaled system's Hamiltonian K at a state. */
static tvi_status compute_K_gradient(const tvi_integrator *it, const double parameters[], const double q[],
                                     const double p[])
{
    const jet_tape *tape = it->stepped->field_values;
    const tvi_tangent *tangent = it->tangent;
    const size_t n = (size_t)tangent->n, bytes = n * sizeof *q;
    memcpy(tangent->field_block, q, bytes);
    memcpy(tangent->field_block + n, p, bytes);
    jet_tape_set_parameters(tape, tangent->field_block, 1, tvi_system_parameters(it->system), 1, parameters);
    if (!jet_sweep_values(tape, tangent->field_block, 1)) return TVI_EDOMAIN;
    for (size_t i = 0; i < 2 * n; i++) tangent->gradient[i] = tangent->field_block[tape->output_slot[i]];
    return TVI_OK;
}

/* Sets the component of the column that belongs to e, the constant of K = g (H + e) of a rescaled system. A
 * neighbouring orbit at the same time has an e of its own, since K = 0 on each orbit: dK = 0 and K_e = g give de =
 * -(K_q dq + K_p dp) / g. */
static tvi_status set_column_de(const tvi_integrator *it, const differentiated_step *step)
{
    const tvi_tangent *tangent = it->tangent;
    const jet_tape *tape = tangent->lifted_system->energy.tape;
    const int n = tangent->n, e = 2 * n - 1;
    tvi_status status = compute_K_gradient(it, step->parameters, step->start->q, step->start->p);
    if (status == TVI_OK) status = set_lifted_parameters(it, step, 0);
    if (status != TVI_OK) return status;
    set_state_and_scaled_tangent(it, step, 0);
    memcpy(tangent->energy_block, tangent->lifted_q, 4 * (size_t)n * sizeof *tangent->lifted_q);
    jet_tape_set_parameters(tape, tangent->energy_block, 1, tvi_system_parameters(tangent->lifted_system), 1,
                            tangent->parameters_and_rates);
    const bool inside = jet_sweep_values(tape, tangent->energy_block, 1);
    tangent->column[e] = -tangent->energy_block[tape->output_slot[0]] / tangent->gradient[e];
    return inside ? TVI_OK : TVI_EDOMAIN;
}

/* Projects the column to the time of the orbit. After a step in s a neighbouring orbit is at another time. It is moved
 * back along the flow by the difference dt of the times: dq - dt K_p / g, dp + dt K_q / g. */
static tvi_status project_column_to_fixed_time(const tvi_integrator *it, const differentiated_step *step)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = tangent->n;
    const tvi_status status = compute_K_gradient(it, step->parameters, tangent->lifted_q,
                                                 tangent->lifted_p + (tangent->are_momenta_swapped ? n : 0));
    const double ds = tangent->column[n - 1] / tangent->gradient[2 * n - 1];
    for (int i = 0; i < n; i++) {
        tangent->column[i] -= tangent->gradient[n + i] * ds;
        tangent->column[n + i] += tangent->gradient[i] * ds;
    }
    return status;
}

/* Copies a column of the user's matrix D to the tangent's memory. The component of e, the constant -H of a rescaled
 * system's K = g (H + e), is set to 0. */
static void load_column_from_user(const tvi_integrator *it, const double D[], size_t row_stride)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = it->system->n, dimension = tangent->n, parameters = tvi_system_parameters(it->system);
    double *dq = tangent->column, *dp = dq + dimension, *rate = dp + dimension;
    memset(dq, 0, 2 * (size_t)dimension * sizeof *dq);
    for (int row = 0; row < n; row++) {
        dq[row] = D[(size_t)row * row_stride];
        dp[row] = D[(size_t)(n + row) * row_stride];
    }
    for (int i = 0; i < parameters; i++) rate[i] = D[(size_t)(2 * n + i) * row_stride];
}

/* Computes the product of M and the loaded column, and writes it to `product`, a column of a matrix whose rows are
 * row_stride numbers apart. */
static tvi_status multiply_column_by_jacobian(const tvi_integrator *it, const differentiated_step *step,
                                              double product[], size_t row_stride)
{
    const tvi_tangent *tangent = it->tangent;
    const int n = it->system->n;
    const bool rescaled = tangent->field_block != NULL;
    const double *dq = tangent->column, *dp = dq + tangent->n;
    tvi_status status = tangent->energy_block ? set_column_de(it, step) : TVI_OK;
    if (status == TVI_OK) status = multiply_column_at_fixed_s(it, step);
    if (status == TVI_OK && rescaled) status = project_column_to_fixed_time(it, step);
    for (int row = 0; row < n; row++) {
        product[(size_t)row * row_stride] = dq[row];
        product[(size_t)(n + row) * row_stride] = dp[row];
    }
    if (status != TVI_OK || (tvi_all_finite(n, dq) && tvi_all_finite(n, dp))) return status;
    return jet_refuse(TVI_ENONFINITE, "it overflows");
}

/* Computes product = M columns, where M is the Jacobian matrix of the step. Rows of the parameters are not written.
 * The caller has allocated the integrator's memory by tvi_integrator_allocate_tangents. On failure `product` is
 * undefined. */
static tvi_status multiply_columns_by_jacobian(const tvi_integrator *it, const differentiated_step *step,
                                               const tvi_tangent_columns *columns, const tvi_tangent_columns *product)
{
    const size_t row_stride = (size_t)columns->count * columns->element_spacing,
                 out_row_stride = (size_t)product->count * product->element_spacing;
    for (int i = 0; i < columns->count; i++) {
        load_column_from_user(it, columns->elements + (size_t)i * columns->element_spacing, row_stride);
        const tvi_status status = multiply_column_by_jacobian(
            it, step, product->elements + (size_t)i * product->element_spacing, out_row_stride);
        if (status != TVI_OK) return jet_refuse(status, "column %d of D: %s", i, jet_last_refusal_text());
    }
    return TVI_OK;
}

tvi_status tvi_columns_check_finite(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    const int rows = 2 * it->system->n + tvi_system_parameters(it->system);
    for (int row = 0; row < rows; row++)
        for (int i = 0; i < columns->count; i++)
            if (!isfinite(
                    columns->elements[((size_t)row * (size_t)columns->count + (size_t)i) * columns->element_spacing]))
                return jet_refuse(TVI_ENONFINITE, "row %d of D is not finite", row);
    return TVI_OK;
}

/* ---- The columns of a run ---------------------------------------------------------------------------------------- */

static size_t count_column_elements(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    return (2 * (size_t)it->system->n + (size_t)tvi_system_parameters(it->system)) * (size_t)columns->count;
}

static void copy_columns_from_user(const tvi_integrator *it, const tvi_tangent_columns *columns, double elements[])
{
    const size_t count = count_column_elements(it, columns);
    for (size_t i = 0; i < count; i++) elements[i] = columns->elements[i * columns->element_spacing];
}

static void copy_columns_to_user(const tvi_integrator *it, const tvi_tangent_columns *columns, const double elements[])
{
    const size_t count = count_column_elements(it, columns);
    for (size_t i = 0; i < count; i++) columns->elements[i * columns->element_spacing] = elements[i];
}

bool tvi_columns_match_last_step_end(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    const tvi_tangent *tangent = it->tangent;
    if (!columns->elements) return true;
    if (!tangent || tangent->last_step.step_number == 0 || tangent->last_step.step_number != it->stats.steps ||
        tangent->last_step.propagated_count != columns->count)
        return false;
    for (size_t i = 0; i < count_column_elements(it, columns); i++)
        if (tvi_double_bits(columns->elements[i * columns->element_spacing]) !=
            tvi_double_bits(tangent->last_step.at_end[i]))
            return false;
    return true;
}

tvi_status tvi_columns_allocate(tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (!columns->elements) return TVI_OK;
    tvi_status status = columns->are_moved_together ? tvi_at_once_check(it) : TVI_OK;
    if (status == TVI_OK) status = tvi_integrator_allocate_tangents(it, columns->count);
    if (status == TVI_OK && columns->are_moved_together)
        status = tvi_at_once_provide(&it->tangent->at_once, it, columns->count, columns->elements);
    return status;
}

void tvi_columns_store_run_start(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (tvi_columns_match_last_step_end(it, columns)) return;
    copy_columns_from_user(it, columns, it->tangent->last_step.at_end);
    it->tangent->last_step.step_number = 0;
}

tvi_status tvi_columns_propagate_by_step(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (!columns->elements) return TVI_OK;
    tvi_tangent *tangent = it->tangent;
    const tvi_tangent_columns start = {tangent->last_step.at_start, columns->count, 1, false},
                              end = {tangent->last_step.at_end, columns->count, 1, false};
    const size_t bytes = count_column_elements(it, columns) * sizeof *end.elements;
    copy_columns_from_user(it, columns, start.elements);
    const bool goes_on =
        tangent->last_step.step_number == it->stats.steps - 1 && memcmp(start.elements, end.elements, bytes) == 0;
    memcpy(end.elements, start.elements, bytes);
    tangent->last_step.step_number = 0;
    tvi_status status = tvi_columns_check_finite(it, &start);
    if (status == TVI_OK)
        status =
            columns->are_moved_together
                ? tvi_at_once_multiply(tangent->at_once, it, start.elements, goes_on, end.elements)
                : multiply_columns_by_jacobian(
                      it, &(differentiated_step){&it->last_step.start, it->parameters, it->last_step.h}, &start, &end);
    if (status != TVI_OK) return status;
    tangent->last_step.step_number = it->stats.steps;
    tangent->last_step.propagated_count = columns->count;
    copy_columns_to_user(it, columns, end.elements);
    return TVI_OK;
}

tvi_status tvi_columns_propagate_to_offset(const tvi_integrator *it, const tvi_tangent_columns *columns, double offset,
                                           const double parameters[])
{
    if (!columns->elements) return TVI_OK;
    const tvi_tangent *tangent = it->tangent;
    const tvi_tangent_columns start = {tangent->last_step.at_start, columns->count, 1, false};
    tvi_columns_restore_step_end(it, columns);
    if (offset == it->last_step.h) return TVI_OK;
    tvi_columns_restore_step_start(it, columns);
    if (offset == 0) return TVI_OK;
    const tvi_status status =
        columns->are_moved_together
            ? tvi_at_once_multiply_by_part(tangent->at_once, it, start.elements, parameters, offset, columns->elements)
            : multiply_columns_by_jacobian(it, &(differentiated_step){&it->last_step.start, parameters, offset}, &start,
                                           columns);
    if (status != TVI_OK) tvi_columns_restore_step_end(it, columns);
    return status;
}

void tvi_columns_restore_step_end(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (columns->elements) copy_columns_to_user(it, columns, it->tangent->last_step.at_end);
}

void tvi_columns_restore_step_start(const tvi_integrator *it, const tvi_tangent_columns *columns)
{
    if (columns->elements) copy_columns_to_user(it, columns, it->tangent->last_step.at_start);
}
