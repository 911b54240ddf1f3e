/* jacobian.c - the Jacobians of a curve with respect to its centre data, as matrices, by tangents in all directions;
 * what is made of them, or of products.h. */
#include "generating/products.h"

#include <string.h>

/* ---- Matrices ---------------------------------------------------------------------------------------------------- */

/* A block of directions: tangents of order k of slot i are at dx + k * order + i * lanes. */
typedef struct {
    size_t lanes, order;
    int first;
} block;

static double *tangent(const tvi_curve *curve, const block *b, int k, int slot)
{
    return curve->dx + (size_t)k * b->order + (size_t)slot * b->lanes;
}

static const double *field_tangent(const tvi_curve *curve, const block *b, int k, int i)
{
    return tangent(curve, b, k, curve->system->field_series->output[i]);
}

/* out = factor * in, over the lanes. */
static void scale_lanes(size_t lanes, double factor, const double *in, double *out)
{
    for (size_t lane = 0; lane < lanes; lane++) out[lane] = factor * in[lane];
}

/* dz = unit vectors: where the components of z stand among the inputs. */
static void seed_directions(tvi_curve *curve, const block *b)
{
    const tvi_form form = curve->system->form;
    const int n = curve->n;
    for (size_t lane = 0; lane < b->lanes; lane++) {
        const int direction = b->first + (int)lane;
        if (direction < n) tangent(curve, b, 0, direction)[lane] = 1;
        else if (form == TVI_SEPARABLE) tangent(curve, b, 1, direction - n)[lane] = 1;
        else tangent(curve, b, 0, direction)[lane] = form == TVI_LAGRANGIAN ? 1 / curve->tau : 1;
    }
}

/* All orders at once, where there is generated code for so many directions. */
static void differentiate_explicit(tvi_curve *curve, const block *b)
{
    const jet_tape *tape = curve->system->field_series;
    const bool is_separable = curve->system->form == TVI_SEPARABLE;
    const tvi_recurrence of = {curve->n, b->order, tape->output, curve->dx, curve->kappa, curve->tau};
    const tvi_curve_code *code = tvi_curve_code_of(curve);
    const int lanes = (int)b->lanes;
    if (code && code->lanes == lanes) {
        code->differentiate(curve->x, curve->dx, curve->kappa, curve->tau);
        return;
    }
    for (int k = 0; k + 1 + is_separable <= curve->top; k++) {
        jet_sweep_tangents(tape, curve->x, curve->dx, k, lanes);
        if (is_separable) tvi_tangents_separable(&of, k, lanes);
        else tvi_tangents_hamiltonian(&of, k, lanes);
    }
}

/* The tangent of the recurrence, whose matrix at the highest order is L_vv again. */
static void differentiate_lagrangian(tvi_curve *curve, const block *b)
{
    const jet_tape *tape = curve->system->field_series;
    const int n = curve->n;
    double *rest = curve->columns;
    jet_sweep_tangents(tape, curve->x, curve->dx, 0, (int)b->lanes);
    for (int k = 1; k <= curve->top; k++) {
        for (int i = 0; i < n; i++) {
            scale_lanes(b->lanes, curve->tau / k, tangent(curve, b, k - 1, n + i), tangent(curve, b, k, i));
            scale_lanes(b->lanes, 0, tangent(curve, b, k, i), tangent(curve, b, k, n + i));
        }
        jet_sweep_tangents(tape, curve->x, curve->dx, k, (int)b->lanes);
        for (size_t lane = 0; lane < b->lanes; lane++) {
            for (int i = 0; i < n; i++)
                rest[i] =
                    curve->tau / k * field_tangent(curve, b, k - 1, i)[lane] - field_tangent(curve, b, k, n + i)[lane];
            tvi_factor_solve(&curve->slope, rest);
            for (int i = 0; i < n; i++) tangent(curve, b, k, n + i)[lane] = rest[i];
        }
        if (k < curve->top) jet_sweep_tangents(tape, curve->x, curve->dx, k, (int)b->lanes);
    }
}

/* Copies the tangents of a slot for each coefficient and component into columns first .. of a Jacobian. */
static void store(const tvi_curve *curve, const block *b, const int slot_of_component[], int first_slot,
                  double *jacobian)
{
    const size_t n = (size_t)curve->n;
    for (int k = 0; k <= curve->top; k++)
        for (size_t i = 0; i < n; i++) {
            const int slot = slot_of_component ? slot_of_component[i] : first_slot + (int)i;
            scale_lanes(b->lanes, 1, tangent(curve, b, k, slot), jacobian + ((size_t)k * n + i) * 2 * n + b->first);
        }
}

