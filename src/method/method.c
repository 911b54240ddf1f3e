/* method.c - the methods, in one table. */
#include "method/method.h"
#include "algebra/quadrature.h"

#include <math.h>
#include <string.h>

/* What a method asks of a system. */
enum { SERVES_SEPARABLE = 1, SERVES_LAGRANGIAN = 2, SERVES_REGULAR = 4, SERVES_DEGENERATE = 8 };
enum {
    TYPE1_SERVES = SERVES_SEPARABLE | SERVES_LAGRANGIAN | SERVES_REGULAR,
    HAMILTON_SERVES = SERVES_SEPARABLE | SERVES_REGULAR | SERVES_DEGENERATE,
    ALL_SERVES = TYPE1_SERVES | HAMILTON_SERVES
};

/* The order of degree N is slope N + offset, rounded up to an even number for symmetric methods. */
typedef struct {
    const char *name; /* NULL: has none */
    tvi_method method;
    tvi_expansion expansion;
    tvi_nodes nodes;
    int slope, offset;
    bool symmetric;
    int least_degree, most_degree;
    int serves;
} method_row;

#define ON_CURVE  TVI_NODES_ON_CURVE
#define TRUNCATED TVI_NODES_TRUNCATED
#define MOST      TVI_MAX_DEGREE

static const method_row method_table[] = {
    {"tvi", TVI_TYPE1, TVI_AT_START, TRUNCATED, 1, 0, false, 1, MOST, TYPE1_SERVES},
    {"start", TVI_TYPE1, TVI_AT_START, ON_CURVE, 2, 0, false, 1, MOST, TYPE1_SERVES},
    {NULL, TVI_TYPE1, TVI_AT_END, TRUNCATED, 1, 0, false, 1, MOST, TYPE1_SERVES},
    {"end", TVI_TYPE1, TVI_AT_END, ON_CURVE, 2, 0, false, 1, MOST, TYPE1_SERVES},
    {NULL, TVI_TYPE1, TVI_AT_MIDPOINT, TRUNCATED, 1, 0, true, 1, MOST, TYPE1_SERVES},
    {"midpoint", TVI_TYPE1, TVI_AT_MIDPOINT, ON_CURVE, 2, 0, true, 1, MOST, TYPE1_SERVES},
    {"symmetric-tvi", TVI_TYPE1, TVI_AT_BOTH_ENDS, TRUNCATED, 1, 0, true, 1, MOST, TYPE1_SERVES},
    {"both-ends", TVI_TYPE1, TVI_AT_BOTH_ENDS, ON_CURVE, 2, 0, true, 1, MOST, TYPE1_SERVES},
    {"galerkin", TVI_TYPE1, TVI_AT_NODES, ON_CURVE, 2, 0, true, 1, TVI_MAX_NODES, ALL_SERVES},
    {"htvi-right", TVI_TYPE2, TVI_AT_START, TRUNCATED, 1, 0, false, 1, MOST, HAMILTON_SERVES},
    {"right", TVI_TYPE2, TVI_AT_START, ON_CURVE, 2, 0, false, 1, MOST, HAMILTON_SERVES},
    {NULL, TVI_TYPE2, TVI_AT_END, TRUNCATED, 1, 0, false, 1, MOST, HAMILTON_SERVES},
    {NULL, TVI_TYPE2, TVI_AT_END, ON_CURVE, 2, 0, false, 1, MOST, HAMILTON_SERVES},
    {"htvi-left", TVI_TYPE3, TVI_AT_START, TRUNCATED, 1, 0, false, 1, MOST, HAMILTON_SERVES},
    {"left", TVI_TYPE3, TVI_AT_START, ON_CURVE, 2, 0, false, 1, MOST, HAMILTON_SERVES},
    {NULL, TVI_TYPE3, TVI_AT_END, TRUNCATED, 1, 0, false, 1, MOST, HAMILTON_SERVES},
    {NULL, TVI_TYPE3, TVI_AT_END, ON_CURVE, 2, 0, false, 1, MOST, HAMILTON_SERVES},
    {"poincare", TVI_POINCARE, TVI_AT_MIDPOINT, ON_CURVE, 2, 2, true, 0, MOST, HAMILTON_SERVES},
    {"taylor", TVI_TAYLOR, TVI_AT_START, ON_CURVE, 1, -1, false, 2, MOST, ALL_SERVES},
    {"stormer-verlet", TVI_STORMER_VERLET, TVI_AT_START, ON_CURVE, 0, 2, true, 1, 1, SERVES_SEPARABLE},
};
enum { METHOD_COUNT = sizeof method_table / sizeof *method_table };

