/* curve.c - the equations of motion as a recurrence for the coefficients of the curve (docs/method.md section 2):
 *     separable    (k+1)(k+2) Q_{k+2} = tau^2 M^-1 [s^k] F
 *     Lagrangian   (k+1) [s^{k+1}] L_v = tau [s^k] L_q, solved for the velocity's coefficient k+1 with L_vv at the
 * centre Hamiltonian  (k+1) Q_{k+1} = tau [s^k] H_p,  (k+1) P_{k+1} = -tau [s^k] H_q each with the field evaluated as a
 * power series along the curve, one order after the other. */
#include "curve.h"

#include <math.h>
#include <string.h>

enum {
    CURVE_LANES = 8,       /* directions of one tangent sweep: few enough to stay in the cache */
    PRODUCTS_FROM = 8     /* the n from which products are cheaper than matrices (docs/performance.md) */
};

static size_t slots(const tvi_curve *curve) { return (size_t)curve->system->field_series->slots; }

static size_t block_lanes(const tvi_curve *curve)
{
    return 2 * (size_t)curve->n < CURVE_LANES ? 2 * (size_t)curve->n : CURVE_LANES;
}

tvi_jacobians tvi_curve_jacobians_for(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE && system->n >= PRODUCTS_FROM ? TVI_JACOBIAN_PRODUCTS : TVI_JACOBIAN_MATRICES;
}

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians)
{
    const size_t orders = (size_t)top + 1, n = (size_t)system->n, jacobian = orders * n * 2 * n;
    memset(curve, 0, sizeof *curve);
    curve->system = system;
    curve->jacobians = jacobians;
    curve->n = system->n;
    curve->top = top;
    curve->kappa = tvi_arena_doubles(arena, n);
    curve->x = tvi_arena_doubles(arena, orders * slots(curve));
    if (jacobians == TVI_JACOBIAN_PRODUCTS) {
        curve->dx = tvi_arena_doubles(arena, orders * slots(curve));
        curve->bar = tvi_arena_doubles(arena, orders * slots(curve));
    }
    if (jacobians == TVI_JACOBIAN_MATRICES) {
        curve->dx = tvi_arena_doubles(arena, orders * slots(curve) * block_lanes(curve));
        curve->dz = tvi_arena_doubles(arena, 2 * n);
        curve->dQ = tvi_arena_doubles(arena, jacobian);
        curve->dU = system->form == TVI_SEPARABLE ? NULL : tvi_arena_doubles(arena, jacobian);
    }
    if (system->form != TVI_SEPARABLE) {
        tvi_factor_take(&curve->slope, arena, system->n);
        curve->columns = tvi_arena_doubles(arena, slots(curve) * n);
    }
}

void tvi_curve_prepare(tvi_curve *curve)
{
    jet_tape_prepare(curve->system->field_series, curve->x, curve->top + 1, 1);
    for (int i = 0; i < curve->n; i++) curve->kappa[i] = 1;
}

/* ---- Combinations ---------------------------------------------------------------------------------------------------
 */

tvi_combination tvi_combination_take(const tvi_curve *curve, tvi_arena *arena)
{
    return (tvi_combination){false, tvi_arena_doubles(arena, (size_t)curve->top + 1)};
}

void tvi_combination_set(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, const double weight[])
{
    const bool shifts = of_momentum && curve->system->form == TVI_SEPARABLE; /* U_k = (k+1) Q_{k+1} */
    combination->of_momentum = of_momentum && !shifts;
    combination->weight[0] = shifts ? 0 : weight[0];
    for (int k = 1; k <= curve->top; k++) combination->weight[k] = shifts ? k * weight[k - 1] : weight[k];
}

void tvi_combination_set_powers(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, int degree,
                                double a, double at, double b, double from)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    for (int k = 0; k <= degree; k++) weight[k] = a * pow(at, k) + b * pow(from, k);
    tvi_combination_set(combination, curve, of_momentum, weight);
}

