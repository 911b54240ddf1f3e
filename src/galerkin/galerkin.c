/* galerkin.c - the Galerkin curve: free values at m Gauss nodes, which is Gauss collocation (docs/method.md section 4).
 * With a, b, c its coefficients and F_j the field at node j,
 *     separable:    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *                   q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 *     else:         (Q, P)_i = (q0, p0) + h sum_j a_ij (V, F)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (V, F)_j,
 * with (V, F) = (H_p, -H_q), or L_v(Q, V) = P and F = L_q (galerkin_field.h). Solved by passes, which begin with what
 * the steps before lead to. The nodes are lanes of one sweep of the field's tape. */
#include "galerkin/dense.h"
#include "galerkin/field.h"
#include "algebra/quadrature.h"
#include "method/stepper.h"
#include "algebra/tail.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MAX_PASSES = 100, MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* The passes of a step. All sizes are squares, summed over all unknowns and lanes, relative to the sizes of the
 * unknowns. */
typedef struct {
    double moved, before; /* by the last pass, and the one before it; 0: none */
    double contraction;   /* of the last pass that was above roundoff */
    double slowest;       /* contraction of the last two such passes; of a Newton method, of the last */
    double expected;      /* movement of the last pass, without its roundoff */
    double roundoff;      /* what may be roundoff, as measured; 0: not yet */
    bool is_stuck;        /* the passes shrink no more */
} galerkin_progress;

/* The last two steps. */
typedef struct {
    double h, h_before; /* 0: none */
    double t;           /* where the last one began */
    double slowest;     /* contraction of its passes, or of those before it; 0: not known */
    int turn;           /* where its impulses are */
} galerkin_history;

typedef struct {
    const tvi_options *options;
    int n, points;
    galerkin_field field;
    double *from_one; /* [j][lanes] extrapolation from a step of size h / ratio to one that begins after `part` of it */
    double ratio, part;         /* ratio 0: none yet */
    double *led;                /* [unknowns][lanes] what it leads to */
    double *from_two;           /* [2][j][i] the same from the two steps before, all of one size */
    double *c;                  /* [lanes] */
    double *factor;             /* [lanes][SUMS] */
    double *sum;                /* [unknowns][SUMS] */
    double *before, *displaced; /* [rows][lanes] scratch of the roundoff that is measured */
    double *drift, *drift_low;  /* [unknowns] h M^-1 p0 of a separable system, in two parts; else 0 */
    double *low;                /* [unknowns] low-order parts of the start */
    galerkin_dense dense;
    double *rise;       /* [2n] what multiplies the integrals of the impulses in q and p */
    double *none, *one; /* [unknowns + lanes] 0 and 1 */
    galerkin_history *last;
    double *impulses[2]; /* in the history: [unknowns][lanes] of the last two steps, in turns */
    long double exact_node[MAX_LANES], exact_weight[MAX_LANES];
    long double unit[MAX_LANES]; /* 1 / prod_{k != j} (c_j - c_k) */
} galerkin;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static int lanes_for(int points)
{
    int lanes = 1;
    while (lanes < points && lanes < 8) lanes *= 2;
    return points <= lanes ? lanes : MAX_LANES;
}

/* Those of the instruction set that the system's tapes run with. */
static const galerkin_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_galerkin_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_galerkin_loops_avx2,
    [jet_isa_avx512] = &tvi_galerkin_loops_avx512,
#endif
};

