/* choose.c - selects the compiled variants of solvers, quick steps, seeds and rescaled curves that fit the instruction
 * set of a system's tapes. curve_stepper.c calls it when an integrator is made; action.c and step_size.c call it in
 * steps. */
#include "algebra/linear_small.h"
#include "generating/curve_stepper.h"
#include "method/method.h"

static const tvi_closure_solver *const by_products[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_solver_by_products_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_solver_by_products_avx2,
    [jet_isa_avx512] = &tvi_solver_by_products_avx512,
#endif
};

/* The indices of quick_steps: a step of one member, of several members, and of several members by the plain Taylor
 * method. */
enum { ONE_MEMBER, SEVERAL_MEMBERS, PLAIN_TAYLOR, QUICK_STEPS };
static tvi_quick_step_fn *const quick_steps[JET_ISA_COUNT][QUICK_STEPS] = {
    [jet_isa_base] = {tvi_quick_step_single_base, tvi_quick_step_batch_base, tvi_taylor_step_batch_base},
#ifdef JET_ISA_X86
    [jet_isa_avx2] = {tvi_quick_step_single_avx2, tvi_quick_step_batch_avx2, tvi_taylor_step_batch_avx2},
    [jet_isa_avx512] = {tvi_quick_step_single_avx512, tvi_quick_step_batch_avx512, tvi_taylor_step_batch_avx512},
#endif
};

static tvi_seeds_fn *const seeds_from_field[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_seeds_from_field_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_seeds_from_field_avx2,
    [jet_isa_avx512] = tvi_seeds_from_field_avx512,
#endif
};

static tvi_rescale_and_sum_fn *const rescale_and_sum[JET_ISA_COUNT] = {
    [jet_isa_base] = tvi_rescale_and_sum_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = tvi_rescale_and_sum_avx2,
    [jet_isa_avx512] = tvi_rescale_and_sum_avx512,
#endif
};

tvi_seeds_fn *tvi_choose_seeds_function(const tvi_action *action) { return seeds_from_field[action->sweeps->isa]; }

tvi_rescale_and_sum_fn *tvi_choose_rescale_and_sum(const tvi_system *system)
{
    return rescale_and_sum[system->field_series->sweeps->isa];
}

const tvi_closure_solver *tvi_choose_product_solver(const tvi_system *system)
{
    return by_products[system->field_series->sweeps->isa];
}

tvi_quick_step_fn *tvi_choose_taylor_batch_step(const tvi_system *system)
{
    return quick_steps[system->field_series->sweeps->isa][PLAIN_TAYLOR];
}

bool tvi_has_quick_step(const tvi_system *system, const tvi_options *options)
{
    const tvi_action action = tvi_get_action_sizes(system, options);
    return tvi_find_method(options)->curve.correct_ends == tvi_correct_ends_by_mean &&
           options->passes != TVI_PREDICT_ONLY && seeds_need_only_field(&action) && 2 * system->n <= LINEAR_SMALL &&
           tvi_curve_choose_jacobian_method(system) == TVI_JACOBIAN_MATRICES;
}

tvi_quick_step_fn *tvi_choose_quick_step(const tvi_closure *closure, const tvi_options *options)
{
    if (!tvi_has_quick_step(closure->system, options)) return NULL;
    if (closure->curve.generated_code) return closure->curve.generated_code->step;
    return quick_steps[closure->system->field_series->sweeps->isa]
                      [closure->curve.width > 1 ? SEVERAL_MEMBERS : ONE_MEMBER];
}
