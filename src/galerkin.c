/* galerkin.c - the Galerkin curve: free values at m Gauss nodes, which is Gauss collocation (docs/method.md section 4).
 * With a, b, c its coefficients and F_j the field at node j,
 *     separable:    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *                   q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 *     else:         (Q, P)_i = (q0, p0) + h sum_j a_ij (V, F)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (V, F)_j,
 * with (V, F) = (H_p, -H_q), or L_v(Q, V) = P and F = L_q (galerkin_field.h). Solved by passes, which begin with what
 * the steps before lead to. The nodes are lanes of one sweep of the field's tape. */
#include "galerkin_dense.h"
#include "galerkin_field.h"
#include "quadrature.h"
#include "stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_PASSES = 100, MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* The passes of a step. All sizes are squares, summed over all unknowns and lanes, relative to the sizes of the
 * unknowns. */
typedef struct {
    double moved, before; /* by the last pass, and the one before it; 0: none */
    double slowest;  /* contraction of the last two passes that were above roundoff; of a Newton method, the last */
    double expected; /* movement of the last pass, without its roundoff */
} galerkin_progress;

/* The last two steps. */
typedef struct {
    double h, h_before; /* 0: none */
    double t;           /* where the last one began */
    int turn;           /* where its drives are */
} galerkin_history;