/* ---- The series -----------------------------------------------------------------------------------------------------
 */

/* Coefficient k of the second input: velocity or momentum. */
static double *second_input(const tvi_curve *curve, int k) { return curve->x + (size_t)k * slots(curve) + curve->n; }

static double *first_input(const tvi_curve *curve, int k) { return curve->x + (size_t)k * slots(curve); }

/* Output i of the field at order k. */
static double field(const tvi_curve *curve, int k, int i)
{
    return curve->x[(size_t)k * slots(curve) + (size_t)curve->system->field_series->output[i]];
}

void tvi_curve_set(tvi_curve *curve, const double z[])
{
    const int n = curve->n;
    memcpy(first_input(curve, 0), z, (size_t)n * sizeof *z);
    switch (curve->system->form) {
    case TVI_SEPARABLE:
        memcpy(first_input(curve, 1), z + n, (size_t)n * sizeof *z);
        for (int i = 0; i < n; i++) curve->kappa[i] = curve->tau / curve->system->mass[i];
        break;
    case TVI_LAGRANGIAN:
        for (int i = 0; i < n; i++) second_input(curve, 0)[i] = z[n + i] / curve->tau;
        break;
    case TVI_HAMILTONIAN: memcpy(second_input(curve, 0), z + n, (size_t)n * sizeof *z); break;
    }
}

static tvi_status expand_separable(tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    for (int k = 0; k + 2 <= curve->top; k++) {
        if (!jet_sweep_series(system->field_series, curve->x, k, 1)) return TVI_EDOMAIN;
        double *next = first_input(curve, k + 2);
        const double factor = curve->tau * curve->tau / ((k + 1) * (k + 2));
        for (int i = 0; i < curve->n; i++) next[i] = factor / system->mass[i] * field(curve, k, i);
    }
    return TVI_OK;
}

static tvi_status expand_hamiltonian(tvi_curve *curve)
{
    const int n = curve->n;
    for (int k = 0; k + 1 <= curve->top; k++) {
        if (!jet_sweep_series(curve->system->field_series, curve->x, k, 1)) return TVI_EDOMAIN;
        const double factor = curve->tau / (k + 1);
        for (int i = 0; i < n; i++) {
            first_input(curve, k + 1)[i] = factor * field(curve, k, n + i);
            second_input(curve, k + 1)[i] = -factor * field(curve, k, i);
        }
    }
    return TVI_OK;
}

/* By tangents of order 0 along the second input. */
tvi_status tvi_curve_factor_slope(tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_series;
    const size_t n = (size_t)curve->n;
    memset(curve->columns, 0, 2 * n * n * sizeof *curve->columns);
    for (size_t i = 0; i < n; i++) curve->columns[(n + i) * n + i] = 1;
    if (curve->system->uses_time) memset(curve->columns + 2 * n * n, 0, n * sizeof *curve->columns);
    jet_sweep_tangents(tape, curve->x, curve->columns, 0, curve->n);
    for (size_t i = 0; i < n; i++)
        memcpy(curve->slope.lu + i * n, curve->columns + (size_t)tape->output[n + i] * n, n * sizeof(double));
    return tvi_factor_compute(&curve->slope);
}

/* Velocity V = (1/tau) dQ/ds. Order k of the field is run with V_k = 0, which leaves L_vv V_k out of [s^k] L_v; the
 * missing part is solved for and the order run again. */