static void differentiate_block(tvi_curve *curve, const block *b)
{
    const tvi_system *system = curve->system;
    const int n = curve->n;
    /* the layout depends on the number of lanes, so that constants too must be cleared */
    const size_t fixed = (size_t)(system->field_series->inputs + system->field_series->constants) * b->lanes;
    for (int k = 0; k <= curve->top; k++) memset(tangent(curve, b, k, 0), 0, fixed * sizeof(double));
    seed_directions(curve, b);
    switch (system->form) {
    case TVI_SEPARABLE: differentiate_explicit(curve, b); break;
    case TVI_LAGRANGIAN:
        differentiate_lagrangian(curve, b);
        store(curve, b, system->field_series->output + n, 0, curve->dU);
        break;
    case TVI_HAMILTONIAN:
        differentiate_explicit(curve, b);
        store(curve, b, NULL, n, curve->dU);
        break;
    }
    store(curve, b, NULL, 0, curve->dQ);
}

void tvi_curve_differentiate(tvi_curve *curve)
{
    const size_t directions = 2 * (size_t)curve->n;
    for (size_t first = 0; first < directions; first += TVI_CURVE_LANES) {
        const size_t left = directions - first, lanes = left < TVI_CURVE_LANES ? left : TVI_CURVE_LANES;
        const block b = {lanes, tvi_curve_slots(curve) * lanes, (int)first};
        differentiate_block(curve, &b);
    }
}

static const double *jacobians(const tvi_curve *curve, const tvi_combination *combination)
{
    return combination->of_momentum ? curve->dU : curve->dQ;
}

/* out[width] = sum_r weight[r] row[r], in the vectors of the tape. */
static void weigh_rows(const tvi_curve *curve, int rows, const double weight[], int width, const double *row,
                       double out[])
{
    curve->system->field_series->sweeps->combine(rows, weight, 1, width, row, out);
}

void tvi_curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[])
{
    weigh_rows(curve, curve->top + 1, combination->weight, 2 * curve->n * curve->n, jacobians(curve, combination),
               matrix);
}

/* Matrices take their directions in blocks, the last one of what is left. */
tvi_uses tvi_curve_uses(const tvi_system *system, const tvi_options *options, int top, tvi_jacobians jacobians)
{
    const int directions = 2 * system->n, left = directions % TVI_CURVE_LANES;
    const bool is_whole = system->form != TVI_LAGRANGIAN;
    tvi_uses used = {.series = {.name = "tvi_series", .lanes = {1}, .top = top, .has_series = !is_whole},
                     .member = "curve",
                     .emit_loops = is_whole ? tvi_curve_emit_series : NULL};
    if (jacobians == TVI_NO_JACOBIANS) return used;
    used.series.has_adjoints = jacobians == TVI_JACOBIAN_PRODUCTS;
    if (used.series.has_adjoints) used.series.directions[0] = 1;
    else if (is_whole) used.series.directions[0] = directions < TVI_CURVE_LANES ? 0 : left;
    else if (directions < TVI_CURVE_LANES) used.series.directions[0] = left;
    else used.series.directions[0] = TVI_CURVE_LANES, used.series.directions[1] = left;
    if (is_whole && !used.series.has_adjoints) used.emit_loops = tvi_curve_emit_matrices;
    used.values = (jet_emission){.name = "tvi_values", .lanes = {options->quadrature_points}};
    if (system->bend_values && options->nodes == TVI_NODES_TRUNCATED)
        used.bend = (jet_emission){.name = "tvi_bend", .lanes = {options->quadrature_points}};
    return used;
}

/* ---- Products with vectors --------------------------------------------------------------------------------------- */

void tvi_curve_aim(tvi_curve *curve, const double dz[])
{
    if (tvi_curve_has_products(curve)) tvi_products_aim(curve, dz);
    else memcpy(curve->dz, dz, 2 * (size_t)curve->n * sizeof *dz);
}

void tvi_curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const size_t n = (size_t)curve->n, directions = 2 * n;
    if (tvi_curve_has_products(curve)) {
        tvi_products_push(curve, combination, out);
        return;
    }
    memset(out, 0, n * sizeof *out);
    for (int k = curve->top; k >= 0; k--) {
        const double weight = combination->weight[k];
        if (weight == 0) continue;
        const double *dC = jacobians(curve, combination) + (size_t)k * n * directions;
        for (size_t i = 0; i < n; i++) {
            double sum = 0;
            for (size_t d = 0; d < directions; d++) sum += dC[i * directions + d] * curve->dz[d];
            out[i] += weight * sum;
        }
    }
}

void tvi_curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])
{
    if (tvi_curve_has_products(curve)) {
        tvi_products_pull(curve, seed_Q, out);
        return;
    }
    const int directions = 2 * curve->n, rows = (curve->top + 1) * curve->n;
    weigh_rows(curve, rows, seed_Q, directions, curve->dQ, out);
    if (!curve->dU || !seed_U) return;
    weigh_rows(curve, rows, seed_U, directions, curve->dU, curve->by_U);
    for (int d = 0; d < directions; d++) out[d] += curve->by_U[d];
}