static size_t unknowns_size(const galerkin *w)
{
    return (size_t)w->field.nodes.unknowns * (size_t)w->field.nodes.lanes * sizeof(double);
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin *taken = tvi_arena_take(arena, sizeof *taken);
    galerkin w = {.options = options, .n = system->n, .points = options->degree};
    w.field =
        (galerkin_field){.system = system, .points = w.points, .loops = loops_of[system->field_values->sweeps->isa]};
    w.field.form = system->form == TVI_LAGRANGIAN ? &tvi_galerkin_form_lagrangian : &tvi_galerkin_form_plain;
    galerkin_nodes *nodes = &w.field.nodes;
    nodes->unknowns = system->inputs;
    nodes->lanes = lanes_for(w.points);
    const size_t unknowns = (size_t)nodes->unknowns, lanes = (size_t)nodes->lanes;
    w.last = tvi_arena_history(arena, sizeof *w.last);
    for (int i = 0; i < 2; i++) w.impulses[i] = tvi_arena_history(arena, unknowns * lanes * sizeof(double));
    nodes->base = tvi_arena_doubles(arena, unknowns * lanes);
    w.field.matrix = tvi_arena_doubles(arena, lanes * lanes);
    w.from_one = tvi_arena_doubles(arena, lanes * lanes);
    w.none = tvi_arena_doubles(arena, unknowns + lanes);
    w.one = tvi_arena_doubles(arena, unknowns + lanes);
    w.led = tvi_arena_doubles(arena, unknowns * lanes);
    w.rise = tvi_arena_doubles(arena, 2 * (size_t)w.n);
    w.from_two = tvi_arena_doubles(arena, 2 * lanes * lanes);
    w.field.b = tvi_arena_doubles(arena, lanes);
    w.c = tvi_arena_doubles(arena, lanes);
    nodes->weight = tvi_arena_doubles(arena, lanes);
    nodes->impulse = tvi_arena_doubles(arena, unknowns * lanes);
    w.factor = tvi_arena_doubles(arena, lanes * SUMS);
    w.sum = tvi_arena_doubles(arena, unknowns * SUMS);
    tvi_galerkin_dense_take(&w.dense, arena, w.points, nodes->lanes, system->field_values->sweeps);
    double **const vectors[] = {&nodes->start, &nodes->scale, &nodes->inverse_size, &w.drift, &w.drift_low, &w.low};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) *vectors[i] = tvi_arena_doubles(arena, unknowns);
    w.field.slot = tvi_arena_take(arena, unknowns * sizeof(int));
    w.field.form->take(&w.field, arena);
    w.before = tvi_arena_doubles(arena, (size_t)w.field.rows * lanes);
    w.displaced = tvi_arena_doubles(arena, (size_t)w.field.rows * lanes);
    if (taken) *taken = w;
    return taken;
}

/* l_j(s), the polynomial that is 1 at node j and 0 at the others. */
static long double lagrange(const galerkin *w, int j, long double s)
{
    long double product = w->unit[j];
    for (int k = 0; k < w->points; k++)
        if (k != j) product *= s - w->exact_node[k];
    return product;
}

/* int_0^s l_j and int_0^s (s - r) l_j(r) dr, by the Gauss rule on [0, s]: exact. */
static void integrate_lagrange(const galerkin *w, int j, long double s, long double *once, long double *twice)
{
    *once = *twice = 0;
    for (int k = 0; k < w->points; k++) {
        const long double term = s * w->exact_weight[k] * lagrange(w, j, s * w->exact_node[k]);
        *once += term;
        *twice += s * (1 - w->exact_node[k]) * term;
    }
}

/* What drives an unknown is sum_k f_k P_k(x), x in [-1, 1], P_k Legendre's polynomials. Its power x^k, k = m - 1, has
 * the factor 2^-k sum_j unit_j F_j, and that of P_k is 2^-k (2k)! / k!^2: this times sum_j unit_j F_j is f_k, the last
 * term at the ends. */
static long double tail_factor(const galerkin *w)
{
    long double factor = 1;
    for (int k = 1; k < w->points; k++) factor *= (long double)k / (2 * (2 * k - 1));
    return factor;
}

static double on_grid(long double x, int bits) { return (double)ldexpl(rintl(ldexpl(x, bits)), -bits); }

/* c and b are on the grid 2^-53, where differences are exact; c_i + c_{m-1-i} = 1, b_i = b_{m-1-i} and sum b_j = 1 hold
 * as they stand. */
