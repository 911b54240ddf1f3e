/* refine.c - computes the increments of a Taylor curve X(s) beyond its roundoff, by the defect d that roundoff leaves,
 * in long double (docs/method.md section 6):
 *     separable      d = h^2 M^-1 F(Q) - Q'',      dq = Q(1) - q + int (1 - s) d,   h M^-1 dp = Q'(1) - Q'(0) + int d,
 *     Hamiltonian    d = h (H_p, -H_q)(X) - X',    (dq, dp) = X(1) - X(0) + int d,
 * with the state and its low-order part in X(0), and in Q'(0) = h M^-1 p. At the steps of reach.h coefficient k is
 * e^(-2 k) of the state, and its roundoff is the same part of the state's. High coefficients are therefore summed in
 * double precision, and d is nearly a polynomial of low degree, for which Gauss' two nodes suffice. */
#include "generating/refine.h"
#include "algebra/weigh.h"

/* Larger tolerances have errors larger than roundoff. */
static const double BELOW = 1e-13;

/* The two nodes have equal weights. */
enum { NODES = 2 };
static const long double node[NODES] = {0.211324865405187117745L, 0.788675134594812882255L};

/* The sums are X at the nodes; Q'' or X' there; X(1); Q'(1). */
enum { VALUE, RATE = NODES, END = 2 * NODES, SLOPE, LOW = TVI_REFINE_LOW };

/* An attempt holds the step that is being made. */
typedef struct {
    const tvi_refinement *refinement;
    const tvi_curve *curve;
    const tvi_system *system;
    const tvi_origin *origin;
    long double h;
} attempt;

bool tvi_refines(const tvi_system *system, double tolerance)
{
    return tolerance < BELOW && system->form != TVI_LAGRANGIAN;
}

/* ---- The tables -------------------------------------------------------------------------------------------------- */

void tvi_refinement_take(tvi_refinement *r, tvi_arena *arena, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const size_t inputs = (size_t)system->inputs, slots = (size_t)system->field_values->slots;
    long double **const vectors[] = {&r->start, &r->drift, &r->sum, &r->defect, &r->once, &r->twice, &r->y};
    for (int i = 0; i < 7; i++) *vectors[i] = tvi_arena_allocate(arena, (i < 6 ? inputs : slots) * sizeof **vectors[i]);
    r->first = system->form == TVI_SEPARABLE ? 2 : 1;
    r->high = tvi_arena_doubles(arena, TVI_REFINE_SUMS * ((size_t)curve->top + 1));
    r->rest = tvi_arena_doubles(arena, inputs);
    r->block = tvi_arena_allocate_block(arena, system->field_values, 1, 1, 0);
}

void tvi_refinement_prepare(tvi_refinement *r, const tvi_curve *curve)
{
    long double power[NODES] = {1, 1};
    for (int k = 0; k <= curve->top; k++) {
        long double weight[TVI_REFINE_SUMS] = {[END] = 1, [SLOPE] = k};
        for (int j = 0; j < NODES; j++) {
            weight[VALUE + j] = power[j];
            weight[RATE + j] = r->first == 2 ? k * (k - 1) * power[j] / (node[j] * node[j]) : k * power[j] / node[j];
            power[j] *= node[j];
        }
        for (int sum = 0; sum < TVI_REFINE_SUMS && k >= r->first; sum++)
            if (k <= LOW) r->low[sum][k] = weight[sum];
            else r->high[sum * (curve->top + 1) + k] = (double)weight[sum];
    }
}

/* ---- The defect -------------------------------------------------------------------------------------------------- */

static const long double *sum_of(const attempt *a, int which)
{
    const tvi_refinement *r = a->refinement;
    const tvi_curve *curve = a->curve;
    const size_t orders = (size_t)curve->top + 1, inputs = (size_t)a->system->inputs;
    const int top = curve->top < LOW ? curve->top : LOW;
    memset(r->rest, 0, inputs * sizeof *r->rest);
    tvi_add_weighted_rows(orders, r->high + (size_t)which * orders, tvi_curve_slots(curve), inputs, curve->x, r->rest);
    for (size_t i = 0; i < inputs; i++) {
        r->sum[i] = r->rest[i];
        for (int k = top; k >= r->first; k--) r->sum[i] += r->low[which][k] * tvi_curve_input(curve, k)[i];
    }
    return r->sum;
}

static void start(const attempt *a)
{
    const int n = a->system->n;
    const tvi_origin *o = a->origin;
    const tvi_refinement *r = a->refinement;
    for (int i = 0; i < n; i++) {
        const long double p = o->p[i] + (long double)o->p_low[i];
        r->start[i] = o->q[i] + (long double)o->q_low[i];
        if (a->system->form == TVI_SEPARABLE) r->drift[i] = a->h * p / a->system->mass[i];
        else r->start[n + i] = p;
    }
}

/* Returns the rate of input i in the step, from the field. */
static long double rate_of(const attempt *a, int i)
{
    const int n = a->system->n, *output = a->system->field_values->output;
    const long double *y = a->refinement->y, h = a->h;
    if (a->system->form == TVI_SEPARABLE) return h * y[output[i]] / a->system->mass[i] * h;
    return i < n ? h * y[output[n + i]] : -h * y[output[i - n]];
}

static void find_defect(const attempt *a, int j)
{
    const tvi_refinement *r = a->refinement;
    const int inputs = a->system->inputs;
    const long double *sum = sum_of(a, VALUE + j);
    for (int i = 0; i < inputs; i++) r->y[i] = r->start[i] + (node[j] * r->drift[i] + sum[i]);
    if (a->system->uses_time) r->y[inputs] = a->origin->t + (a->origin->t_low + node[j] * a->h);
    jet_sweep_long_double_values(a->system->field_values, r->block, r->y);
    sum = sum_of(a, RATE + j);
    for (int i = 0; i < inputs; i++) r->defect[i] = rate_of(a, i) - sum[i];
}

static void integrate_defect(const attempt *a)
{
    const tvi_refinement *r = a->refinement;
    const size_t bytes = (size_t)a->system->inputs * sizeof *r->once;
    memset(r->once, 0, bytes);
    memset(r->twice, 0, bytes);
    for (int j = 0; j < NODES; j++) {
        find_defect(a, j);
        for (int i = 0; i < a->system->inputs; i++) {
            r->once[i] += r->defect[i] / NODES;
            r->twice[i] += (1 - node[j]) * r->defect[i] / NODES;
        }
    }
}

/* ---- The increments ---------------------------------------------------------------------------------------------- */

static void split(long double x, double *high, double *low)
{
    *high = (double)x;
    *low = (double)(x - *high);
}

void tvi_refine(const tvi_refinement *r, const tvi_curve *curve, double h, const tvi_origin *origin,
                const tvi_increments *increments)
{
    const tvi_system *system = curve->system;
    const attempt a = {r, curve, system, origin, h};
    const int n = system->n;
    start(&a);
    integrate_defect(&a);
    const bool separable = system->form == TVI_SEPARABLE;
    const long double *sum = sum_of(&a, END), *of_q = separable ? r->twice : r->once;
    for (int i = 0; i < n; i++) split(r->drift[i] + (sum[i] + of_q[i]), &increments->dq[i], &increments->dq_low[i]);
    if (separable) sum = sum_of(&a, SLOPE);
    for (int i = 0; i < n; i++) {
        const int at = separable ? i : n + i;
        const long double rise = sum[at] + r->once[at];
        split(separable ? system->mass[i] / a.h * rise : rise, &increments->dp[i], &increments->dp_low[i]);
    }
}
