/* method.c - Finds the method that given options name, and completes the options (method.h). */
#include "method/method.h"
#include "algebra/quadrature.h"
#include "method/list.h"
#include "system/refuse.h"

#include <math.h>
#include <string.h>

/* [orders] A method has this order if the user chooses none. It has the least cost in all scenes (docs/choosing.md). */
#define DEFAULT_ORDER 16 /* found: make choose */
/* [1] With an automatic time scale, the largest tail of a step is 2^(AUTOMATIC_TAIL_FIRST_EXPONENT - order / 2). With a
 * smaller limit good steps would be refused (docs/adaptive.md). */
#define AUTOMATIC_TAIL_FIRST_EXPONENT 3 /* found: make tails */
/* [orders] Higher orders have the largest tail of this order. */
#define AUTOMATIC_TAIL_LAST_ORDER 16 /* found: make tails */

enum {
    TYPE1_SUPPORTS = TVI_SUPPORTS_SEPARABLE | TVI_SUPPORTS_LAGRANGIAN | TVI_SUPPORTS_REGULAR,
    HAMILTON_SUPPORTS = TVI_SUPPORTS_SEPARABLE | TVI_SUPPORTS_REGULAR | TVI_SUPPORTS_DEGENERATE
};
const tvi_supported_forms tvi_supports_all = {
    TYPE1_SUPPORTS | HAMILTON_SUPPORTS | TVI_SUPPORTS_DRIVEN | TVI_SUPPORTS_FIELD, NULL};
const tvi_supported_forms tvi_supports_all_but_field = {TYPE1_SUPPORTS | HAMILTON_SUPPORTS | TVI_SUPPORTS_DRIVEN, NULL};
const tvi_supported_forms tvi_supports_type1 = {
    TYPE1_SUPPORTS,
    "type I needs a Hamiltonian with regular H_pp, and this one is degenerate: take type II, III or Poincare"};
const tvi_supported_forms tvi_supports_hamilton = {
    HAMILTON_SUPPORTS, "types II, III and Poincare need the Hamiltonian: write it instead of the Lagrangian"};

#define ONE(method)                   &method,
#define WITH_ADJOINT(method, adjoint) &method, &adjoint,
const tvi_descriptor *const tvi_methods[] = {TVI_METHOD_LIST(ONE, WITH_ADJOINT) NULL};

/* Sets *why to the reason of a refusal, and returns `status`. */
static tvi_status refuse_with_reason(tvi_status status, const char *reason, const char **why)
{
    *why = reason;
    return status;
}

static int compute_order(const tvi_descriptor *descriptor, const tvi_options *options, int degree)
{
    const tvi_order_with_node_rule *rule = &descriptor->nodes[options->nodes];
    const int order = rule->order_per_degree * degree + rule->order_offset;
    return tvi_is_method_symmetric(descriptor) || options->compose_adjoint ? order + order % 2 : order;
}

static bool has_only_even_orders(const tvi_descriptor *descriptor, const tvi_options *options)
{
    const int least = descriptor->least_degree;
    return (compute_order(descriptor, options, least) | compute_order(descriptor, options, least + 1)) % 2 == 0;
}

/* ---- From options to methods ------------------------------------------------------------------------------------- */

static bool has_node_rule(const tvi_descriptor *descriptor, tvi_nodes nodes)
{
    return descriptor->nodes[nodes].order_per_degree != 0 || descriptor->nodes[nodes].order_offset != 0;
}

const tvi_descriptor *tvi_find_method(const tvi_options *options)
{
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        if ((*d)->method == options->method && (*d)->expansion == options->expansion &&
            has_node_rule(*d, options->nodes))
            return *d;
    return NULL;
}

/* Refuses values of `method` and `expansion` that no method has. */
static tvi_status check_method_and_expansion(const tvi_options *options, const char **why)
{
    bool has_method = false, has_expansion = false;
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++) {
        has_method |= (*d)->method == options->method;
        has_expansion |= (*d)->expansion == options->expansion;
    }
    if (!has_method) return refuse_with_reason(TVI_EINVAL, "method is not a tvi_method", why);
    return has_expansion ? TVI_OK : refuse_with_reason(TVI_EINVAL, "expansion is not a tvi_expansion", why);
}