static void set_nodes(galerkin *w)
{
    const int m = w->points;
    double left = 1;
    tvi_quadrature_nodes(TVI_GAUSS, m, w->exact_node, w->exact_weight);
    for (int i = 0; i < m; i++) {
        w->exact_node[i] = (1 + w->exact_node[i]) / 2;
        w->exact_weight[i] /= 2;
    }
    for (int i = 0; i < (m + 1) / 2; i++) {
        w->c[i] = on_grid(w->exact_node[i], 53);
        w->c[m - 1 - i] = 1 - w->c[i];
        w->field.b[i] = w->field.b[m - 1 - i] = i < m - 1 - i ? on_grid(w->exact_weight[i], 53) : left;
        left -= 2 * w->field.b[i];
    }
    if (m % 2 == 0) w->field.b[m / 2 - 1] = w->field.b[m / 2] = w->field.b[m / 2] + left / 2;
    for (int i = m; i < w->field.nodes.lanes; i++) w->c[i] = w->c[m - 1];
    for (int j = 0; j < m; j++) {
        w->unit[j] = 1;
        for (int k = 0; k < m; k++)
            if (k != j) w->unit[j] /= w->exact_node[j] - w->exact_node[k];
        w->factor[j * SUMS + SUM_ONCE] = 1;
        w->factor[j * SUMS + SUM_TWICE] = 1 - w->c[j];
        w->factor[j * SUMS + SUM_TAIL] = (double)(w->unit[j] * tail_factor(w)) / w->field.b[j];
    }
}

/* Element (i, j), i >= j, of what multiplies impulses: (a a)_ij / b_j of a separable system, else a_ij / b_j, with
 * a_ij = int_0^{c_i} l_j. The product a a is not the double integral, whose method is not symplectic. */
static long double impulse_factor(const galerkin *w, long double a[][MAX_LANES], int i, int j)
{
    long double square = 0;
    for (int k = 0; k < w->points; k++) square += a[i][k] * a[k][j];
    return (galerkin_is_second_order(&w->field) ? square : a[i][j]) / w->exact_weight[j];
}

/* The elements nu_ij are on a grid, too, and those above the diagonal follow from the condition of symplecticity, which
 * so holds exactly: nu_ij - nu_ji = c_i - c_j of a separable system, else nu_ij + nu_ji = 1; and that of symmetry,
 * nu_ij = nu_{m-1-j, m-1-i}. */
static void set_matrix(galerkin *w)
{
    long double a[MAX_LANES][MAX_LANES], twice;
    const int m = w->points, lanes = w->field.nodes.lanes;
    const bool separable = galerkin_is_second_order(&w->field);
    double *matrix = w->field.matrix;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) integrate_lagrange(w, j, w->exact_node[i], &a[i][j], &twice);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            const long double exact = impulse_factor(w, a, i, j) + impulse_factor(w, a, m - 1 - j, m - 1 - i);
            const double nu = on_grid(exact / 2, 52);
            matrix[j * lanes + i] = nu;
            matrix[i * lanes + j] = separable ? nu - (w->c[i] - w->c[j]) : 1 - nu;
        }
    for (int lane = m; lane < lanes; lane++)
        for (int j = 0; j < m; j++) matrix[j * lanes + lane] = matrix[j * lanes + m - 1];
}

/* [k][i] of basis: polynomials of degree k, orthonormal on the first 2 m of 3 m points: the nodes of two steps, and of
 * the next one. */
static void set_basis(const galerkin *w, int degree, long double basis[][3 * MAX_LANES])
{
    const int m = w->points;
    for (int k = 0; k <= degree; k++) {
        long double *now = basis[k];
        for (int i = 0; i < 3 * m; i++) {
            const long double s = w->exact_node[i % m] + (i < m ? 0 : i < 2 * m ? -1 : 1);
            now[i] = k > 0 ? s * basis[k - 1][i] : 1;
        }
        for (int before = 0; before <= k; before++) { /* the last time: its own length */
            long double product = 0;
            /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): m >= 1 */
            for (int i = 0; i < 2 * m; i++) product += now[i] * basis[before][i];
            for (int i = 0; i < 3 * m && before < k; i++) now[i] -= product * basis[before][i];
            for (int i = 0; i < 3 * m && before == k; i++) now[i] /= sqrtl(product);
        }
    }
}

