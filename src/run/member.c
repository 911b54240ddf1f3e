/* member.c - Copies the state of one member from the user's arrays to an integrator and back, copies members from one
 * integrator to another, and computes the energy of a member (integrator.h). */
#include "run/integrator.h"
#include "method/single.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* Returns the address of component i of one member in an array [components][width]. */
static double *element_of_member(const tvi_integrator *it, double *array, int i, int member)
{
    return array + (size_t)i * (size_t)it->width + (size_t)member;
}

/* Returns a number whose bits are 1 where the user's components differ from those of the member; 0 means that all are
 * equal. */
JET_INLINE uint64_t find_differing_bits(int component_count, const double *user_state, size_t stride,
                                        const double *member_state, size_t width)
{
    uint64_t any = 0;
    for (int i = 0; i < component_count; i++, user_state += stride, member_state += width)
        any |= tvi_double_bits(*user_state) ^ tvi_double_bits(*member_state);
    return any;
}

bool tvi_member_state_equals(const tvi_integrator *it, int member, const tvi_user_state *user_state)
{
    const int n = it->system->n;
    const size_t stride = user_state->stride, width = (size_t)it->width;
    const double *q = it->state.q + member, *p = it->state.p + member;
    const uint64_t time =
        tvi_double_bits(user_state->t) ^ tvi_double_bits(*element_of_member(it, it->state.q, n, member));
    if (stride == 1 && width == 1)
        return (time | find_differing_bits(n, user_state->q, 1, q, 1) |
                find_differing_bits(n, user_state->p, 1, p, 1)) == 0;
    return (time | find_differing_bits(n, user_state->q, stride, q, width) |
            find_differing_bits(n, user_state->p, stride, p, width)) == 0;
}

void tvi_member_copy_state(const tvi_integrator *it, int member, double *t, double q[], double p[], size_t stride)
{
    const int n = it->system->n;
    for (int i = 0; i < n; i++) {
        q[(size_t)i * stride] = *element_of_member(it, it->state.q, i, member);
        p[(size_t)i * stride] = *element_of_member(it, it->state.p, i, member);
    }
    *t = *element_of_member(it, it->state.q, n, member);
}

/* ---- From one integrator to another ------------------------------------------------------------------------------ */

/* The number of arrays that list_state_arrays lists. */
enum { ARRAYS = 5 };
/* Lists the arrays of an integrator's states, and the number of components of each. */
static void list_state_arrays(const tvi_integrator *it, double *arrays[ARRAYS], int component_counts[ARRAYS])
{
    const int dimension = it->stepped->n;
    const tvi_run_state *state = &it->state;
    double *const all[ARRAYS] = {state->q, state->q_low, state->p, state->p_low, it->run_start};
    const int counts[ARRAYS] = {dimension + 1, dimension + 1, dimension, dimension, 2 * it->system->n + 1};
    memcpy(arrays, all, sizeof all);
    memcpy(component_counts, counts, sizeof counts);
}

/* Clears the state and the history of one member, as before its first step. */
static void clear_member_history(tvi_integrator *it, int member)
{
    double *arrays[ARRAYS];
    int component_counts[ARRAYS];
    if (it->width == 1) {
        tvi_arena_copy_or_clear_with_sanitizer_gaps(it->history, NULL, it->history_bytes);
        return;
    }
    list_state_arrays(it, arrays, component_counts);
    for (int a = 0; a < ARRAYS; a++)
        for (int i = 0; i < component_counts[a]; i++) *element_of_member(it, arrays[a], i, member) = 0;
    it->reference_energy[member] = (tvi_reference_energy){0};
    it->is_state_from_step[member] = false;
    if (tvi_batch_stepper_of(it)->clear_history) tvi_batch_stepper_of(it)->clear_history(it->work, member);
}

void tvi_member_copy_between_integrators(tvi_integrator *to, int member_to, const tvi_integrator *from, int member_from)
{
    double *source[ARRAYS], *target[ARRAYS];
    int component_counts[ARRAYS];
    clear_member_history(to, member_to);
    list_state_arrays(from, source, component_counts);
    list_state_arrays(to, target, component_counts);
    for (int a = 0; a < ARRAYS; a++)
        for (int i = 0; i < component_counts[a]; i++)
            *element_of_member(to, target[a], i, member_to) = *element_of_member(from, source[a], i, member_from);
    to->reference_energy[member_to] = from->reference_energy[member_from];
    to->is_state_from_step[member_to] = from->is_state_from_step[member_from];
    const tvi_batch_stepper *batch = to->stepper->batch;
    if (from->width > 1 && batch->copy_history_from_lane)
        batch->copy_history_from_lane(from->work, member_from, to->work);
    if (to->width > 1 && batch->copy_history_to_lane) batch->copy_history_to_lane(to->work, member_to, from->work);
    to->has_dense_output = false;
}

