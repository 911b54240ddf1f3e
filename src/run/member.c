/* member.c - takes the state of a member from the user, and gives it back; copies a member from one integrator to
 * another. */
#include "run/guard.h"
#include "run/integrator.h"
#include "method/single.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* The element of an array [components][width] that belongs to component i of the member. */
static double *at(const tvi_integrator *it, double *array, int i, int member)
{
    return array + (size_t)i * (size_t)it->width + (size_t)member;
}

/* All bits in which the user's components differ from those of the member. */
JET_INLINE uint64_t difference(int n, const double *given, size_t stride, const double *own, size_t width)
{
    uint64_t any = 0;
    for (int i = 0; i < n; i++, given += stride, own += width) any |= tvi_bits(*given) ^ tvi_bits(*own);
    return any;
}

bool tvi_member_has(const tvi_integrator *it, int member, const tvi_given_state *given)
{
    const int n = it->system->n;
    const size_t stride = given->stride, width = (size_t)it->width;
    const double *q = it->now.q + member, *p = it->now.p + member;
    const uint64_t time = tvi_bits(given->t) ^ tvi_bits(*at(it, it->now.q, n, member));
    if (stride == 1 && width == 1)
        return (time | difference(n, given->q, 1, q, 1) | difference(n, given->p, 1, p, 1)) == 0;
    return (time | difference(n, given->q, stride, q, width) | difference(n, given->p, stride, p, width)) == 0;
}

void tvi_member_give(const tvi_integrator *it, int member, double *t, double q[], double p[], size_t stride)
{
    const int n = it->system->n;
    for (int i = 0; i < n; i++) {
        q[(size_t)i * stride] = *at(it, it->now.q, i, member);
        p[(size_t)i * stride] = *at(it, it->now.p, i, member);
    }
    *t = *at(it, it->now.q, n, member);
}

/* ---- From one integrator to another ------------------------------------------------------------------------------ */

/* The arrays of a state, and their rows. */
enum { ARRAYS = 5 };
static void list_arrays(const tvi_integrator *it, double *array[ARRAYS], int rows[ARRAYS])
{
    const int dimension = it->stepped->n;
    const tvi_run_state *now = &it->now;
    double *const all[ARRAYS] = {now->q, now->q_low, now->p, now->p_low, it->begun};
    const int rows_of[ARRAYS] = {dimension + 1, dimension + 1, dimension, dimension, 2 * it->system->n + 1};
    memcpy(array, all, sizeof all);
    memcpy(rows, rows_of, sizeof rows_of);
}

/* As before a first step. */
static void forget(tvi_integrator *it, int member)
{
    double *array[ARRAYS];
    int rows[ARRAYS];
    if (it->width == 1) {
        tvi_arena_copy(it->history, NULL, it->remembered);
        return;
    }
    list_arrays(it, array, rows);
    for (int a = 0; a < ARRAYS; a++)
        for (int row = 0; row < rows[a]; row++) *at(it, array[a], row, member) = 0;
    it->kept[member] = (tvi_kept_energy){0};
    it->continues[member] = false;
    if (tvi_batch_of(it)->forget) tvi_batch_of(it)->forget(it->work, member);
}

void tvi_member_copy(tvi_integrator *to, int member_to, const tvi_integrator *from, int member_from)
{
    double *source[ARRAYS], *target[ARRAYS];
    int rows[ARRAYS];
    forget(to, member_to);
    list_arrays(from, source, rows);
    list_arrays(to, target, rows);
    for (int a = 0; a < ARRAYS; a++)
        for (int row = 0; row < rows[a]; row++)
            *at(to, target[a], row, member_to) = *at(from, source[a], row, member_from);
    to->kept[member_to] = from->kept[member_from];
    to->continues[member_to] = from->continues[member_from];
    const tvi_batch_stepper *batch = to->stepper->batch;
    if (from->width > 1 && batch->get) batch->get(from->work, member_from, to->work);
    if (to->width > 1 && batch->put) batch->put(to->work, member_to, from->work);
    to->has_dense = false;
}

/* ---- The start of a run ------------------------------------------------------------------------------------------ */

void tvi_member_lend_parameters(tvi_integrator *it, int member)
{
    const int count = tvi_system_parameters(it->system);
    tvi_gather(count, it->width, it->parameters, member, it->lent);
    tvi_blocks_set_parameters(it->lone, count, 1, it->lent);
}

tvi_status tvi_member_energy(tvi_integrator *it, int member, const double *q, const double *p, double *H)
{
    const int n = it->system->n;
    const tvi_run_state *alone = &it->alone;
    tvi_gather(n + 1, it->width, q, member, alone->q);
    tvi_gather(n, it->width, p, member, alone->p);
    if (it->width > 1) {
        tvi_member_lend_parameters(it, member);
        tvi_energy_forget(&it->energy);
    }
    return tvi_energy_of(&it->energy, alone->q[n], alone->q, alone->p, H);
}

/* K as it is at the member's state with another e, in long double. */
static long double transformed_with(tvi_integrator *it, double e)
{
    it->alone.p[it->system->n] = e;
    return tvi_energy_precise(&it->transformed, 0, it->alone.q, it->alone.p);
}

/* e = -H(q, p, t), where K = g (H + e) is 0 (rescaled.c). The roundoff of H at a pericentre, whose terms cancel, would
 * shift the period of the orbit: e is the root of K in long double, of which K is a linear function. */
static tvi_status set_energy(tvi_integrator *it, int member)
{
    const int n = it->system->n;
    double H;
    const tvi_status status = tvi_member_energy(it, member, it->now.q, it->now.p, &H);
    if (status != TVI_OK) return tvi_refuse_as("energy", status);
    const double apart = H != 0 ? H : 1;
    const long double there = transformed_with(it, apart - H), here = transformed_with(it, -H);
    const long double correction = apart * (here / (here - there)), e = isfinite(correction) ? correction - H : -H;
    *at(it, it->now.p, n, member) = (double)e;
    *at(it, it->now.p_low, n, member) = (double)(e - (double)e);
    return TVI_OK;
}

/* Whether the user's state is finite; else says what of it is not. */
static tvi_status check(tvi_integrator *it, const tvi_given_state *given)
{
    const int n = it->system->n;
    bool is_finite = isfinite(given->t);
    for (int i = 0; i < n; i++) {
        it->alone.q[i] = given->q[(size_t)i * given->stride];
        it->alone.p[i] = given->p[(size_t)i * given->stride];
        is_finite = is_finite && isfinite(it->alone.q[i]) && isfinite(it->alone.p[i]);
    }
    return is_finite ? TVI_OK : tvi_refuse_state(n, given->t, it->alone.q, "p", it->alone.p);
}

tvi_status tvi_member_begin(tvi_integrator *it, int member, const tvi_given_state *given)
{
    const int n = it->system->n;
    if (it->is_telling) return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not step it");
    if (it->continues[member] && tvi_member_has(it, member, given)) return TVI_OK;
    const tvi_status status = check(it, given);
    if (status != TVI_OK) return status;
    forget(it, member);
    for (int i = 0; i < n; i++) {
        *at(it, it->now.q, i, member) = *at(it, it->begun, i, member) = it->alone.q[i];
        *at(it, it->now.p, i, member) = *at(it, it->begun, n + 1 + i, member) = it->alone.p[i];
    }
    *at(it, it->now.q, n, member) = *at(it, it->begun, n, member) = given->t;
    tvi_guard_begin(it, member);
    return tvi_is_rescaled(it) ? set_energy(it, member) : TVI_OK;
}
