/* galerkin.c - the Galerkin curve: free values at m Gauss nodes, which is Gauss collocation (docs/method.md section 4).
 * With a, b, c its coefficients and F_j the field at node j,
 *     separable:    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *                   q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 *     Hamiltonian:  (Q, P)_i = (q0, p0) + h sum_j a_ij (H_p, -H_q)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (H_p, -H_q)_j.
 * Solved by fixed point, from the fields of the step before. The nodes are lanes of one sweep of the field's tape; where
 * lanes are more than nodes, the last node is repeated, with weight 0. */
#include "quadrature.h"
#include "stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_PASSES = 100, MAX_LANES = 12 };

/* What drives the unknowns, and how much each sum of it over the nodes counts: b_j and b_j (1 - c_j), each in two parts,
 * because what a rounded weight lacks is the same in every step, and the energy would drift by it. */
enum { SUM_B, SUM_B_LOW, SUM_BC, SUM_BC_LOW, SUMS };

/* The passes of a step: sums over all unknowns and lanes of how far they moved, relative to their sizes. */
typedef struct {
    double moved, expected; /* by the last pass; without its roundoff */
    double contraction;     /* of the last pass that was above roundoff */
    double slowest;         /* of the last two */
} galerkin_progress;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, nodes, lanes;
    int unknowns;         /* of one node: Q, and P of a Hamiltonian */
    double *x;            /* block of the field's values; the unknowns are its first slots */
    int *slot;            /* [unknowns] what drives each unknown, in x */
    int *place;           /* [unknowns] and in the history: 0, 1, ... */
    int *copied, copies;  /* [unknowns] slots of the field that are inputs: they are copied behind those of the tape */
    double *matrix;       /* [j][i] (a a)_ij, or a_ij for a Hamiltonian */
    double *prediction;   /* [j][i] matrix times extrapolation from a step of size h / ratio */
    double ratio;         /* 0: none yet */
    double *node;         /* [lanes] c_i */
    double *weight;       /* [lanes][SUMS] */
    double h;             /* of the next two; 0: none yet */
    double *rate;         /* [n] h / m */
    double *scale;        /* [unknowns] of the sums: h^2/m, or h of Q and -h of P */
    double *start;        /* [unknowns] (q0, p0) */
    double *drift;        /* [unknowns] h M^-1 p0, or 0 */
    double *inverse_size; /* [unknowns] */
    double *last_h;       /* in the history: the step before, 0: none, */
    double *last_drive;   /* [unknowns][lanes] and what drove its unknowns */
    long double exact_node[MAX_LANES], exact_weight[MAX_LANES];
    long double unit[MAX_LANES]; /* 1 / prod_{k != j} (c_j - c_k) */
} galerkin;

/* ---- Memory and tables --------------------------------------------------------------------------------------------- */

static int lanes_for(int nodes)
{
    int lanes = 1;
    while (lanes < nodes && lanes < 8) lanes *= 2;
    return nodes <= lanes ? lanes : MAX_LANES;
}

/* The outputs that drive the unknowns: F; or H_p, then H_q. */
static int driving_slot(const tvi_system *system, int unknown)
{
    const int n = system->n, output = system->form == TVI_SEPARABLE ? unknown : unknown < n ? unknown + n : unknown - n;
    return system->field_values->output[output];
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    galerkin *taken = tvi_arena_take(arena, sizeof *taken);
    galerkin w = {.system = system, .options = options, .n = system->n, .nodes = options->degree};
    w.unknowns = system->inputs;
    w.lanes = lanes_for(w.nodes);
    const size_t unknowns = (size_t)w.unknowns, lanes = (size_t)w.lanes;
    const size_t slots = (size_t)system->field_values->slots + unknowns;
    w.x = tvi_arena_doubles(arena, slots * lanes);
    w.last_h = tvi_arena_history(arena, sizeof *w.last_h);
    w.last_drive = tvi_arena_history(arena, unknowns * lanes * sizeof *w.last_drive);
    w.matrix = tvi_arena_doubles(arena, lanes * lanes);
    w.prediction = tvi_arena_doubles(arena, lanes * lanes);
    w.node = tvi_arena_doubles(arena, lanes);
    w.weight = tvi_arena_doubles(arena, lanes * SUMS);
    double **const vectors[] = {&w.rate, &w.scale, &w.start, &w.drift, &w.inverse_size};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) *vectors[i] = tvi_arena_doubles(arena, unknowns);
    int **const indices[] = {&w.slot, &w.place, &w.copied};
    for (size_t i = 0; i < sizeof indices / sizeof *indices; i++)
        *indices[i] = tvi_arena_take(arena, unknowns * sizeof(int));
    if (taken) *taken = w;
    return taken;
}