static tvi_status expand_lagrangian(tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_series;
    const int n = curve->n;
    double *rest = curve->columns;
    if (!jet_sweep_series(tape, curve->x, 0, 1)) return TVI_EDOMAIN;
    const tvi_status status = tvi_curve_factor_slope(curve);
    if (status != TVI_OK) return status;
    for (int k = 1; k <= curve->top; k++) {
        for (int i = 0; i < n; i++) {
            first_input(curve, k)[i] = curve->tau / k * second_input(curve, k - 1)[i];
            second_input(curve, k)[i] = 0;
        }
        (void)jet_sweep_series(tape, curve->x, k, 1);
        for (int i = 0; i < n; i++) rest[i] = curve->tau / k * field(curve, k - 1, i) - field(curve, k, n + i);
        tvi_factor_solve(&curve->slope, rest);
        memcpy(second_input(curve, k), rest, (size_t)n * sizeof *rest);
        if (k < curve->top) (void)jet_sweep_series(tape, curve->x, k, 1);
    }
    return TVI_OK;
}

tvi_status tvi_curve_expand(tvi_curve *curve, double centre)
{
    const tvi_system *system = curve->system;
    curve->centre = centre;
    if (system->uses_time) {
        curve->x[system->inputs] = centre;
        if (curve->top > 0) first_input(curve, 1)[system->inputs] = curve->tau;
    }
    const tvi_status status = system->form == TVI_SEPARABLE    ? expand_separable(curve)
                              : system->form == TVI_LAGRANGIAN ? expand_lagrangian(curve)
                                                               : expand_hamiltonian(curve);
    if (status != TVI_OK) return status;
    const int inputs = system->inputs;
    for (int k = 0; k <= curve->top; k++)
        for (int i = 0; i < inputs; i++)
            if (!isfinite(first_input(curve, k)[i])) return TVI_ENONFINITE;
    return TVI_OK;
}

/* ---- The Jacobians --------------------------------------------------------------------------------------------------
 */

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

static void differentiate_separable(tvi_curve *curve, const block *b)
{
    for (int k = 0; k + 2 <= curve->top; k++) {
        jet_sweep_tangents(curve->system->field_series, curve->x, curve->dx, k, (int)b->lanes);
        const double factor = curve->tau * curve->tau / ((k + 1) * (k + 2));
        for (int i = 0; i < curve->n; i++)
            scale_lanes(b->lanes, factor / curve->system->mass[i], field_tangent(curve, b, k, i),
                        tangent(curve, b, k + 2, i));
    }
}

static void differentiate_hamiltonian(tvi_curve *curve, const block *b)
{
    const int n = curve->n;
    for (int k = 0; k + 1 <= curve->top; k++) {
        jet_sweep_tangents(curve->system->field_series, curve->x, curve->dx, k, (int)b->lanes);
        const double factor = curve->tau / (k + 1);
        for (int i = 0; i < n; i++) {
            scale_lanes(b->lanes, factor, field_tangent(curve, b, k, n + i), tangent(curve, b, k + 1, i));
            scale_lanes(b->lanes, -factor, field_tangent(curve, b, k, i), tangent(curve, b, k + 1, n + i));
        }
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
            memcpy(jacobian + ((size_t)k * n + i) * 2 * n + (size_t)b->first, tangent(curve, b, k, slot),
                   b->lanes * sizeof *jacobian);
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
    case TVI_SEPARABLE: differentiate_separable(curve, b); break;
    case TVI_LAGRANGIAN:
        differentiate_lagrangian(curve, b);
        store(curve, b, system->field_series->output + n, 0, curve->dU);
        break;
    case TVI_HAMILTONIAN:
        differentiate_hamiltonian(curve, b);
        store(curve, b, NULL, n, curve->dU);
        break;
    }
    store(curve, b, NULL, 0, curve->dQ);
}

void tvi_curve_differentiate(tvi_curve *curve)
{
    const size_t directions = 2 * (size_t)curve->n;
    for (size_t first = 0; first < directions; first += CURVE_LANES) {
        const size_t left = directions - first, lanes = left < CURVE_LANES ? left : CURVE_LANES;
        const block b = {lanes, slots(curve) * lanes, (int)first};
        differentiate_block(curve, &b);
    }
}

/* ---- Sums over the coefficients -------------------------------------------------------------------------------------
 */

