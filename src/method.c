/* method.c - the methods, in one table. */
#include "method.h"
#include "quadrature.h"

#include <math.h>
#include <string.h>

/* The order of degree N is slope N + offset, rounded up to an even number for symmetric methods. */
typedef struct {
    const char *name; /* NULL: has none */
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    int slope, offset;
    bool symmetric;
    int least_degree, most_degree;
    const tvi_stepper *stepper;
} method_row;

static const method_row method_table[] = {
    {"tvi", TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, 1, 0, false, 1, TVI_MAX_DEGREE, &tvi_stepper_type1},
    {"start", TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, 2, 0, false, 1, TVI_MAX_DEGREE, &tvi_stepper_type1},
    {"midpoint", TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 2, 0, true, 1, TVI_MAX_DEGREE, &tvi_stepper_type1},
    {NULL, TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_TRUNCATED, 1, 0, true, 1, TVI_MAX_DEGREE, &tvi_stepper_type1},
    {"taylor", TVI_TAYLOR, TVI_AT_START, TVI_NODES_ON_CURVE, 1, -1, false, 2, TVI_MAX_DEGREE, &tvi_stepper_type1},
    {"stormer-verlet", TVI_STORMER_VERLET, TVI_AT_START, TVI_NODES_ON_CURVE, 0, 2, true, 1, 1, &tvi_stepper_verlet},
};
enum { METHOD_COUNT = sizeof method_table / sizeof *method_table, POINTS_MAX = TVI_MAX_DEGREE + 2 };

static int order_of(const method_row *row, int degree)
{
    const int order = row->slope * degree + row->offset;
    return row->symmetric ? order + order % 2 : order;
}

static tvi_status refuse(tvi_status status, const char *reason, const char **why)
{
    if (why) *why = reason;
    return status;
}

static const method_row *find_row(const tvi_options *options)
{
    for (int i = 0; i < METHOD_COUNT; i++) {
        const method_row *row = &method_table[i];
        if (row->method == options->method && row->expansion == options->expansion && row->nodes == options->nodes)
            return row;
    }
    return NULL;
}

static tvi_status check_ranges(const tvi_options *options, const char **why)
{
    if ((unsigned)options->method > TVI_STORMER_VERLET) return refuse(TVI_EINVAL, "method is not a tvi_method", why);
    if ((unsigned)options->expansion > TVI_AT_NODES) return refuse(TVI_EINVAL, "expansion is not a tvi_expansion", why);
    if ((unsigned)options->nodes > TVI_NODES_TRUNCATED) return refuse(TVI_EINVAL, "nodes is not a tvi_nodes", why);
    if ((unsigned)options->quadrature > TVI_RECTANGLE_END)
        return refuse(TVI_EINVAL, "quadrature is not a tvi_quadrature", why);
    if (options->order < 0) return refuse(TVI_EINVAL, "order is negative", why);
    if (options->degree < 0) return refuse(TVI_EINVAL, "degree is negative", why);
    if (options->quadrature_points < 0 || options->quadrature_points > POINTS_MAX)
        return refuse(TVI_EINVAL, "quadrature_points is negative or above TVI_MAX_DEGREE + 2", why);
    if (!(options->tolerance >= 0) || !isfinite(options->tolerance))
        return refuse(TVI_EINVAL, "tolerance is negative or not finite", why);
    if (options->passes < TVI_PREDICT_ONLY) return refuse(TVI_EINVAL, "passes is below TVI_PREDICT_ONLY", why);
    if (options->max_passes < 0) return refuse(TVI_EINVAL, "max_passes is negative", why);
    return TVI_OK;
}

static tvi_status resolve_degree(tvi_options *options, const method_row *row, const char **why)
{
    if (options->degree > 0) {
        if (options->degree < row->least_degree || options->degree > row->most_degree)
            return refuse(TVI_EINVAL, "the method has no such degree", why);
        options->order = order_of(row, options->degree);
        return TVI_OK;
    }
    for (int degree = row->least_degree; degree <= row->most_degree; degree++) {
        if (order_of(row, degree) != options->order) continue;
        options->degree = degree;
        return TVI_OK;
    }
    return refuse(TVI_EINVAL, "no degree gives the method this order", why);
}

/* The quadrature, and the order that is left with it: min(order of the curve, order of the quadrature). Without a number
 * of points, one more than the order needs. */
static tvi_status resolve_quadrature(tvi_options *options, bool order_was_asked, const char **why)
{
    if (options->quadrature == TVI_QUADRATURE_AUTO) options->quadrature = TVI_GAUSS;
    const int fixed = tvi_quadrature_fixed_points(options->quadrature);
    if (fixed && options->quadrature_points != 0 && options->quadrature_points != fixed)
        return refuse(TVI_EINVAL, "the quadrature has a fixed number of points", why);
    if (fixed) options->quadrature_points = fixed;
    if (options->quadrature_points == 0) {
        int points = tvi_quadrature_least_points(options->quadrature);
        while (tvi_quadrature_order(options->quadrature, points) < options->order) points++;
        options->quadrature_points = points + 1;
    }
    if (options->quadrature_points < tvi_quadrature_least_points(options->quadrature))
        return refuse(TVI_EINVAL, "the quadrature needs more points", why);
    const int order = tvi_quadrature_order(options->quadrature, options->quadrature_points);
    if (order_was_asked && order < options->order)
        return refuse(TVI_EINVAL, "the quadrature is of lower order than the method", why);
    if (order < options->order) options->order = order;
    return TVI_OK;
}

tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const tvi_stepper **stepper, const char **why)
{
    (void)system; /* every method of the table serves every system with a constant mass */
    tvi_status status = check_ranges(options, why);
    if (status != TVI_OK) return status;
    if (options->compose_adjoint)
        return refuse(TVI_EUNSUPPORTED, "compose_adjoint: no method of the table has an adjoint here", why);
    const method_row *row = find_row(options);
    if (!row) return refuse(TVI_EUNSUPPORTED, "the method does not exist with this expansion and node rule", why);
    const bool order_was_asked = options->degree == 0;
    status = resolve_degree(options, row, why);
    if (status == TVI_OK && options->method == TVI_TYPE1) status = resolve_quadrature(options, order_was_asked, why);
    if (status == TVI_OK && stepper) *stepper = row->stepper;
    return status;
}

tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why)
{
    if (!system || !options) return refuse(TVI_EINVAL, "system or options is NULL", why);
    tvi_options resolved = *options;
    return tvi_method_resolve(&resolved, system, NULL, why);
}

tvi_status tvi_options_named(const char *name, int order, tvi_options *options)
{
    if (!name || !options) return TVI_EINVAL;
    for (int i = 0; i < METHOD_COUNT; i++) {
        const method_row *row = &method_table[i];
        if (!row->name || strcmp(row->name, name) != 0) continue;
        tvi_options found = {.method = row->method, .expansion = row->expansion, .nodes = row->nodes, .order = order};
        tvi_options resolved = found;
        const tvi_status status = tvi_method_resolve(&resolved, NULL, NULL, NULL);
        if (status == TVI_OK) *options = found;
        return status;
    }
    return TVI_EINVAL;
}

tvi_options tvi_options_default(void)
{
    return (tvi_options){.method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT, .order = 12};
}