/* l_j(s), the polynomial that is 1 at node j and 0 at the others. */
static long double lagrange(const galerkin *w, int j, long double s)
{
    long double product = w->unit[j];
    for (int k = 0; k < w->nodes; k++)
        if (k != j) product *= s - w->exact_node[k];
    return product;
}

/* int_0^s l_j and int_0^s (s - r) l_j(r) dr, by the Gauss rule on [0, s]: exact. */
static void integrate_lagrange(const galerkin *w, int j, long double s, long double *once, long double *twice)
{
    *once = *twice = 0;
    for (int k = 0; k < w->nodes; k++) {
        const long double term = s * w->exact_weight[k] * lagrange(w, j, s * w->exact_node[k]);
        *once += term;
        *twice += s * (1 - w->exact_node[k]) * term;
    }
}

static void set_nodes(galerkin *w)
{
    tvi_quadrature_nodes(TVI_GAUSS, w->nodes, w->exact_node, w->exact_weight);
    for (int i = 0; i < w->nodes; i++) {
        w->exact_node[i] = (1 + w->exact_node[i]) / 2;
        w->exact_weight[i] /= 2;
        const long double weight[] = {w->exact_weight[i], w->exact_weight[i] * (1 - w->exact_node[i])};
        for (int kind = 0; kind < 2; kind++) {
            double *parts = w->weight + i * SUMS + 2 * kind;
            parts[0] = (double)weight[kind];
            parts[1] = (double)(weight[kind] - parts[0]);
        }
    }
    for (int i = 0; i < w->lanes; i++) w->node[i] = (double)w->exact_node[i < w->nodes ? i : w->nodes - 1];
    for (int j = 0; j < w->nodes; j++) {
        w->unit[j] = 1;
        for (int k = 0; k < w->nodes; k++)
            if (k != j) w->unit[j] /= w->exact_node[j] - w->exact_node[k];
    }
}

/* a_ij = int_0^{c_i} l_j. The product a a is not the double integral, whose method is not symplectic. */
static void set_matrix(galerkin *w)
{
    long double a[MAX_LANES][MAX_LANES], twice;
    const int m = w->nodes;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) integrate_lagrange(w, j, w->exact_node[i], &a[i][j], &twice);
    for (int lane = 0; lane < w->lanes; lane++)
        for (int j = 0; j < m; j++) {
            const int i = lane < m ? lane : m - 1;
            long double square = 0;
            for (int k = 0; k < m; k++) square += a[i][k] * a[k][j];
            w->matrix[j * w->lanes + lane] = (double)(w->system->form == TVI_SEPARABLE ? square : a[i][j]);
        }
}

/* An output may be an input: then moving one unknown would change what drives another. */
static void set_slots(galerkin *w)
{
    for (int u = 0; u < w->unknowns; u++) {
        w->place[u] = u;
        w->slot[u] = driving_slot(w->system, u);
        if (w->slot[u] >= w->unknowns) continue;
        w->copied[w->copies] = w->slot[u];
        w->slot[u] = w->system->field_values->slots + w->copies++;
    }
}