/* "svhd" is a composition: type II at the start, N = 1, with the trapezoid (docs/method.md section 7). */
static const tvi_options svhd = {.method = TVI_TYPE2,
                                 .nodes = TVI_NODES_TRUNCATED,
                                 .degree = 1,
                                 .order = 2,
                                 .compose_adjoint = true,
                                 .quadrature = TVI_TRAPEZOID};

static bool has_adjoint(const method_row *row) { return row->method <= TVI_POINCARE; }

static int order_of(const method_row *row, int degree, bool composed)
{
    const int order = row->slope * degree + row->offset;
    return row->symmetric || composed ? order + order % 2 : order;
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
    if (options->quadrature_points < 0 || options->quadrature_points > TVI_MAX_POINTS)
        return refuse(TVI_EINVAL, "quadrature_points is negative or above TVI_MAX_DEGREE + 2", why);
    if (!(options->tolerance >= 0) || !isfinite(options->tolerance))
        return refuse(TVI_EINVAL, "tolerance is negative or not finite", why);
    if (options->passes < TVI_PREDICT_ONLY) return refuse(TVI_EINVAL, "passes is below TVI_PREDICT_ONLY", why);
    if (options->max_passes < 0) return refuse(TVI_EINVAL, "max_passes is negative", why);
    return TVI_OK;
}

/* Why the method does not serve the system, NULL where it does. */
static const char *misfit(const method_row *row, const tvi_system *system)
{
    const int form = system->form == TVI_SEPARABLE    ? SERVES_SEPARABLE
                     : system->form == TVI_LAGRANGIAN ? SERVES_LAGRANGIAN
                     : system->regular                ? SERVES_REGULAR
                                                      : SERVES_DEGENERATE;
    if (row->serves & form) return NULL;
    if (row->method == TVI_STORMER_VERLET)
        return "Stormer-Verlet needs a constant diagonal mass and a force without velocities";
    if (form == SERVES_LAGRANGIAN)
        return "types II, III and Poincare need the Hamiltonian: write it instead of the Lagrangian";
    return "type I needs a Hamiltonian with regular H_pp, and this one is degenerate: take type II, III or Poincare";
}

static tvi_status resolve_degree(tvi_options *options, const method_row *row, const char **why)
{
    const bool composed = options->compose_adjoint;
    if (options->degree > 0) {
        if (options->degree < row->least_degree || options->degree > row->most_degree)
            return refuse(TVI_EINVAL, "the method has no such degree", why);
        options->order = order_of(row, options->degree, composed);
        return TVI_OK;
    }
    for (int degree = row->least_degree; degree <= row->most_degree; degree++) {
        if (order_of(row, degree, composed) != options->order) continue;
        options->degree = degree;
        return TVI_OK;
    }
    return refuse(TVI_EINVAL, "no degree gives the method this order", why);
}

/* The Galerkin curve has its values at the nodes of the quadrature. */
static tvi_status resolve_nodes(tvi_options *options, const char **why)
{
    if (options->quadrature != TVI_QUADRATURE_AUTO && options->quadrature != TVI_GAUSS)
        return refuse(TVI_EUNSUPPORTED, "the Galerkin curve needs the Gauss quadrature", why);
    if (options->quadrature_points != 0 && options->quadrature_points != options->degree)
        return refuse(TVI_EINVAL, "the Galerkin curve has as many quadrature points as its degree", why);
    options->quadrature = TVI_GAUSS;
    options->quadrature_points = options->degree;
    return TVI_OK;
}