/* column[i] += factor (b_next / b_before) ahead[next][i]: what the impulse at node `before` of an earlier step makes of
 * the one at node `next`, if the factor is that of the drives. */
static void add_ahead(const galerkin *w, long double factor, int before, int next, double *column)
{
    const int lanes = w->field.nodes.lanes;
    const double part = (double)(factor * w->exact_weight[next] / w->exact_weight[before]);
    for (int i = 0; i < lanes; i++) column[i] += part * w->field.ahead[next * lanes + i];
}

/* Extrapolation of least squares, sum_k pi_k(1 + c_i) pi_k(s_j). Of all degrees, 3m/2 was seen to save the most passes:
 * above it roundoff grows by more than truncation falls. */
static void set_from_two(galerkin *w)
{
    long double basis[2 * MAX_LANES][3 * MAX_LANES];
    const int m = w->points, lanes = w->field.nodes.lanes, degree = m > 1 ? 3 * m / 2 : 1;
    set_basis(w, degree, basis);
    for (int point = 0; point < 2 * m; point++)
        for (int next = 0; next < m; next++) {
            long double factor = 0;
            for (int k = 0; k <= degree; k++) factor += basis[k][2 * m + next] * basis[k][point];
            double *column = w->from_two + (point / m * lanes + point % m) * lanes;
            add_ahead(w, factor, point % m, next, column);
        }
}

static void prepare(void *work)
{
    galerkin *w = work;
    set_nodes(w);
    set_matrix(w);
    tvi_galerkin_dense_prepare(&w->dense, w->field.nodes.lanes, w->exact_node);
    w->field.form->prepare(&w->field);
    set_from_two(w);
    for (int i = 0; i < w->field.nodes.unknowns + w->field.nodes.lanes; i++) w->one[i] = 1;
}

/* What depends on the size of the step alone. */
static void set_size(galerkin *w, double h)
{
    const galerkin_nodes *nodes = &w->field.nodes;
    if (h == w->field.h) return;
    w->field.h = h;
    for (int i = 0; i < nodes->lanes; i++) nodes->weight[i] = h * w->field.b[i];
    for (int u = 0; u < nodes->unknowns; u++)
        nodes->scale[u] = galerkin_is_second_order(&w->field) ? h / w->field.system->mass[u]
                          : u < w->n                          ? 1
                                                              : w->field.form->force_sign;
    for (int i = 0; i < w->n; i++) {
        w->rise[i] = nodes->scale[i];
        w->rise[w->n + i] = galerkin_is_second_order(&w->field) ? 1 : nodes->scale[w->n + i];
    }
}

/* From a step of size h / ratio to one that begins after a part of it: node i is at part + ratio c_i there. */
static void set_from_one(galerkin *w, double ratio, double part)
{
    if (ratio == w->ratio && part == w->part) return;
    w->ratio = ratio;
    w->part = part;
    const int lanes = w->field.nodes.lanes;
    const galerkin_places of_nodes = {lanes, lanes, w->points, w->c, w->none, w->none, w->one};
    double place[MAX_LANES] = {0}, P[MAX_LANES * MAX_LANES] = {0};
    for (int i = 0; i < lanes; i++) place[i] = part + ratio * w->c[i];
    tvi_galerkin_dense_legendre(&w->dense, lanes, place, P);
    w->field.loops->place(&of_nodes, P, w->dense.of_node, w->from_one);
    for (int j = 0; j < w->points; j++)
        for (int i = 0; i < lanes; i++) w->from_one[j * lanes + i] *= ratio * w->field.b[i];
}