static void prepare(void *work)
{
    galerkin *w = work;
    jet_tape_prepare(w->system->field_values, w->x, 1, w->lanes);
    set_nodes(w);
    set_matrix(w);
    set_slots(w);
}

/* What depends on the size of the step alone. */
static void set_size(galerkin *w, double h)
{
    if (h == w->h) return;
    w->h = h;
    for (int u = 0; u < w->unknowns; u++) {
        if (w->system->form == TVI_SEPARABLE) {
            w->rate[u] = h / w->system->mass[u];
            w->scale[u] = h * w->rate[u];
        } else {
            w->scale[u] = u < w->n ? h : -h;
        }
    }
}

/* From a step of size h / ratio to the next one: node i is at 1 + ratio c_i there. */
static void set_prediction(galerkin *w, double ratio)
{
    if (ratio == w->ratio) return;
    w->ratio = ratio;
    const int lanes = w->lanes;
    memset(w->prediction, 0, (size_t)lanes * (size_t)lanes * sizeof *w->prediction);
    for (int k = 0; k < w->nodes; k++)
        for (int j = 0; j < w->nodes; j++) {
            const double factor = (double)lagrange(w, j, 1 + ratio * w->exact_node[k]);
            for (int i = 0; i < lanes; i++) w->prediction[j * lanes + i] += factor * w->matrix[k * lanes + i];
        }
}

/* ---- The two loops in which all time but that of the field goes ---------------------------------------------------- */

/* X_i = start + (c_i drift + scale sum_j matrix_ij drive_j) for all unknowns; returns how far they moved, relative to
 * their sizes, summed over all, so that a NaN shows. */
static double move(const galerkin *w, const double *matrix, const double *drives, const int slot[])
{
    const int lanes = w->lanes;
    double moved[MAX_LANES] = {0}, sum = 0;
    for (int u = 0; u < w->unknowns; u++) {
        const double *drive = drives + slot[u] * lanes;
        double *x = w->x + u * lanes;
        for (int i = 0; i < lanes; i++) {
            double total = 0;
            for (int j = 0; j < lanes; j++) total += matrix[j * lanes + i] * drive[j];
            const double place = w->start[u] + (w->node[i] * w->drift[u] + w->scale[u] * total);
            moved[i] += fabs(place - x[i]) * w->inverse_size[u];
            x[i] = place;
        }
    }
    for (int i = 0; i < lanes; i++) sum += moved[i];
    return sum;
}

/* sum_j b_j F_j and sum_j b_j (1 - c_j) F_j. */
static void integrate(const galerkin *w, const double *drive, double *once, double *twice)
{
    double sum[SUMS] = {0};
    for (int j = 0; j < w->lanes; j++)
        for (int k = 0; k < SUMS; k++) sum[k] += w->weight[j * SUMS + k] * drive[j];
    *once = sum[SUM_B] + sum[SUM_B_LOW];
    *twice = sum[SUM_BC] + sum[SUM_BC_LOW];
}

/* ---- The field ------------------------------------------------------------------------------------------------------- */

/* What drives the unknowns, where they are. */
static tvi_status evaluate(galerkin *w)
{
    const jet_tape *tape = w->system->field_values;
    if (!jet_sweep_values(tape, w->x, w->lanes)) return TVI_EDOMAIN;
    const size_t lanes = (size_t)w->lanes;
    for (int i = 0; i < w->copies; i++)
        memcpy(w->x + (size_t)(tape->slots + i) * lanes, w->x + (size_t)w->copied[i] * lanes, lanes * sizeof *w->x);
    return TVI_OK;
}

/* Time t0 + h at, of each lane. */
static void set_times(galerkin *w, const tvi_origin *origin, const double at[])
{
    double t[MAX_LANES];
    if (!w->system->uses_time) return;
    for (int i = 0; i < w->lanes; i++) t[i] = origin->t + (origin->t_low + w->h * at[i]);
    tvi_system_set_time(w->system, w->x, w->lanes, t);
}

