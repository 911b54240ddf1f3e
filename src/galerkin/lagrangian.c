/* lagrangian.c - the field of a Lagrangian L(q, v, t): V, with L_v(Q, V) = P, drives Q, and F = L_q(Q, V)
 * drives P (docs/method.md sections 4 and 5).
 *
 * A pass evaluates the gradient (L_q, L_v) at the nodes, and its derivatives, too, where those at hand were taken too
 * far away. Then it iterates, with the gradient to first order for what (Q, V) have moved since,
 *
 *     P = p0 + h a F,    V <- V + L_vv^-1 (P - L_v),    Q = q0 + h a V. */
#include "galerkin/model.h"
#include "system/legendre.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The rows of nodes.x, n each: Q, P, V, F, and L_v behind F. */
typedef struct {
    const lagrangian_loops *loops;
    tvi_legendre legendre;
    galerkin_nodes drives; /* V and F as unknowns, which begin at 0 */
    galerkin_model model;
    double *velocity;  /* [n] at the start */
    lanes_factor mass; /* of L_vv */
    double moved;      /* by the last pass, as `move` says; infinite before the first one of a step */
} lagrangian;

enum { ITERATIONS = 3 };           /* of a pass: more save less than they cost, as measured */
static const double SERVES = 1e-6; /* the square of a relative movement after which second derivatives serve again */

static double *row(const galerkin_field *field, int i)
{
    return field->nodes.x + (size_t)i * (size_t)field->nodes.lanes;
}

static galerkin_nodes half(const galerkin_field *field, int first)
{
    galerkin_nodes nodes = field->nodes;
    const size_t offset = (size_t)first * (size_t)nodes.lanes;
    nodes.unknowns /= 2;
    nodes.x += offset;
    nodes.base += offset;
    nodes.impulse += offset;
    nodes.start += first;
    nodes.scale += first;
    nodes.inverse_size += first;
    return nodes;
}

static void take_factor(lanes_factor *factor, tvi_arena *arena, int n, int lanes)
{
    const size_t numbers = (size_t)n * (size_t)lanes;
    *factor = (lanes_factor){.n = n, .lanes = lanes};
    factor->lu = tvi_arena_doubles(arena, (size_t)n * numbers);
    factor->row_scale = tvi_arena_doubles(arena, numbers);
    factor->column_scale = tvi_arena_doubles(arena, numbers);
    factor->pivot = tvi_arena_take(arena, numbers * sizeof(int));
    factor->x = tvi_arena_doubles(arena, numbers);
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const tvi_system *system = field->system;
    const int n = system->n, unknowns = 2 * n;
    const size_t lanes = (size_t)field->nodes.lanes, half_size = (size_t)n * lanes;
    lagrangian *taken = field->own = tvi_arena_take(arena, sizeof *taken);
    lagrangian w = {.loops = field->lagrangian};
    field->rows = 3 * n;
    field->nodes.x = tvi_arena_doubles(arena, 5 * half_size);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.values;
    field->ahead = tvi_arena_doubles(arena, lanes * lanes);
    w.velocity = tvi_arena_doubles(arena, (size_t)n);
    tvi_legendre_take(&w.legendre, arena, system);
    take_factor(&w.mass, arena, n, field->nodes.lanes);
    w.drives = field->nodes;
    w.drives.x = field->nodes.x ? row(field, unknowns) : NULL;
    w.drives.start = tvi_arena_doubles(arena, (size_t)unknowns);
    w.drives.scale = tvi_arena_doubles(arena, (size_t)unknowns);
    if (taken) *taken = w;
}

static void prepare(galerkin_field *field)
{
    lagrangian *w = field->own;
    const int lanes = field->nodes.lanes;
    tvi_galerkin_model_prepare(&w->model, field);
    tvi_legendre_prepare(&w->legendre);
    for (int i = 0; i < lanes; i++) {
        const int node = i < field->points ? i : field->points - 1;
        field->ahead[node * lanes + i] = 1 / field->b[node];
    }
    for (int u = 0; u < field->nodes.unknowns; u++) {
        field->slot[u] = field->nodes.unknowns + u;
    }
}