/* The times of the nodes of a step of size h. */
static void set_times(galerkin *w, const tvi_origin *origin, double h)
{
    double t[MAX_LANES];
    if (!w->field.system->uses_time) return;
    for (int i = 0; i < w->field.nodes.lanes; i++) t[i] = origin->t + (origin->t_low + h * w->c[i]);
    tvi_system_set_time(w->field.system, w->field.inputs, w->field.nodes.lanes, t);
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static void set_base(const galerkin *w)
{
    w->field.loops->set_base(&w->field.nodes, w->c, w->low, w->drift, w->drift_low);
}

/* drift + drift_low = h M^-1 (p + p_low). Rounded products with one and the same h are not on average right, if h is
 * nearly a ratio of small numbers, such as 0.1: their errors repeat themselves, with a mean that many steps show. */
static void set_drift(galerkin *w, const tvi_origin *origin)
{
    for (int u = 0; u < w->n; u++) {
        const double scale = w->field.nodes.scale[u];
        w->drift[u] = tvi_two_product(scale, origin->p[u], &w->drift_low[u]);
        w->drift_low[u] += scale * origin->p_low[u];
    }
}

static void set_start(galerkin *w, const tvi_origin *origin)
{
    const galerkin_nodes *nodes = &w->field.nodes;
    const size_t bytes = (size_t)w->n * sizeof(double);
    memcpy(nodes->start, origin->q, bytes);
    memcpy(w->low, origin->q_low, bytes);
    if (galerkin_is_second_order(&w->field)) {
        set_drift(w, origin);
    } else {
        memcpy(nodes->start + w->n, origin->p, bytes);
        memcpy(w->low + w->n, origin->p_low, bytes);
    }
    set_base(w);
}

/* Whether this step begins where the last one ended, or began, and its nodes are near those of that one. */
static bool can_extrapolate(const galerkin *w, const tvi_origin *origin, double *part)
{
    const galerkin_history *last = w->last;
    if (last->h == 0 || w->options->passes == TVI_PREDICT_ONLY) return false;
    const double gap = origin->t - (last->t + last->h), ratio = w->field.h / last->h;
    const bool is_next = fabs(gap) < 0.25 * fabs(w->field.h);
    *part = is_next ? 1 : 0;
    return ratio <= 1.5 && (is_next ? ratio >= -2 : origin->t == last->t && ratio > 0);
}

static void extrapolate(galerkin *w, double part)
{
    const galerkin_history *last = w->last;
    const double *const impulses[] = {w->impulses[last->turn], w->impulses[!last->turn]};
    if (part == 1 && w->field.h == last->h && w->field.h == last->h_before) {
        w->field.form->predict(&w->field, 2, w->from_two, impulses);
    } else {
        const galerkin_nodes *nodes = &w->field.nodes;
        const galerkin_places to = {nodes->lanes, nodes->lanes, nodes->unknowns, w->c, w->none, w->none, w->one};
        const double *const led[] = {w->led};
        set_from_one(w, w->field.h / last->h, part);
        w->field.loops->place(&to, w->from_one, impulses[0], w->led);
        w->field.form->predict(&w->field, 1, w->field.ahead, led);
    }
}

/* A component that is small beside the others of its group has no better roundoff than they. */
static const double LEAST_SHARE = 1e-3;

/* 1 / (|start| + |predicted end - start|). */
static void set_sizes(galerkin *w)
{
    for (int first = 0; first < w->field.nodes.unknowns; first += w->n) {
        double largest = 0;
        for (int u = first; u < first + w->n; u++) {
            const double end = w->field.nodes.x[(u + 1) * w->field.nodes.lanes - 1];
            w->field.nodes.inverse_size[u] = fabs(w->field.nodes.start[u]) + fabs(end - w->field.nodes.start[u]);
            if (w->field.nodes.inverse_size[u] > largest) largest = w->field.nodes.inverse_size[u];
        }
        const double least = largest > 0 ? LEAST_SHARE * largest : 1;
        for (int u = first; u < first + w->n; u++)
            w->field.nodes.inverse_size[u] = 1 / (w->field.nodes.inverse_size[u] + least);
    }
}

/* ---- The passes -------------------------------------------------------------------------------------------------- */

/* Squares of relative movements: one after which there must be another pass, one that may be roundoff, one that is
 * none, and one that no sum of many steps shows. What a step leaves out has the same sign in the next one, where
 * roundoff changes its sign: it stays below the roundoff of N steps if it is that of one step / sqrt(N), here for more
 * than 10^9 of them. A Newton method, whose passes cost more, does so for 2^16 times fewer. */
static double square(double x) { return x * x; }
#define FAR            square(1e-9)
#define MAYBE_ROUNDOFF square(1e-12)
#define ROUNDOFF       square(32 * DBL_EPSILON)
#define NOTHING        square(0x1p-80)
#define NEWTON_NOTHING square(0x1p-72)

/* A movement is roundoff if unknowns that are displaced by this part of their size move as far. */
static const double MOST_ROUNDOFF = 16 * DBL_EPSILON;

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

static bool contracts(const galerkin_progress *at) { return at->slowest > 0 && at->slowest < 0.25; }

/* Whether what the next pass would move is nothing. Passes of a small step soon do no more than roundoff, which does
 * not show how far they contract: then they do as those of an earlier step did. */
static bool is_converged(galerkin_progress *at, double moved, double count, bool is_newton)
{
    if (moved > ROUNDOFF * count || (is_newton && at->slowest == 0)) {
        const double contraction = moved / at->moved;
        at->slowest = is_newton ? contraction : larger(contraction, at->contraction);
        at->contraction = contraction;
        at->expected = moved;
    } else {
        at->expected = at->slowest > 0 ? smaller(moved, at->slowest * at->expected) : moved;
    }
    return contracts(at) && at->slowest * at->expected <= (is_newton ? NEWTON_NOTHING : NOTHING) * count;
}

/* Two passes, since in the equations of a Hamiltonian those of Q may contract as little as those of P contract much, in
 * turns. */
static bool shrinks_no_more(const galerkin_progress *at, double moved)
{
    return at->before > 0 && moved >= at->moved && moved >= at->before;
}

/* Whether the passes may end here, or do no more than roundoff. */
static bool is_enough(const galerkin *w, galerkin_progress *at, double moved)
{
    const double count = w->field.nodes.unknowns * w->field.nodes.lanes;
    bool is_last = moved == 0 || moved <= at->roundoff;
    if (w->options->tolerance > 0) is_last |= moved <= square(w->options->tolerance);
    else if (at->moved == 0) at->expected = moved;
    else if (moved <= FAR * count) is_last |= is_converged(at, moved, count, w->field.form->is_newton);
    if (!contracts(at)) is_last |= shrinks_no_more(at, moved) && moved <= MAYBE_ROUNDOFF * count;
    at->is_stuck |= shrinks_no_more(at, moved);
    at->before = at->moved;
    at->moved = moved;
    return is_last;
}

static tvi_status pass(galerkin *w, double *moved, tvi_stats *stats)
{
    stats->force_evaluations += w->points;
    const tvi_status status = galerkin_pass(&w->field, moved, stats);
    if (status != TVI_OK) return status;
    stats->passes++;
    return isfinite(*moved) ? TVI_OK : TVI_ENONFINITE;
}

/* Moves the unknowns, and what the passes bring them back to, by some units of the roundoff that a pass leaves in them,
 * up or down as the bits of a sequence have it. */
static void displace(galerkin_nodes *nodes)
{
    uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes; k++) {
            const double size = MOST_ROUNDOFF * (fabs(nodes->start[u]) + fabs(nodes->x[k] - nodes->start[u]));
            bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            nodes->x[k] += bits >> 63 ? size : -size;
            nodes->base[k] += bits >> 63 ? size : -size;
        }
}