typedef struct {
    const tvi_options *options;
    int n, points;
    galerkin_field field;
    double *terms, *led; /* [unknowns][lanes] of a step's polynomial, and where it leads to at the nodes of another */
    double *from_two;    /* [2][j][i] the same from the two steps before, all of one size */
    double *c, *c_rest;  /* [lanes] in two parts */
    double *weight;      /* [lanes][SUMS] */
    double *sum;         /* [unknowns][SUMS] */
    galerkin_dense dense;
    double h;           /* of the rates and the scales; 0: none yet */
    double *rate;       /* [n] h / m */
    double *drift;      /* [n] h M^-1 p0 of a separable system, else 0 */
    double *rise;       /* [2n] what multiplies the integrals of the drives in q and p */
    double *none, *one; /* [unknowns] 0 and 1 */
    galerkin_history *last;
    double *drives[2]; /* in the history: [unknowns][lanes] what drove the unknowns of the last two steps, in turns */
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

#ifdef JET_ISA_X86
extern const jet_sweeps jet_sweeps_avx2, jet_sweeps_avx512; /* ad/isa.c */
#endif

/* Those of the instruction set that the system's tapes run with. */
static const galerkin_loops *loops_for(const jet_sweeps *sweeps)
{
#ifdef JET_ISA_X86
    if (sweeps == &jet_sweeps_avx512) return &galerkin_loops_avx512;
    if (sweeps == &jet_sweeps_avx2) return &galerkin_loops_avx2;
#endif
    (void)sweeps;
    return &galerkin_loops_base;
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin *taken = tvi_arena_take(arena, sizeof *taken);
    galerkin w = {.options = options, .n = system->n, .points = options->degree};
    w.field = (galerkin_field){.system = system, .points = w.points, .loops = loops_for(system->field_values->sweeps)};
    w.field.form = system->form == TVI_LAGRANGIAN ? &galerkin_form_lagrangian : &galerkin_form_plain;
    galerkin_nodes *nodes = &w.field.nodes;
    nodes->unknowns = system->inputs;
    nodes->lanes = lanes_for(w.points);
    const size_t unknowns = (size_t)nodes->unknowns, lanes = (size_t)nodes->lanes;
    w.last = tvi_arena_history(arena, sizeof *w.last);
    for (int i = 0; i < 2; i++) w.drives[i] = tvi_arena_history(arena, unknowns * lanes * sizeof(double));
    nodes->base = tvi_arena_doubles(arena, unknowns * lanes);
    w.field.matrix = tvi_arena_doubles(arena, lanes * lanes);
    w.terms = tvi_arena_doubles(arena, unknowns * lanes);
    w.led = tvi_arena_doubles(arena, unknowns * lanes);
    w.rise = tvi_arena_doubles(arena, 2 * (size_t)w.n);
    w.from_two = tvi_arena_doubles(arena, 2 * lanes * lanes);
    w.c = tvi_arena_doubles(arena, lanes);
    w.c_rest = tvi_arena_doubles(arena, lanes);
    w.weight = tvi_arena_doubles(arena, lanes * SUMS);
    w.sum = tvi_arena_doubles(arena, unknowns * SUMS);
    galerkin_dense_take(&w.dense, arena, w.points, nodes->lanes, system->field_values->sweeps);
    double **const vectors[] = {&nodes->start, &nodes->scale, &nodes->inverse_size, &w.rate, &w.drift, &w.none, &w.one};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) *vectors[i] = tvi_arena_doubles(arena, unknowns);
    w.field.slot = tvi_arena_take(arena, unknowns * sizeof(int));
    w.field.form->take(&w.field, arena);
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

/* The first part is short. */
static void split(long double x, double *part, double *rest)
{
    *part = (float)x;
    *rest = (double)(x - *part);
}

/* The leading term a x^(m-1) of what drives an unknown, x in [-1/2, 1/2] about the middle of the step, makes of a
 * position at the ends a 2^-m / m by one integration, and a 2^-(m+1) / (m (m+1)) by two. */
static long double tail_factor(const galerkin *w)
{
    const int m = w->points;
    return galerkin_is_second_order(&w->field) ? ldexpl(1, -m - 1) / (m * (m + 1)) : ldexpl(1, -m) / m;
}

static void set_nodes(galerkin *w)
{
    tvi_quadrature_nodes(TVI_GAUSS, w->points, w->exact_node, w->exact_weight);
    for (int i = 0; i < w->points; i++) {
        w->exact_node[i] = (1 + w->exact_node[i]) / 2;
        w->exact_weight[i] /= 2;
        const long double weight[] = {w->exact_weight[i], w->exact_weight[i] * (1 - w->exact_node[i])};
        for (int kind = 0; kind < 2; kind++) {
            split(weight[kind], &w->weight[i * SUMS + 2 * kind], &w->weight[i * SUMS + 2 * kind + 1]);
        }
    }
    for (int i = 0; i < w->field.nodes.lanes; i++)
        split(w->exact_node[i < w->points ? i : w->points - 1], &w->c[i], &w->c_rest[i]);
    for (int j = 0; j < w->points; j++) {
        w->unit[j] = 1;
        for (int k = 0; k < w->points; k++)
            if (k != j) w->unit[j] /= w->exact_node[j] - w->exact_node[k];
        w->weight[j * SUMS + SUM_TAIL] = (double)(w->unit[j] * tail_factor(w));
    }
}

/* a_ij = int_0^{c_i} l_j. The product a a is not the double integral, whose method is not symplectic. */
static void set_matrix(galerkin *w)
{
    long double a[MAX_LANES][MAX_LANES], twice;
    const int m = w->points;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) integrate_lagrange(w, j, w->exact_node[i], &a[i][j], &twice);
    for (int lane = 0; lane < w->field.nodes.lanes; lane++)
        for (int j = 0; j < m; j++) {
            const int i = lane < m ? lane : m - 1;
            long double square = 0;
            for (int k = 0; k < m; k++) square += a[i][k] * a[k][j];
            w->field.matrix[j * w->field.nodes.lanes + lane] =
                (double)(galerkin_is_second_order(&w->field) ? square : a[i][j]);
        }
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
            for (int i = 0; i < lanes; i++) column[i] += (double)factor * w->field.ahead[next * lanes + i];
        }
}

static void prepare(void *work)
{
    galerkin *w = work;
    set_nodes(w);
    set_matrix(w);
    galerkin_dense_prepare(&w->dense, w->field.nodes.lanes, w->exact_node, w->exact_weight);
    w->field.form->prepare(&w->field);
    set_from_two(w);
    for (int u = 0; u < w->field.nodes.unknowns; u++) w->one[u] = 1;
}

/* What depends on the size of the step alone. */
static void set_size(galerkin *w, double h)
{
    if (h == w->h) return;
    w->h = h;
    for (int u = 0; u < w->field.nodes.unknowns; u++) {
        if (galerkin_is_second_order(&w->field)) {
            w->rate[u] = h / w->field.system->mass[u];
            w->field.nodes.scale[u] = h * w->rate[u];
        } else {
            w->field.nodes.scale[u] = u < w->n ? h : w->field.form->force_sign * h;
        }
    }
    for (int i = 0; i < w->n; i++) {
        w->rise[i] = w->field.nodes.scale[i];
        w->rise[w->n + i] = galerkin_is_second_order(&w->field) ? h : w->field.nodes.scale[w->n + i];
    }
}

