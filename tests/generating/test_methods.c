/* test_methods.c - Tests the library's list of methods: every descriptor is whole, and those of docs/method.md section
 * 3 are there. */
#include "generating.h"
#include "models.h"
#include "method/list.h"
#include "method/method.h"

#include <string.h>

static bool expands(const tvi_descriptor *d) { return d->curve.equations.upper_sum != TVI_NO_SUM; }

/* A member that was forgotten is 0. */
START_TEST(descriptors_are_whole)
{
    for (const tvi_descriptor *const *at = tvi_methods; *at; at++) {
        const tvi_descriptor *d = *at, *adjoint = d->adjoint;
        ck_assert_ptr_nonnull(d->title);
        ck_assert_msg(d->supports && d->stepper && (d->nodes[0].order_per_degree || d->nodes[0].order_offset), "%s",
                      d->title);
        ck_assert_msg(0 <= d->least_degree && d->least_degree <= d->most_degree, "%s", d->title);
        ck_assert_msg(!adjoint == (d->quadrature == TVI_NO_QUADRATURE), "%s", d->title);
        ck_assert_msg(!adjoint || adjoint->adjoint == d, "%s", d->title);
        ck_assert_msg(d->quadrature != TVI_CHOSEN_QUADRATURE || d->needs_conjugate_momenta, "%s", d->title);
        ck_assert_msg(d->quadrature != TVI_CHOSEN_QUADRATURE || d->most_degree == TVI_MAX_DEGREE, "%s", d->title);
        ck_assert_msg(!expands(d) || (adjoint && d->curve.step_span.end_s > d->curve.step_span.start_s), "%s",
                      d->title);
    }
}
END_TEST

/* The option for the same place of the step, seen from its other end. */
START_TEST(adjoints_are_mirrored)
{
    for (const tvi_descriptor *const *at = tvi_methods; *at; at++) {
        const tvi_descriptor *d = *at, *adjoint = d->adjoint;
        if (!expands(d)) continue;
        const tvi_step_span a = d->curve.step_span, b = adjoint->curve.step_span;
        ck_assert_msg(a.start_s == -b.end_s && a.end_s == -b.start_s && a.tau_over_h == b.tau_over_h, "%s", d->title);
        ck_assert_double_eq_tol((a.end_s - a.start_s) * a.tau_over_h, 1, 1e-15);
        ck_assert_msg(d->curve.action == adjoint->curve.action && d->supports == adjoint->supports, "%s", d->title);
        ck_assert_mem_eq(&d->nodes[0].order_per_degree, &adjoint->nodes[0].order_per_degree, 2 * sizeof(int));
    }
}
END_TEST

/* The centre at which the paper, and section 3, expand: the part of the step before the centre. */
static const struct {
    tvi_method method;
    tvi_expansion expansion;
    double before;
} places[] = {
    {TVI_TYPE1, TVI_AT_START, 0},     {TVI_TYPE1, TVI_AT_END, 1},   {TVI_TYPE1, TVI_AT_MIDPOINT, 0.5},
    {TVI_TYPE1, TVI_AT_BOTH_ENDS, 0}, {TVI_TYPE2, TVI_AT_START, 0}, {TVI_TYPE2, TVI_AT_END, 1},
    {TVI_TYPE3, TVI_AT_START, 0},     {TVI_TYPE3, TVI_AT_END, 1},   {TVI_POINCARE, TVI_AT_MIDPOINT, 0.5},
};
enum { PLACES = sizeof places / sizeof *places };

START_TEST(curves_are_expanded_where_they_are_called)
{
    const tvi_options options = {.method = places[_i].method, .expansion = places[_i].expansion};
    const tvi_descriptor *d = tvi_find_method(&options);
    ck_assert_ptr_nonnull(d);
    ck_assert_double_eq(-d->curve.step_span.start_s * d->curve.step_span.tau_over_h, places[_i].before);
}
END_TEST

/* Each name leads to its own method. */
START_TEST(names_are_their_own)
{
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++) {
            const char *name = (*d)->nodes[nodes].name;
            tvi_options options = {.order = 0};
            for (int order = 1; name && order <= 2 && options.order == 0; order++)
                (void)!tvi_options_named(name, order, &options);
            ck_assert_msg(!name || (tvi_find_method(&options) == *d && (int)options.nodes == nodes), "%s", name);
        }
}
END_TEST

Suite *suite_methods(void)
{
    Suite *suite = suite_create("methods");
    TCase *tcase = tcase_create("methods");
    tcase_add_test(tcase, descriptors_are_whole);
    tcase_add_test(tcase, adjoints_are_mirrored);
    tcase_add_loop_test(tcase, curves_are_expanded_where_they_are_called, 0, PLACES);
    tcase_add_test(tcase, names_are_their_own);
    suite_add_tcase(suite, tcase);
    return suite;
}