/* The square of the relative distance from x to nodes.x. */
static double distance(const galerkin *w, const double *x)
{
    const galerkin_nodes *nodes = &w->field.nodes;
    double sum = 0;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes; k++)
            sum += square((nodes->x[k] - x[k]) * nodes->inverse_size[u]);
    return sum;
}

/* The next pass, and what it makes of the roundoff in the unknowns that it begins with: a pass from displaced ones,
 * whose difference from it is roundoff. Where the force is that at a position of size 1, for instance, the momenta of a
 * small motion have no more digits than the force. The rounds of a pass may move the unknowns to and fro: here they
 * have moved from where they were to where they are. */
static tvi_status measure_roundoff(galerkin *w, double *moved, double *roundoff, tvi_stats *stats)
{
    const size_t bytes = (size_t)w->field.rows * (size_t)w->field.nodes.lanes * sizeof(double);
    double *x = w->field.nodes.x;
    memcpy(w->before, x, bytes);
    displace(&w->field.nodes);
    tvi_status status = pass(w, moved, stats);
    memcpy(w->displaced, x, bytes);
    memcpy(x, w->before, bytes);
    set_base(w);
    if (status == TVI_OK) status = pass(w, moved, stats);
    *roundoff = distance(w, w->displaced);
    *moved = distance(w, w->before);
    return status;
}