/* ---- The start of a run ------------------------------------------------------------------------------------------ */

void tvi_member_copy_parameters_to_one_lane_blocks(tvi_integrator *it, int member)
{
    const int count = tvi_system_parameters(it->system);
    tvi_gather_member(count, it->width, it->parameters, member, it->one_lane_parameters);
    tvi_blocks_set_parameters(it->one_lane_blocks, count, 1, it->one_lane_parameters);
}

tvi_status tvi_member_compute_energy(tvi_integrator *it, int member, const double *q, const double *p, double *H)
{
    const int n = it->system->n;
    const tvi_run_state *alone = &it->member_state;
    tvi_gather_member(n + 1, it->width, q, member, alone->q);
    tvi_gather_member(n, it->width, p, member, alone->p);
    if (it->width > 1) tvi_member_copy_parameters_to_one_lane_blocks(it, member);
    return tvi_energy_compute(&it->member_energy_work, alone->q[n], alone->q, alone->p, H);
}

/* Computes the Hamiltonian K = g (H + e) of a rescaled system at the member's state, with the given e, in long
 * double. */
static long double compute_rescaled_hamiltonian(tvi_integrator *it, double e)
{
    it->member_state.p[it->system->n] = e;
    return tvi_energy_compute_long_double(&it->rescaled_hamiltonian_work, 0, it->member_state.q, it->member_state.p);
}

/* Sets e = -H(q, p, t) at the start of a run of a rescaled system, so that K = g (H + e) is 0 (docs/method.md,
 * system/rescaled.c). Near a pericentre the terms of H nearly cancel, and their roundoff would change the period of the
 * orbit. Therefore e is computed as the root of K in long double; K is a linear function of e. */
static tvi_status set_energy_offset_e(tvi_integrator *it, int member)
{
    const int n = it->system->n;
    double H;
    const tvi_status status = tvi_member_compute_energy(it, member, it->state.q, it->state.p, &H);
    if (status != TVI_OK) return tvi_refuse_failed_evaluation("energy", status);
    const double apart = H != 0 ? H : 1;
    const long double there = compute_rescaled_hamiltonian(it, apart - H), here = compute_rescaled_hamiltonian(it, -H);
    const long double correction = apart * (here / (here - there)), e = isfinite(correction) ? correction - H : -H;
    *element_of_member(it, it->state.p, n, member) = (double)e;
    *element_of_member(it, it->state.p_low, n, member) = (double)(e - (double)e);
    return TVI_OK;
}

/* Refuses a state of the user that has a component which is not finite. The error text names the component. */
static tvi_status refuse_state_not_finite(tvi_integrator *it, const tvi_user_state *user_state)
{
    const int n = it->system->n;
    bool is_finite = isfinite(user_state->t);
    for (int i = 0; i < n; i++) {
        it->member_state.q[i] = user_state->q[(size_t)i * user_state->stride];
        it->member_state.p[i] = user_state->p[(size_t)i * user_state->stride];
        is_finite = is_finite && isfinite(it->member_state.q[i]) && isfinite(it->member_state.p[i]);
    }
    return is_finite ? TVI_OK
                     : tvi_refuse_nonfinite_state(n, user_state->t, it->member_state.q, "p", it->member_state.p);
}

tvi_status tvi_member_begin_step(tvi_integrator *it, int member, const tvi_user_state *user_state)
{
    const int n = it->system->n;
    if (it->is_in_observer) return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not step it");
    if (it->is_state_from_step[member] && tvi_member_state_equals(it, member, user_state)) return TVI_OK;
    const tvi_status status = refuse_state_not_finite(it, user_state);
    if (status != TVI_OK) return status;
    clear_member_history(it, member);
    for (int i = 0; i < n; i++) {
        *element_of_member(it, it->state.q, i, member) = *element_of_member(it, it->run_start, i, member) =
            it->member_state.q[i];
        *element_of_member(it, it->state.p, i, member) = *element_of_member(it, it->run_start, n + 1 + i, member) =
            it->member_state.p[i];
    }
    *element_of_member(it, it->state.q, n, member) = *element_of_member(it, it->run_start, n, member) = user_state->t;
    return tvi_is_rescaled(it) ? set_energy_offset_e(it, member) : TVI_OK;
}
