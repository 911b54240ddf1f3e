/* predictor.c - Predicts the unknowns of a step from earlier steps (predictor.h). */
#include "galerkin/predictor.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_predictor_take(galerkin_predictor *w, tvi_arena *arena, const galerkin_field *field)
{
    const int unknowns = field->nodes.unknowns, lanes = field->nodes.lanes;
    const size_t count = (size_t)unknowns, width = (size_t)lanes;
    w->last = tvi_arena_allocate_history(arena, sizeof *w->last);
    w->rough_limit = unknowns * lanes * (1e-2 * 1e-2);
    for (int i = 0; i < GALERKIN_RING; i++)
        w->impulses[i] = tvi_arena_allocate_ring(arena, count * width * sizeof(double));
    w->from_two = tvi_arena_doubles(arena, 2 * width * width);
    w->from_last = tvi_arena_doubles(arena, 2 * width * width);
    w->from_one = tvi_arena_doubles(arena, width * width);
    w->extrapolated = tvi_arena_doubles(arena, count * width);
    w->none = tvi_arena_doubles(arena, count + width);
    w->one = tvi_arena_doubles(arena, count + width);
}

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

/* Computes basis[k][i]: polynomials of degree k, orthonormal on the first `fitted` of 3 m points, which are the nodes
 * of the last step, of the one before it, and of the next one. */
static void set_basis(const galerkin_coefficients *a, int fitted, int degree, long double basis[][3 * MAX_LANES])
{
    const int m = a->points;
    for (int k = 0; k <= degree; k++) {
        long double *now = basis[k];
        for (int i = 0; i < 3 * m; i++) {
            const long double s = a->exact_node[i % m] + (i < m ? 0 : i < 2 * m ? -1 : 1);
            now[i] = k > 0 ? s * basis[k - 1][i] : 1;
        }
        for (int before = 0; before <= k; before++) { /* the last time: its own length */
            long double product = 0;
            /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): m >= 1 */
            for (int i = 0; i < fitted; i++) product += now[i] * basis[before][i];
            for (int i = 0; i < 3 * m && before < k; i++) now[i] -= product * basis[before][i];
            for (int i = 0; i < 3 * m && before == k; i++) now[i] /= sqrtl(product);
        }
    }
}

/* Computes ahead [point][next], of 2 m points and m: the factors of the rates of `steps` steps in those of the next
 * step, for polynomials of least squares, sum_k pi_k(1 + c_next) pi_k(s_point). */
static void set_ahead(const galerkin_coefficients *a, int steps, int degree, long double ahead[][MAX_LANES])
{
    long double basis[2 * MAX_LANES][3 * MAX_LANES];
    const int m = a->points;
    set_basis(a, steps * m, degree, basis);
    for (int point = 0; point < steps * m; point++)
        for (int next = 0; next < m; next++) {
            ahead[point][next] = 0;
            for (int k = 0; k <= degree; k++) ahead[point][next] += basis[k][2 * m + next] * basis[k][point];
        }
}

static void set_polynomial(const galerkin_coefficients *a, const galerkin_field *field, int steps, int degree,
                           double *table)
{
    long double ahead[2 * MAX_LANES][MAX_LANES];
    const int m = a->points, lanes = a->lanes;
    set_ahead(a, steps, degree, ahead);
    for (int point = 0; point < steps * m; point++)
        for (int next = 0; next < m; next++) {
            double *column = table + (point / m * lanes + point % m) * lanes;
            const double part = (double)(ahead[point][next] * a->exact_weight[next] / a->exact_weight[point % m]);
            for (int i = 0; i < lanes; i++) column[i] += part * field->ahead[next * lanes + i];
        }
}

/* Prepares the tables. The degree 3m/2 for two steps saved the most passes: above it roundoff grows by more than
 * truncation falls. */
void tvi_galerkin_predictor_prepare(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_field *field)
{
    const int degree = a->points > 1 ? 3 * a->points / 2 : 1;
    set_polynomial(a, field, 2, degree, w->from_two);
    set_polynomial(a, field, 1, a->points - 1, w->from_last);
    for (int i = 0; i < field->nodes.unknowns + a->lanes; i++) w->one[i] = 1;
}

/* Computes the table from a step of size h / ratio to one that begins after a part of it: its node i is at part + ratio
 * c_i there. */
static void set_from_one(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_dense *dense,
                         const galerkin_loops *loops, double ratio, double part)
{
    if (ratio == w->ratio && part == w->part) return;
    w->ratio = ratio;
    w->part = part;
    const int lanes = a->lanes;
    const galerkin_evaluation at_nodes = {lanes, lanes, a->points, a->c, w->none, w->none, w->one};
    double place[MAX_LANES] = {0}, P[MAX_LANES * MAX_LANES] = {0};
    for (int i = 0; i < lanes; i++) place[i] = part + ratio * a->c[i];
    tvi_galerkin_dense_legendre(dense, lanes, place, P);
    loops->evaluate(&at_nodes, P, dense->of_node, w->from_one);
    for (int j = 0; j < a->points; j++)
        for (int i = 0; i < lanes; i++) w->from_one[j * lanes + i] *= ratio * a->b[i];
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

bool tvi_galerkin_can_extrapolate(const galerkin_predictor *w, const galerkin_field *field, double t, double *part)
{
    const galerkin_history *last = w->last;
    if (last->h == 0) return false;
    const double ratio = field->h == last->h ? 1 : field->h / last->h;
    const bool is_next = galerkin_is_next(last, field->h, t);
    *part = is_next ? 1 : 0;
    return ratio <= 1.5 && (is_next ? ratio >= -2 : t == last->t && ratio > 0);
}

int tvi_galerkin_known(const galerkin_predictor *w, const galerkin_field *field, double part)
{
    const galerkin_history *last = w->last;
    if (part != 1 || field->h != last->h) return 0;
    return field->h == last->h_before ? 2 : 1;
}

void tvi_galerkin_extrapolate(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_dense *dense,
                              galerkin_field *field, double part)
{
    const galerkin_evaluation to = {a->lanes, a->lanes, field->nodes.unknowns, a->c, w->none, w->none, w->one};
    const long long last_alone = -1;
    set_from_one(w, a, dense, field->loops, field->h / w->last->h, part);
    field->loops->evaluate(&to, w->from_one, tvi_galerkin_impulses(w, 0), w->extrapolated);
    field->form->predict(field, &(galerkin_extrapolation){field->h, field->ahead, field->ahead, w->extrapolated,
                                                          w->extrapolated, &last_alone});
}