static tvi_status iterate(galerkin *w, tvi_stats *stats)
{
    const tvi_options *o = w->options;
    const int most = o->passes > 0 ? o->passes : o->max_passes > 0 ? o->max_passes : MAX_PASSES;
    galerkin_progress at = {.slowest = w->field.h == w->last->h ? w->last->slowest : 0};
    for (int count = 1; count <= most; count++) {
        double moved;
        const bool suspects = at.is_stuck && at.roundoff == 0 && count++ < most;
        const tvi_status status = suspects ? measure_roundoff(w, &moved, &at.roundoff, stats) : pass(w, &moved, stats);
        if (status != TVI_OK) return status;
        if (o->passes > 0 ? count == o->passes : is_enough(w, &at, moved)) {
            stats->residual = sqrt(moved);
            w->last->slowest = at.slowest;
            return TVI_OK;
        }
    }
    return TVI_ENOCONV;
}

/* From the steps before, beginning after `part` of the last one; NULL: the field at the start is that at all nodes. */
static tvi_status solve(galerkin *w, const tvi_origin *origin, const double *part, tvi_stats *stats)
{
    const galerkin_field *field = &w->field;
    if (part) {
        extrapolate(w, *part);
    } else {
        set_times(w, origin, 0);
        stats->force_evaluations++;
        const tvi_status status = w->field.form->start(&w->field, origin);
        if (status != TVI_OK) return status;
        (void)field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot);
        if (w->options->passes == TVI_PREDICT_ONLY) return TVI_OK;
    }
    set_times(w, origin, w->field.h);
    set_sizes(w);
    return iterate(w, stats);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* h times what drives an unknown at its first and its last node. */
static double reach(const galerkin *w, int u)
{
    const double *impulse = w->field.nodes.impulse + u * w->field.nodes.lanes;
    return (fabs(impulse[0]) + fabs(impulse[w->points - 1])) / w->field.b[0];
}

/* Of component i, in the step that moves p by dp. */
static tvi_tail_part tail_part(const galerkin *w, const tvi_origin *origin, const double dp[], int i)
{
    const bool has_masses = galerkin_is_second_order(&w->field);
    const int u = has_masses ? i : w->n + i; /* of p */
    tvi_tail_part part = {.momentum = fabs(origin->p[i]) + (fabs(dp[i]) + reach(w, u)),
                          .last_p = fabs(w->sum[u * SUMS + SUM_TAIL]),
                          .last_q = has_masses ? 0 : fabs(w->sum[i * SUMS + SUM_TAIL]),
                          .place = fabs(origin->q[i])};
    part.movement = has_masses ? fabs(w->field.nodes.scale[i]) * part.momentum : reach(w, i);
    return part;
}

/* tail.h */
static double tail(const galerkin *w, const tvi_origin *origin, const double dp[])
{
    const bool has_masses = galerkin_is_second_order(&w->field);
    tvi_tail_survey survey = {0, 0, 0};
    if (w->points < 2) return 0;
    for (int i = 0; i < w->n; i++) {
        const tvi_tail_part part = tail_part(w, origin, dp, i);
        tvi_tail_look(&survey, &part, has_masses);
    }
    if (tvi_tail_is_known(&survey)) return survey.ratio;
    double most = 0;
    for (int i = 0; i < w->n; i++) {
        const tvi_tail_part part = tail_part(w, origin, dp, i);
        most = larger(most, tvi_tail_of(&part, has_masses, survey.largest));
    }
    return most;
}