void tvi_curve_momentum(const tvi_curve *curve, int k, double out[])
{
    const int n = curve->n;
    for (int i = 0; i < n; i++) switch (curve->system->form) {
        case TVI_SEPARABLE:
            out[i] = k < curve->top ? (k + 1) * first_input(curve, k + 1)[i] / curve->kappa[i] : 0;
            break;
        case TVI_LAGRANGIAN: out[i] = field(curve, k, n + i); break;
        case TVI_HAMILTONIAN: out[i] = second_input(curve, k)[i]; break;
        }
}

void tvi_curve_sum(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const int n = curve->n;
    const int *slot = curve->system->field_series->output + n;
    memset(out, 0, (size_t)n * sizeof *out);
    for (int k = curve->top; k >= 0; k--) {
        const double weight = combination->weight[k], *x = first_input(curve, k);
        if (weight == 0) continue;
        if (combination->of_momentum && curve->system->form == TVI_LAGRANGIAN) {
            for (int i = 0; i < n; i++) out[i] += weight * x[slot[i]];
        } else {
            const double *coefficient = x + (combination->of_momentum ? n : 0);
            for (int i = 0; i < n; i++) out[i] += weight * coefficient[i];
        }
    }
}

static const double *jacobians(const tvi_curve *curve, const tvi_combination *combination)
{
    return combination->of_momentum ? curve->dU : curve->dQ;
}

void tvi_curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[])
{
    const size_t size = 2 * (size_t)curve->n * (size_t)curve->n;
    memset(matrix, 0, size * sizeof *matrix);
    for (int k = curve->top; k >= 0; k--) {
        const double weight = combination->weight[k], *dC = jacobians(curve, combination) + (size_t)k * size;
        if (weight == 0) continue;
        for (size_t i = 0; i < size; i++) matrix[i] += weight * dC[i];
    }
}

/* ---- Products with the Jacobians ------------------------------------------------------------------------------------ */

/* dx of one lane along dz. */
static void sweep_direction(tvi_curve *curve, const double dz[])
{
    const size_t n = (size_t)curve->n, order = slots(curve);
    const block one = {1, order, 0};
    memset(curve->dx, 0, ((size_t)curve->top + 1) * order * sizeof *curve->dx);
    memcpy(curve->dx, dz, n * sizeof *dz);
    memcpy(curve->dx + order, dz + n, n * sizeof *dz);
    differentiate_separable(curve, &one);
}

void tvi_curve_aim(tvi_curve *curve, const double dz[])
{
    if (curve->jacobians == TVI_JACOBIAN_PRODUCTS) sweep_direction(curve, dz);
    else memcpy(curve->dz, dz, 2 * (size_t)curve->n * sizeof *dz);
}

void tvi_curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const size_t n = (size_t)curve->n, directions = 2 * n;
    const bool products = curve->jacobians == TVI_JACOBIAN_PRODUCTS;
    memset(out, 0, n * sizeof *out);
    for (int k = curve->top; k >= 0; k--) {
        const double weight = combination->weight[k];
        if (weight == 0) continue;
        if (products) {
            const double *dQ = curve->dx + (size_t)k * slots(curve);
            for (size_t i = 0; i < n; i++) out[i] += weight * dQ[i];
            continue;
        }
        const double *dC = jacobians(curve, combination) + (size_t)k * n * directions;
        for (size_t i = 0; i < n; i++) {
            double sum = 0;
            for (size_t d = 0; d < directions; d++) sum += dC[i * directions + d] * curve->dz[d];
            out[i] += weight * sum;
        }
    }
}

static void pull_rows(const tvi_curve *curve, const double jacobian[], const double seed[], double out[])
{
    const size_t directions = 2 * (size_t)curve->n;
    for (int row = (curve->top + 1) * curve->n - 1; row >= 0; row--) {
        if (seed[row] == 0) continue;
        for (size_t d = 0; d < directions; d++) out[d] += seed[row] * jacobian[(size_t)row * directions + d];
    }
}