/* ---- The predictor ----------------------------------------------------------------------------------------------------- */

static void set_start(galerkin *w, const tvi_origin *origin)
{
    const bool separable = w->system->form == TVI_SEPARABLE;
    for (int i = 0; i < w->n; i++) {
        w->start[i] = origin->q[i];
        if (separable) w->drift[i] = w->rate[i] * origin->p[i];
        else w->start[w->n + i] = origin->p[i];
    }
}

/* Without a step before, the field at the start is that at all nodes. */
static tvi_status predict_from_start(galerkin *w, const tvi_origin *origin, tvi_stats *stats)
{
    static const double at[MAX_LANES] = {0};
    set_times(w, origin, at);
    for (int u = 0; u < w->unknowns; u++)
        for (int i = 0; i < w->lanes; i++) w->x[u * w->lanes + i] = w->start[u];
    stats->force_evaluations++;
    return evaluate(w);
}

/* What a step of another size may be predicted from: 1 + ratio c_i stays near the nodes of that step. */
static bool can_extrapolate(const galerkin *w)
{
    return *w->last_h != 0 && w->h / *w->last_h >= -2 && w->h / *w->last_h <= 1.5;
}

/* A component that is small beside the others of its group has no better roundoff than they. */
static const double LEAST_SHARE = 1e-3;

/* 1 / (|start| + |predicted end - start|). */
static void set_sizes(galerkin *w)
{
    for (int first = 0; first < w->unknowns; first += w->n) {
        double largest = 0;
        for (int u = first; u < first + w->n; u++) {
            const double end = w->x[(u + 1) * w->lanes - 1];
            w->inverse_size[u] = fabs(w->start[u]) + fabs(end - w->start[u]);
            largest = fmax(largest, w->inverse_size[u]);
        }
        const double least = largest > 0 ? LEAST_SHARE * largest : 1;
        for (int u = first; u < first + w->n; u++) w->inverse_size[u] = 1 / (w->inverse_size[u] + least);
    }
}

/* ---- The passes -------------------------------------------------------------------------------------------------------- */

/* Of a sum over all lanes, divided by their number: a movement that may be roundoff, one that must be, and one that no sum
 * of many steps shows. What a step leaves out is the same in the next one, where roundoff changes its sign. */
static const double MAYBE_ROUNDOFF = 1e-12, ROUNDOFF = 32 * DBL_EPSILON, NOTHING = DBL_EPSILON / 65536;

static void note(galerkin_progress *at, double moved, double roundoff)
{
    const bool is_measured = moved > roundoff;
    const double expected = at->slowest * at->expected;
    if (is_measured && at->expected > 0) {
        const double contraction = moved / at->expected;
        at->slowest = fmax(contraction, at->contraction);
        at->contraction = contraction;
    }
    at->expected = is_measured || at->slowest == 0 ? moved : fmin(moved, expected);
}

/* Whether what the next pass would move is nothing, or the passes do no more than roundoff. */
static bool is_enough(const galerkin *w, galerkin_progress *at, double moved)
{
    const double count = w->unknowns * w->lanes, before = at->moved;
    const double tolerance = w->options->tolerance;
    const bool is_first = before == 0;
    at->moved = moved;
    if (moved == 0) return true;
    if (!is_first && moved >= before && moved <= MAYBE_ROUNDOFF * count) return true;
    if (tolerance > 0) return moved <= tolerance;
    note(at, moved, ROUNDOFF * count);
    return at->slowest > 0 && at->slowest < 0.5 && at->slowest * at->expected <= NOTHING * count;
}