/* The gradient at the nodes, with second derivatives or without. */
static bool sweep(galerkin_field *field, bool with_second)
{
    lagrangian *w = field->own;
    const int n = field->system->n;
    return tvi_galerkin_model_evaluate(&w->model, field, with_second, row(field, 0), row(field, 2 * n),
                                       row(field, 3 * n));
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static void fill(galerkin_field *field, int first, const double value[])
{
    for (int i = 0; i < field->system->n; i++)
        for (int lane = 0; lane < field->nodes.lanes; lane++) row(field, first + i)[lane] = value[i];
}

/* V by the Legendre transform, from rest. */
static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    lagrangian *w = field->own;
    const tvi_system *system = field->system;
    const int n = system->n;
    double *velocity = w->velocity;
    memset(velocity, 0, (size_t)n * sizeof *velocity);
    const tvi_status status = tvi_legendre_solve(&w->legendre, origin->t, origin->q, origin->p, velocity);
    if (status != TVI_OK) return status;
    fill(field, 0, origin->q);
    fill(field, n, origin->p);
    fill(field, 2 * n, velocity);
    if (!sweep(field, false)) return TVI_EDOMAIN;
    w->moved = INFINITY;
    return TVI_OK;
}

/* V and F are impulses divided by h b. */
static void predict(galerkin_field *field, int steps, const double *extrapolation, const double *const impulses[])
{
    lagrangian *w = field->own;
    for (int u = 0; u < field->nodes.unknowns; u++) w->drives.scale[u] = 1 / field->h;
    field->loops->predict(&w->drives, steps, extrapolation, impulses);
    (void)field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot);
    w->moved = INFINITY;
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

/* L_vv of the block of second derivatives, factored. */
static tvi_status factor_mass(galerkin_field *field)
{
    lagrangian *w = field->own;
    const tvi_system *system = field->system;
    const size_t n = (size_t)system->n, lanes = (size_t)field->nodes.lanes, bytes = lanes * sizeof(double);
    const int *output = system->second_values->output + 2 * n;
    double *a = w->mass.lu, sum = 0;
    memset(a, 0, n * n * bytes);
    for (int k = 0; k < system->seconds; k++) {
        if (system->second[k].column < system->n) continue;
        const size_t i = (size_t)system->second[k].row - n, j = (size_t)system->second[k].column - n;
        const double *x = w->model.second + (size_t)output[k] * lanes;
        memcpy(a + (i * n + j) * lanes, x, bytes);
        memcpy(a + (j * n + i) * lanes, x, bytes);
    }
    for (size_t i = 0; i < n * n * lanes; i++) sum += 0 * a[i];
    if (sum != 0) return TVI_ENONFINITE;
    return w->loops->factor(&w->mass) > (double)n * DBL_EPSILON ? TVI_OK : TVI_ESINGULAR;
}

/* The gradient at the nodes, and new second derivatives where those at hand do not serve. */
static tvi_status evaluate(galerkin_field *field, tvi_stats *stats)
{
    const lagrangian *w = field->own;
    const bool serves = w->moved <= SERVES * field->nodes.unknowns * field->nodes.lanes;
    if (!sweep(field, !serves)) return TVI_EDOMAIN;
    if (serves) return TVI_OK;
    stats->factorisations += field->points;
    return factor_mass(field);
}

/* The unknowns, by the gradient at hand. */
static double iterate(galerkin_field *field)
{
    const lagrangian *w = field->own;
    const galerkin_loops *loops = field->loops;
    const int n = field->system->n;
    const galerkin_nodes positions = half(field, 0), momenta = half(field, n);
    const double moved = loops->move(&momenta, field->matrix, field->nodes.x, field->slot + n);
    w->loops->correct(&w->mass, row(field, n), row(field, 4 * n), row(field, 2 * n));
    return moved + loops->move(&positions, field->matrix, field->nodes.x, field->slot);
}

static tvi_status pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    lagrangian *w = field->own;
    const int n = field->system->n;
    const tvi_status status = evaluate(field, stats);
    if (status != TVI_OK) return status;
    w->moved = iterate(field);
    for (int i = 1; i < ITERATIONS; i++) {
        tvi_galerkin_model_linearise(&w->model, field, row(field, 0), row(field, 2 * n), row(field, 3 * n));
        w->moved += iterate(field);
    }
    *moved = w->moved;
    return TVI_OK;
}

const galerkin_form tvi_galerkin_form_lagrangian = {1, &tvi_galerkin_quasi_newton, take, prepare, start, predict, pass};