static double *adjoint_of_Q(const tvi_curve *curve, int k) { return curve->bar + (size_t)k * slots(curve); }

static void clear_adjoints(tvi_curve *curve, int orders)
{
    memset(curve->bar, 0, (size_t)orders * slots(curve) * sizeof *curve->bar);
}

void tvi_curve_clear_seeds(tvi_curve *curve, int last) { clear_adjoints(curve, last + 1); }

void tvi_curve_add_seeds(tvi_curve *curve, int last, const double seed_Q[])
{
    for (int k = 0; k <= last; k++) {
        const double *seed = seed_Q + (size_t)k * (size_t)curve->n;
        double *bar = adjoint_of_Q(curve, k);
        for (int i = 0; i < curve->n; i++) bar[i] += seed[i];
    }
}

void tvi_curve_add_sum(tvi_curve *curve, int last, const tvi_combination *combination, double factor, const double x[])
{
    for (int k = 0; k <= last; k++) {
        const double weight = factor * combination->weight[k];
        double *bar = adjoint_of_Q(curve, k);
        for (int i = 0; weight != 0 && i < curve->n; i++) bar[i] += weight * x[i];
    }
}

/* fbar_k = tau^2 / ((k+1)(k+2)) M^-1 qbar_{k+2}, and on to the operands: the recurrence downward. */
void tvi_curve_pull_seeds(tvi_curve *curve, int last, double out[])
{
    const tvi_system *system = curve->system;
    const size_t n = (size_t)curve->n;
    for (int k = last - 2; k >= 0; k--) {
        const double factor = curve->tau * curve->tau / ((k + 1) * (k + 2)), *above = adjoint_of_Q(curve, k + 2);
        double *bar = adjoint_of_Q(curve, k);
        for (size_t i = 0; i < n; i++) bar[system->field_series->output[i]] += factor / system->mass[i] * above[i];
        jet_sweep_adjoints(system->field_series, curve->x, curve->bar, k);
    }
    memcpy(out, adjoint_of_Q(curve, 0), n * sizeof *out);
    memcpy(out + n, adjoint_of_Q(curve, 1), n * sizeof *out);
}

void tvi_curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])
{
    if (curve->jacobians == TVI_JACOBIAN_PRODUCTS) {
        tvi_curve_clear_seeds(curve, curve->top);
        tvi_curve_add_seeds(curve, curve->top, seed_Q);
        tvi_curve_pull_seeds(curve, curve->top, out);
        return;
    }
    memset(out, 0, 2 * (size_t)curve->n * sizeof *out);
    if (curve->dU && seed_U) pull_rows(curve, curve->dU, seed_U, out);
    pull_rows(curve, curve->dQ, seed_Q, out);
}

void tvi_curve_pull_force(tvi_curve *curve, const double x[], double out[])
{
    const jet_tape *tape = curve->system->field_series;
    clear_adjoints(curve, 1);
    for (int i = 0; i < curve->n; i++)
        curve->bar[tape->output[i]] += curve->tau * curve->tau / curve->system->mass[i] * x[i];
    jet_sweep_adjoints(tape, curve->x, curve->bar, 0);
    memcpy(out, curve->bar, (size_t)curve->n * sizeof *out);
}

static double largest(int n, const double x[])
{
    double size = 0;
    for (int i = 0; i < n; i++) size = fabs(x[i]) > size ? fabs(x[i]) : size;
    return size;
}

int tvi_curve_order_below(const tvi_curve *curve, double part)
{
    const double bound = part * largest(curve->n, first_input(curve, 0));
    int k = 1;
    while (k < curve->top && largest(curve->n, first_input(curve, k)) > bound) k++;
    return k;
}

double tvi_curve_tail(const tvi_curve *curve, int degree)
{
    const double q = largest(curve->n, first_input(curve, 0));
    return q > 0 ? largest(curve->n, first_input(curve, degree)) / q : 0;
}