static tvi_status iterate(galerkin *w, tvi_stats *stats)
{
    const tvi_options *o = w->options;
    const int most = o->passes > 0 ? o->passes : o->max_passes > 0 ? o->max_passes : MAX_PASSES;
    galerkin_progress at = {0};
    for (int pass = 1; pass <= most; pass++) {
        stats->force_evaluations += w->nodes;
        const tvi_status status = evaluate(w);
        if (status != TVI_OK) return status;
        stats->passes++;
        stats->residual = move(w, w->matrix, w->x, w->slot);
        if (!isfinite(stats->residual)) return TVI_ENONFINITE;
        if (o->passes == 0 && is_enough(w, &at, stats->residual)) return TVI_OK;
    }
    return o->passes > 0 ? TVI_OK : TVI_ENOCONV;
}

/* From the step before, or from the start. */
static tvi_status solve(galerkin *w, const tvi_origin *origin, bool extrapolates, tvi_stats *stats)
{
    if (extrapolates) {
        set_prediction(w, w->h / *w->last_h);
        (void)move(w, w->prediction, w->last_drive, w->place);
    } else {
        const tvi_status status = predict_from_start(w, origin, stats);
        if (status != TVI_OK || w->options->passes == TVI_PREDICT_ONLY) return status;
        (void)move(w, w->matrix, w->x, w->slot);
    }
    set_times(w, origin, w->node);
    set_sizes(w);
    return iterate(w, stats);
}

/* ---- The step ---------------------------------------------------------------------------------------------------------- */

static void set_increments(const galerkin *w, const tvi_origin *origin, double dq[], double dp[])
{
    double once, twice;
    for (int u = 0; u < w->unknowns; u++) {
        integrate(w, w->x + w->slot[u] * w->lanes, &once, &twice);
        if (w->system->form == TVI_SEPARABLE) {
            dp[u] = w->h * once;
            dq[u] = w->rate[u] * (origin->p[u] + (origin->p_low[u] + w->h * twice));
        } else {
            *(u < w->n ? &dq[u] : &dp[u - w->n]) = w->scale[u] * once;
        }
    }
}

static void remember(galerkin *w)
{
    const size_t lanes = (size_t)w->lanes;
    *w->last_h = w->h;
    for (int u = 0; u < w->unknowns; u++)
        memcpy(w->last_drive + (size_t)u * lanes, w->x + (size_t)w->slot[u] * lanes, lanes * sizeof *w->x);
}

static tvi_status step(void *work, double h, const tvi_origin *origin, double dq[], double dp[], tvi_stats *stats)
{
    galerkin *w = work;
    set_size(w, h);
    set_start(w, origin);
    const bool extrapolates = w->options->passes != TVI_PREDICT_ONLY && can_extrapolate(w);
    tvi_status status = solve(w, origin, extrapolates, stats);
    if (status != TVI_OK && extrapolates) status = solve(w, origin, false, stats);
    if (status != TVI_OK) return status;
    set_increments(w, origin, dq, dp);
    remember(w);
    return TVI_OK;
}

/* The polynomial of degree m - 1 through what drives the unknowns, integrated. */
static void dense(void *work, double theta, double dq[], double dp[])
{
    const galerkin *w = work;
    const bool separable = w->system->form == TVI_SEPARABLE;
    memset(dp, 0, (size_t)w->n * sizeof *dp);
    for (int i = 0; i < w->n; i++) dq[i] = separable ? theta * w->drift[i] : 0;
    for (int j = 0; j < w->nodes; j++) {
        long double once, twice;
        integrate_lagrange(w, j, theta, &once, &twice);
        for (int u = 0; u < w->unknowns; u++) {
            const double drive = w->last_drive[u * w->lanes + j];
            if (separable) {
                dp[u] += w->h * (double)once * drive;
                dq[u] += w->scale[u] * (double)twice * drive;
            } else {
                *(u < w->n ? &dq[u] : &dp[u - w->n]) += w->scale[u] * (double)once * drive;
            }
        }
    }
}

const tvi_stepper tvi_stepper_galerkin = {take, prepare, step, dense};