static tvi_status check_option_ranges(const tvi_options *options, const char **why)
{
    const tvi_status status = check_method_and_expansion(options, why);
    if (status != TVI_OK) return status;
    if ((unsigned)options->nodes > TVI_NODES_TRUNCATED)
        return refuse_with_reason(TVI_EINVAL, "nodes is not a tvi_nodes", why);
    if ((unsigned)options->quadrature > TVI_RECTANGLE_END)
        return refuse_with_reason(TVI_EINVAL, "quadrature is not a tvi_quadrature", why);
    if (options->order < 0) return refuse_with_reason(TVI_EINVAL, "order is negative", why);
    if (options->degree < 0) return refuse_with_reason(TVI_EINVAL, "degree is negative", why);
    if (options->quadrature_points < 0 || options->quadrature_points > TVI_MAX_POINTS)
        return refuse_with_reason(TVI_EINVAL, "quadrature_points is negative or above TVI_MAX_DEGREE + 2", why);
    if (!(options->tolerance >= 0) || !isfinite(options->tolerance))
        return refuse_with_reason(TVI_EINVAL, "tolerance is negative or not finite", why);
    if (options->passes < TVI_PREDICT_ONLY)
        return refuse_with_reason(TVI_EINVAL, "passes is below TVI_PREDICT_ONLY", why);
    if (options->max_passes < 0) return refuse_with_reason(TVI_EINVAL, "max_passes is negative", why);
    if (isnan(options->max_tail)) return refuse_with_reason(TVI_EINVAL, "max_tail is not a number", why);
    return TVI_OK;
}

/* Returns the reason why the method cannot integrate the system. Returns NULL if it can. */
static const char *find_why_unsupported(const tvi_descriptor *descriptor, const tvi_system *system)
{
    const int forms = descriptor->supports->form_mask;
    if (system->constraints && !descriptor->constrained)
        return "a constrained system is for galerkin, or stormer-verlet (RATTLE)";
    if (system->is_driven)
        return forms & TVI_SUPPORTS_DRIVEN ? NULL
                                           : "a driven system has no generating function: take galerkin or taylor";
    if (system->form == TVI_FIELD)
        return forms & TVI_SUPPORTS_FIELD  ? NULL
               : system->record.is_tangent ? "the tangent system of a Hamiltonian or a driven system is for galerkin"
                                           : "the reversible form of a rescaled system is for galerkin";
    const int form = system->form == TVI_SEPARABLE    ? TVI_SUPPORTS_SEPARABLE
                     : system->form == TVI_LAGRANGIAN ? TVI_SUPPORTS_LAGRANGIAN
                     : system->is_regular             ? TVI_SUPPORTS_REGULAR
                                                      : TVI_SUPPORTS_DEGENERATE;
    return forms & form ? NULL : descriptor->supports->refusal_text;
}

static tvi_status resolve_degree(tvi_options *options, const tvi_descriptor *descriptor, const char **why)
{
    const int least = descriptor->least_degree, most = descriptor->most_degree;
    if (options->degree > 0) {
        if (options->degree < least || options->degree > most)
            return refuse_with_reason(TVI_EINVAL, "the method has no such degree", why);
        options->order = compute_order(descriptor, options, options->degree);
        return TVI_OK;
    }
    for (int degree = least; degree <= most; degree++) {
        if (compute_order(descriptor, options, degree) != options->order) continue;
        options->degree = degree;
        return TVI_OK;
    }
    if (has_only_even_orders(descriptor, options) && options->order % 2 != 0)
        return refuse_with_reason(TVI_EINVAL, "the orders of the method are even", why);
    return refuse_with_reason(TVI_EINVAL, "no degree gives the method this order", why);
}

/* Sets the quadrature of the Galerkin curve, which is Gauss with as many nodes as the degree. Refuses options that
 * request another quadrature or another number of nodes. */
static tvi_status resolve_gauss_quadrature(tvi_options *options, const char **why)
{
    if (options->quadrature != TVI_QUADRATURE_AUTO && options->quadrature != TVI_GAUSS)
        return refuse_with_reason(TVI_EUNSUPPORTED, "the Galerkin curve needs the Gauss quadrature", why);
    if (options->quadrature_points != 0 && options->quadrature_points != options->degree)
        return refuse_with_reason(TVI_EINVAL, "the Galerkin curve has as many quadrature points as its degree", why);
    options->quadrature = TVI_GAUSS;
    options->quadrature_points = options->degree;
    return TVI_OK;
}

/* Sets the quadrature of a method for which the user may choose one, and makes the order the smaller one of the orders
 * of the curve and of the quadrature. Refuses a quadrature of lower order than the curve if the user requested the
 * order. By default the quadrature has one point more than the order needs. */
static tvi_status resolve_chosen_quadrature(tvi_options *options, bool is_order_requested, const char **why)
{
    if (options->quadrature == TVI_QUADRATURE_AUTO) options->quadrature = TVI_GAUSS;
    const int fixed = tvi_quadrature_fixed_points(options->quadrature);
    if (fixed && options->quadrature_points != 0 && options->quadrature_points != fixed)
        return refuse_with_reason(TVI_EINVAL, "the quadrature has a fixed number of points", why);
    if (fixed) options->quadrature_points = fixed;
    if (options->quadrature_points == 0) {
        int points = tvi_quadrature_least_points(options->quadrature);
        while (tvi_quadrature_order(options->quadrature, points) < options->order) points++;
        options->quadrature_points = points < TVI_MAX_POINTS ? points + 1 : points;
    }
    if (options->quadrature_points < tvi_quadrature_least_points(options->quadrature))
        return refuse_with_reason(TVI_EINVAL, "the quadrature needs more points", why);
    int order = tvi_quadrature_order(options->quadrature, options->quadrature_points);
    if (options->compose_adjoint) order += order % 2;
    if (is_order_requested && order < options->order)
        return refuse_with_reason(TVI_EINVAL, "the quadrature is of lower order than the method", why);
    if (order < options->order) options->order = order;
    return TVI_OK;
}