static void set_increments(const galerkin *w, double dq[], double dp[])
{
    for (int u = 0; u < w->field.nodes.unknowns; u++) {
        const double *sum = w->sum + u * SUMS;
        if (galerkin_is_second_order(&w->field)) {
            dp[u] = sum[SUM_ONCE];
            double rest;
            const double rise = tvi_two_product(w->field.nodes.scale[u], sum[SUM_TWICE], &rest);
            dq[u] = w->drift[u] + (rise + (w->drift_low[u] + rest));
        } else {
            *(u < w->n ? &dq[u] : &dp[u - w->n]) = w->field.nodes.scale[u] * sum[SUM_ONCE];
        }
    }
}

static tvi_status step(void *work, double h, const tvi_origin *origin, double dq[], double dp[], tvi_stats *stats)
{
    galerkin *w = work;
    set_size(w, h);
    set_start(w, origin);
    double part;
    const bool extrapolates = can_extrapolate(w, origin, &part);
    tvi_status status = solve(w, origin, extrapolates ? &part : NULL, stats);
    if (status != TVI_OK && extrapolates) status = solve(w, origin, NULL, stats);
    if (status != TVI_OK) return status;
    const int turn = !w->last->turn;
    w->field.loops->integrate(&w->field.nodes, w->factor, w->sum);
    memcpy(w->impulses[turn], w->field.nodes.impulse, unknowns_size(w));
    *w->last = (galerkin_history){h, w->last->h, origin->t, w->last->slowest, turn};
    set_increments(w, dq, dp);
    stats->tail = tail(w, origin, dp);
    return TVI_OK;
}

/* ---- Dense output -------------------------------------------------------------------------------------------------
 */

/* x [components][places] = start + what is added to it at the places theta, by a table of galerkin_dense.h,
 * [lanes][places], and the impulses that drive it. */
static void integrate_impulses(const galerkin *w, tvi_range of, int places, const double theta[], const double *table,
                               const double *impulses, const double *start, const double *drift, const double *rise,
                               double *x)
{
    const int lanes = w->field.nodes.lanes, from = of.first, count = of.end - from;
    const galerkin_places to = {lanes, places, count, theta, start + from, drift + from, rise + from};
    if (count > 0) w->field.loops->place(&to, table, impulses + from * lanes, x + from * places);
}

/* q, p [n][places], of[0] of q and of[1] of p: the polynomial of degree m - 1 through what drives the unknowns,
 * integrated. */
static void follow_curve(const galerkin *w, const tvi_range of[2], int places, const double theta[], const double *once,
                         const double *twice, const double q_start[], const double p_start[], double *q, double *p)
{
    const double *impulses = w->impulses[w->last->turn], *of_p = impulses;
    const bool separable = galerkin_is_second_order(&w->field);
    if (!separable) of_p += w->n * w->field.nodes.lanes;
    integrate_impulses(w, of[0], places, theta, separable ? twice : once, impulses, q_start, w->drift, w->rise, q);
    integrate_impulses(w, of[1], places, theta, once, of_p, p_start, w->none, w->rise + w->n, p);
}

static void dense(void *work, double theta, double dq[], double dp[])
{
    const galerkin *w = work;
    const tvi_range all[] = {{0, w->n}, {0, w->n}};
    double once[MAX_LANES] = {0}, twice[MAX_LANES] = {0};
    tvi_galerkin_dense_integrate(&w->dense, theta, once, twice);
    follow_curve(w, all, 1, &theta, once, twice, w->none, w->none, dq, dp);
}

static void sample(void *work, const tvi_range of[2], const double q_start[], const double p_start[], double *q,
                   double *p)
{
    const galerkin *w = work;
    follow_curve(w, of, TVI_SAMPLES, tvi_sample_place, w->dense.once, w->dense.twice, q_start, p_start, q, p);
}

const tvi_stepper tvi_stepper_galerkin = {take, prepare, step, dense, sample, true};