/* The quadrature, and the order that is left with it: min(order of the curve, order of the quadrature). Without a
 * number of points, one more than the order needs. */
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
        options->quadrature_points = points < TVI_MAX_POINTS ? points + 1 : points;
    }
    if (options->quadrature_points < tvi_quadrature_least_points(options->quadrature))
        return refuse(TVI_EINVAL, "the quadrature needs more points", why);
    int order = tvi_quadrature_order(options->quadrature, options->quadrature_points);
    if (options->compose_adjoint) order += order % 2;
    if (order_was_asked && order < options->order)
        return refuse(TVI_EINVAL, "the quadrature is of lower order than the method", why);
    if (order < options->order) options->order = order;
    return TVI_OK;
}

tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const char **why)
{
    tvi_status status = check_ranges(options, why);
    if (status != TVI_OK) return status;
    const method_row *row = find_row(options);
    if (!row) return refuse(TVI_EUNSUPPORTED, "the method does not exist with this expansion and node rule", why);
    if (options->compose_adjoint && !has_adjoint(row))
        return refuse(TVI_EUNSUPPORTED, "compose_adjoint is for generating functions", why);
    const char *reason = system ? misfit(row, system) : NULL;
    if (reason) return refuse(TVI_EUNSUPPORTED, reason, why);
    const bool order_was_asked = options->degree == 0;
    status = resolve_degree(options, row, why);
    if (status != TVI_OK || !has_adjoint(row)) return status;
    if (row->expansion == TVI_AT_NODES) return resolve_nodes(options, why);
    return resolve_quadrature(options, order_was_asked, why);
}

const tvi_stepper *tvi_method_stepper(const tvi_options *options)
{
    if (options->compose_adjoint) return &tvi_stepper_composed;
    if (options->method == TVI_STORMER_VERLET) return &tvi_stepper_verlet;
    if (options->expansion == TVI_AT_NODES) return &tvi_stepper_galerkin;
    const bool both_ends = options->expansion == TVI_AT_BOTH_ENDS && options->passes != TVI_PREDICT_ONLY;
    return both_ends ? &tvi_stepper_both_ends : &tvi_stepper_curve;
}

tvi_options tvi_options_adjoint(const tvi_options *options)
{
    tvi_options adjoint = *options;
    if (options->expansion == TVI_AT_START) adjoint.expansion = TVI_AT_END;
    if (options->expansion == TVI_AT_END) adjoint.expansion = TVI_AT_START;
    if (options->method == TVI_TYPE2) adjoint.method = TVI_TYPE3;
    if (options->method == TVI_TYPE3) adjoint.method = TVI_TYPE2;
    if (options->quadrature == TVI_RECTANGLE_START) adjoint.quadrature = TVI_RECTANGLE_END;
    if (options->quadrature == TVI_RECTANGLE_END) adjoint.quadrature = TVI_RECTANGLE_START;
    return adjoint;
}

tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why)
{
    if (!system || !options) return refuse(TVI_EINVAL, "system or options is NULL", why);
    tvi_options resolved = *options;
    return tvi_method_resolve(&resolved, system, why);
}

static tvi_status named_row(const method_row *row, int order, tvi_options *options)
{
    const tvi_options found = {.method = row->method, .expansion = row->expansion, .nodes = row->nodes, .order = order};
    tvi_options resolved = found;
    const tvi_status status = tvi_method_resolve(&resolved, NULL, NULL);
    if (status == TVI_OK) *options = found;
    return status;
}

tvi_status tvi_options_named(const char *name, int order, tvi_options *options)
{
    if (!name || !options) return TVI_EINVAL;
    for (int i = 0; i < METHOD_COUNT; i++)
        if (method_table[i].name && strcmp(method_table[i].name, name) == 0)
            return named_row(&method_table[i], order, options);
    if (strcmp(name, "svhd") != 0 || order != svhd.order) return TVI_EINVAL;
    *options = svhd;
    return TVI_OK;
}

enum { DEFAULT_ORDER = 16 }; /* of least cost over the scenes (docs/choosing.md) */

tvi_options tvi_options_default(void)
{
    return (tvi_options){.method = TVI_TYPE1, .expansion = TVI_AT_NODES, .order = DEFAULT_ORDER};
}