/* Returns the default of max_tail. Steps with an automatic time scale are less uniform than other steps, since the
 * scale does not depend on everything that limits a step. The default for these steps decreases with the order, down to
 * 1/32 from order 16 on. With a smaller default, good steps would be refused (docs/adaptive.md). */
static double choose_default_max_tail(const tvi_options *options, const tvi_system *system)
{
    if (!system || !system->tail.has_automatic_scale) return TVI_MAX_TAIL;
    return fmin(TVI_MAX_TAIL,
                exp2(AUTOMATIC_TAIL_FIRST_EXPONENT - fmin(options->order, AUTOMATIC_TAIL_LAST_ORDER) / 2));
}

static tvi_status resolve_options(tvi_options *options, const tvi_system *system, const char **why)
{
    tvi_status status = check_option_ranges(options, why);
    if (status != TVI_OK) return status;
    const tvi_descriptor *descriptor = tvi_find_method(options);
    if (!descriptor)
        return refuse_with_reason(TVI_EUNSUPPORTED, "the method does not exist with this expansion and node rule", why);
    if (options->compose_adjoint && !descriptor->adjoint)
        return refuse_with_reason(TVI_EUNSUPPORTED, "compose_adjoint is for generating functions", why);
    const char *reason = system ? find_why_unsupported(descriptor, system) : NULL;
    if (reason) return refuse_with_reason(TVI_EUNSUPPORTED, reason, why);
    if (system && system->constraints && options->passes != 0)
        return refuse_with_reason(TVI_EUNSUPPORTED, "a step on constraints makes as many passes as it needs", why);
    const bool is_order_requested = options->degree == 0;
    status = resolve_degree(options, descriptor, why);
    if (status != TVI_OK) return status;
    if (options->max_tail == 0) options->max_tail = choose_default_max_tail(options, system);
    switch (descriptor->quadrature) {
    case TVI_CHOSEN_QUADRATURE: return resolve_chosen_quadrature(options, is_order_requested, why);
    case TVI_GAUSS_OF_DEGREE: return resolve_gauss_quadrature(options, why);
    default: return TVI_OK;
    }
}

tvi_status tvi_options_resolve(tvi_options *options, const tvi_system *system, const char **why)
{
    const tvi_options requested = *options;
    const char *reason;
    const tvi_status status = resolve_options(options, system, &reason);
    if (status == TVI_OK) return status;
    if (why) *why = reason;
    const bool has_node_rule = (unsigned)requested.nodes <= TVI_NODES_TRUNCATED;
    const tvi_descriptor *descriptor = has_node_rule ? tvi_find_method(&requested) : NULL;
    return jet_refuse(status, "%s (%s, order = %d, degree = %d)", reason, descriptor ? descriptor->title : "no method",
                      requested.order, requested.degree);
}

/* ---- Steppers ---------------------------------------------------------------------------------------------------- */

/* The folders galerkin and generating are compiled once for each instruction set; the Makefile gives the names of all
 * sets but the base a suffix. The sweeps of the system's tapes, which ad/isa.c chooses, tell the set. */
#ifdef JET_ISA_X86
extern const tvi_stepper tvi_stepper_curve_avx2, tvi_stepper_both_ends_avx2, tvi_stepper_taylor_avx2,
    tvi_stepper_galerkin_avx2, tvi_stepper_constrained_avx2, tvi_stepper_curve_avx512, tvi_stepper_both_ends_avx512,
    tvi_stepper_taylor_avx512, tvi_stepper_galerkin_avx512, tvi_stepper_constrained_avx512;
static const tvi_stepper *const steppers[][JET_ISA_COUNT] = {
    {&tvi_stepper_curve, &tvi_stepper_curve_avx2, &tvi_stepper_curve_avx512},
    {&tvi_stepper_both_ends, &tvi_stepper_both_ends_avx2, &tvi_stepper_both_ends_avx512},
    {&tvi_stepper_taylor, &tvi_stepper_taylor_avx2, &tvi_stepper_taylor_avx512},
    {&tvi_stepper_galerkin, &tvi_stepper_galerkin_avx2, &tvi_stepper_galerkin_avx512},
    {&tvi_stepper_constrained, &tvi_stepper_constrained_avx2, &tvi_stepper_constrained_avx512},
};
#else
static const tvi_stepper *const steppers[][JET_ISA_COUNT] = {{NULL}};
#endif