/* The times of the nodes of a step of size h. */
static void set_times(galerkin *w, const tvi_origin *origin, double h)
{
    double t[MAX_LANES];
    if (!w->field.system->uses_time) return;
    for (int i = 0; i < w->field.nodes.lanes; i++) t[i] = origin->t + (origin->t_low + h * (w->c[i] + w->c_rest[i]));
    tvi_system_set_time(w->field.system, w->field.inputs, w->field.nodes.lanes, t);
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static void set_start(galerkin *w, const tvi_origin *origin)
{
    const size_t bytes = (size_t)w->n * sizeof(double);
    memcpy(w->field.nodes.start, origin->q, bytes);
    if (!galerkin_is_second_order(&w->field)) {
        memcpy(w->field.nodes.start + w->n, origin->p, bytes);
        return;
    }
    for (int i = 0; i < w->n; i++) w->drift[i] = w->rate[i] * origin->p[i];
    w->field.loops->set_base(&w->field.nodes, w->n, w->c, w->c_rest, w->drift);
}

/* Whether this step begins where the last one ended, or began, and its nodes are near those of that one. */
static bool can_extrapolate(const galerkin *w, const tvi_origin *origin, double *part)
{
    const galerkin_history *last = w->last;
    if (last->h == 0 || w->options->passes == TVI_PREDICT_ONLY) return false;
    const double gap = origin->t - (last->t + last->h), ratio = w->h / last->h;
    const bool is_next = fabs(gap) < 0.25 * fabs(w->h);
    *part = is_next ? 1 : 0;
    return ratio <= 1.5 && (is_next ? ratio >= -2 : origin->t == last->t && ratio > 0);
}

/* What drove a step of size h / ratio leads to the nodes of one that begins after a part of it: node i is at part +
 * ratio c_i there. */
static void lead_on(galerkin *w, double ratio, double part, const double *drives)
{
    const int lanes = w->field.nodes.lanes;
    const galerkin_places plain = {lanes, lanes, w->field.nodes.unknowns, w->c, w->none, w->none, w->one};
    double place[MAX_LANES], P[MAX_LANES * MAX_LANES] = {0};
    for (int i = 0; i < lanes; i++) place[i] = part + ratio * (w->c[i] + w->c_rest[i]);
    galerkin_dense_legendre(&w->dense, lanes, place, P);
    w->field.loops->place(&plain, w->dense.of_node, drives, w->terms);
    w->field.loops->place(&plain, P, w->terms, w->led);
}

static void extrapolate(galerkin *w, double part)
{
    const galerkin_history *last = w->last;
    const double *const drives[] = {w->drives[last->turn], w->drives[!last->turn]};
    if (part == 1 && w->h == last->h && w->h == last->h_before) {
        w->field.form->predict(&w->field, 2, w->from_two, drives);
    } else {
        lead_on(w, w->h / last->h, part, drives[0]);
        w->field.form->predict(&w->field, 1, w->field.ahead, (const double *const[]){w->led});
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
 * none, and one that no sum of many steps shows. What a step leaves out is the same in the next one, where roundoff
 * changes its sign. */
static double square(double x) { return x * x; }
#define FAR            square(1e-9)
#define MAYBE_ROUNDOFF square(1e-12)
#define ROUNDOFF       square(32 * DBL_EPSILON)
#define NOTHING        square(DBL_EPSILON / 4096)

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

/* Whether what the next pass would move is nothing. */
static bool is_converged(galerkin_progress *at, double moved, double count, bool is_newton)
{
    if (moved > ROUNDOFF * count || (is_newton && at->slowest == 0)) {
        const double earlier = at->before > 0 && !is_newton ? at->moved / at->before : 0;
        at->slowest = larger(moved / at->moved, earlier);
        at->expected = moved;
    } else {
        at->expected = at->slowest > 0 ? smaller(moved, at->slowest * at->expected) : moved;
    }
    return at->slowest > 0 && at->slowest < 0.25 && at->slowest * at->expected <= NOTHING * count;
}

/* Whether the passes may end here, or do no more than roundoff. Two passes, since in the equations of a Hamiltonian
 * those of Q may contract as little as those of P contract much, in turns. */
static bool is_enough(const galerkin *w, galerkin_progress *at, double moved)
{
    const double count = w->field.nodes.unknowns * w->field.nodes.lanes;
    bool is_last = moved == 0;
    if (at->before > 0 && moved >= at->moved && moved >= at->before) is_last |= moved <= MAYBE_ROUNDOFF * count;
    if (w->options->tolerance > 0) is_last |= moved <= square(w->options->tolerance);
    else if (at->moved > 0 && moved <= FAR * count) is_last |= is_converged(at, moved, count, w->field.form->is_newton);
    at->before = at->moved;
    at->moved = moved;
    return is_last;
}

static tvi_status iterate(galerkin *w, tvi_stats *stats)
{
    const tvi_options *o = w->options;
    const int most = o->passes > 0 ? o->passes : o->max_passes > 0 ? o->max_passes : MAX_PASSES;
    galerkin_progress at = {0};
    for (int pass = 1; pass <= most; pass++) {
        stats->force_evaluations += w->points;
        double moved;
        const tvi_status status = galerkin_pass(&w->field, &moved, stats);
        if (status != TVI_OK) return status;
        stats->passes++;
        if (!isfinite(moved)) return TVI_ENONFINITE;
        if (o->passes > 0 ? pass == o->passes : is_enough(w, &at, moved)) {
            stats->residual = sqrt(moved);
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
        if (status != TVI_OK || w->options->passes == TVI_PREDICT_ONLY) return status;
        (void)field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot);
    }
    set_times(w, origin, w->h);
    set_sizes(w);
    return iterate(w, stats);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Size of the last term of the positions' polynomials at the ends, relative to the positions. */
static double tail(const galerkin *w)
{
    double last = 0, q = 0;
    for (int u = 0; u < w->n; u++) {
        last = larger(last, fabs(w->field.nodes.scale[u] * w->sum[u * SUMS + SUM_TAIL]));
        q = larger(q, fabs(w->field.nodes.start[u]));
    }
    return q > 0 ? last / q : 0;
}

static void set_increments(const galerkin *w, const tvi_origin *origin, double dq[], double dp[])
{
    for (int u = 0; u < w->field.nodes.unknowns; u++) {
        const double *sum = w->sum + u * SUMS, once = sum[SUM_B] + sum[SUM_B_REST];
        if (galerkin_is_second_order(&w->field)) {
            dp[u] = w->h * once;
            dq[u] = w->rate[u] * (origin->p[u] + (origin->p_low[u] + w->h * (sum[SUM_BC] + sum[SUM_BC_REST])));
        } else {
            *(u < w->n ? &dq[u] : &dp[u - w->n]) = w->field.nodes.scale[u] * once;
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
    w->field.loops->integrate(&w->field.nodes, w->weight, w->field.slot, w->sum, w->drives[turn]);
    *w->last = (galerkin_history){h, w->last->h, origin->t, turn};
    set_increments(w, origin, dq, dp);
    stats->tail = tail(w);
    return TVI_OK;
}

/* ---- Dense output -------------------------------------------------------------------------------------------------
 */

/* q, p [n][places] = start + what is added to it at the places theta: the polynomial of degree m - 1 through what
 * drives the unknowns, integrated by tables of galerkin_dense.h, [lanes][places]. */
static void integrate_drives(const galerkin *w, int places, const double theta[], const double *once,
                             const double *twice, const double q_start[], const double p_start[], double *q, double *p)
{
    const bool separable = galerkin_is_second_order(&w->field);
    const int n = w->n, lanes = w->field.nodes.lanes;
    const double *drives = w->drives[w->last->turn];
    const galerkin_places of_q = {lanes, places, n, theta, q_start, w->drift, w->rise},
                          of_p = {lanes, places, n, theta, p_start, w->none, w->rise + n};
    w->field.loops->place(&of_q, separable ? twice : once, drives, q);
    w->field.loops->place(&of_p, once, separable ? drives : drives + n * lanes, p);
}

static void dense(void *work, double theta, double dq[], double dp[])
{
    const galerkin *w = work;
    double once[MAX_LANES] = {0}, twice[MAX_LANES] = {0};
    galerkin_dense_integrate(&w->dense, theta, once, twice);
    integrate_drives(w, 1, &theta, once, twice, w->none, w->none, dq, dp);
}

static void sample(void *work, const double q_start[], const double p_start[], double *q, double *p)
{
    const galerkin *w = work;
    integrate_drives(w, TVI_SAMPLES, tvi_sample_place, w->dense.once, w->dense.twice, q_start, p_start, q, p);
}

const tvi_stepper tvi_stepper_galerkin = {take, prepare, step, dense, sample};