/* Returns the stepper for this set. A stepper that is compiled once serves all sets. */
static const tvi_stepper *stepper_of_set(const tvi_stepper *base, jet_isa isa)
{
    for (size_t i = 0; i < sizeof steppers / sizeof *steppers; i++)
        if (steppers[i][jet_isa_base] == base) return steppers[i][isa];
    return base;
}

const tvi_stepper *tvi_choose_stepper(const tvi_options *options, const tvi_system *system)
{
    const tvi_descriptor *descriptor = tvi_find_method(options);
    jet_isa isa = system->field_values->sweeps->isa;
    if (options->compose_adjoint) return &tvi_stepper_composed;
    if (options->passes == TVI_PREDICT_ONLY && descriptor->predictor) return stepper_of_set(descriptor->predictor, isa);
    const int least = descriptor->avx512_degrees.least, most = descriptor->avx512_degrees.most;
    const bool fits_avx512 = most == 0 || (least <= options->degree && options->degree <= most);
    if (isa == jet_isa_avx512 && !fits_avx512) isa = jet_isa_avx2;
    return stepper_of_set(system->constraints ? descriptor->constrained : descriptor->stepper, isa);
}

tvi_options tvi_adjoint_options(const tvi_options *options)
{
    const tvi_descriptor *adjoint = tvi_find_method(options)->adjoint;
    tvi_options adjoint_options = *options;
    adjoint_options.method = adjoint->method;
    adjoint_options.expansion = adjoint->expansion;
    adjoint_options.quadrature = tvi_quadrature_mirror(options->quadrature);
    return adjoint_options;
}

/* ---- Options of the public interface ----------------------------------------------------------------------------- */

static tvi_status refuse_order(const char *name, int least, int most, bool needs_even_order, int order)
{
    if (least == most) return jet_refuse(TVI_EINVAL, "%s has order %d, not %d", name, least, order);
    const char *const even = needs_even_order ? "even " : "";
    return jet_refuse(TVI_EINVAL, "%s has %sorders from %d to %d, not %d", name, even, least, most, order);
}

/* Sets *options to a method with this node rule and order, or refuses an order that the method does not have. */
static tvi_status set_options_of_node_rule(const tvi_descriptor *descriptor, tvi_nodes nodes, int order,
                                           tvi_options *options)
{
    const tvi_options found = {
        .method = descriptor->method, .expansion = descriptor->expansion, .nodes = nodes, .order = order};
    tvi_options resolved = found;
    if (tvi_options_resolve(&resolved, NULL, NULL) == TVI_OK) {
        *options = found;
        return TVI_OK;
    }
    const int least = compute_order(descriptor, &found, descriptor->least_degree);
    const int most = compute_order(descriptor, &found, descriptor->most_degree);
    return refuse_order(descriptor->nodes[nodes].name, least, most, has_only_even_orders(descriptor, &found), order);
}

/* Tells whether a method of the list has this name. list_name NULL stands for a method without a name. */
static bool is_same_name(const char *list_name, const char *name) { return list_name && strcmp(list_name, name) == 0; }

/* Refuses a name that no method has, with a text that lists all names. */
static tvi_status refuse_name(const char *name)
{
    tvi_status status = jet_refuse(
        TVI_EINVAL, "no method is called \"%.40s\": \"galerkin\" is the default, \"taylor\" has tolerances; all are",
        name);
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        for (int nodes = 0; nodes <= TVI_NODES_TRUNCATED; nodes++)
            if ((*d)->nodes[nodes].name)
                status = jet_refuse(status, "%s %s,", jet_last_refusal_text(), (*d)->nodes[nodes].name);
    return jet_refuse(status, "%s %s", jet_last_refusal_text(), tvi_svhd.name);
}

tvi_status tvi_options_named(const char *name, int order, tvi_options *options)
{
    if (!name || !options) return jet_refuse(TVI_EINVAL, "%s is NULL", name ? "options" : "name");
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        for (int nodes = 0; nodes <= TVI_NODES_TRUNCATED; nodes++)
            if (is_same_name((*d)->nodes[nodes].name, name))
                return set_options_of_node_rule(*d, (tvi_nodes)nodes, order, options);
    if (strcmp(name, tvi_svhd.name) != 0) return refuse_name(name);
    const int own = tvi_svhd.options.order;
    if (order != own) return refuse_order(name, own, own, true, order);
    *options = tvi_svhd.options;
    return TVI_OK;
}

tvi_options tvi_options_default(void)
{
    return (tvi_options){.method = tvi_galerkin.method, .expansion = tvi_galerkin.expansion, .order = DEFAULT_ORDER};
}
