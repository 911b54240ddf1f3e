/* refuse.c - Sets texts of tvi_last_error for refusals that several functions share (refuse.h). */
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

tvi_status tvi_refuse_first_null_pointer(int count, const void *const pointer[], const char *const name[])
{
    int i = 0;
    while (i < count - 1 && pointer[i]) i++;
    return jet_refuse(TVI_EINVAL, "%s is NULL", name[i]);
}

tvi_status tvi_refuse_invalid_run_arguments(tvi_run_arguments arguments, const char *other_reason)
{
    const void *const pointer[] = {arguments.integrator, arguments.t, arguments.q, arguments.p};
    static const char *const name[] = {"integrator", "t", "q", "p"};
    for (int i = 0; i < 4; i++)
        if (!pointer[i]) return tvi_refuse_first_null_pointer(4, pointer, name);
    if (arguments.h == 0) return jet_refuse(TVI_EINVAL, "h is 0");
    if (!isfinite(arguments.h)) return jet_refuse(TVI_EINVAL, "h = %g is not finite", arguments.h);
    return jet_refuse(TVI_EINVAL, "%s", other_reason);
}

tvi_status tvi_refuse_nonfinite_state(int n, double t, const double q[], const char *vector_name, const double vector[])
{
    if (!isfinite(t)) return jet_refuse(TVI_ENONFINITE, "t = %g is not finite", t);
    for (int i = 0; i < n; i++) {
        if (!isfinite(q[i])) return jet_refuse(TVI_ENONFINITE, "q[%d] = %g is not finite", i, q[i]);
        if (!isfinite(vector[i]))
            return jet_refuse(TVI_ENONFINITE, "%s[%d] = %g is not finite", vector_name, i, vector[i]);
    }
    return TVI_OK;
}

tvi_status tvi_refuse_masses(int n, const double mass[])
{
    if (!mass) return TVI_OK;
    for (int i = 0; i < n; i++) {
        if (!isfinite(mass[i])) return jet_refuse(TVI_ENONFINITE, "mass[%d] = %g is not finite", i, mass[i]);
        if (mass[i] <= 0) return jet_refuse(TVI_EINVAL, "mass[%d] = %g is not positive", i, mass[i]);
    }
    return TVI_OK;
}

tvi_status tvi_refuse_failed_evaluation(const char *evaluated_quantity, tvi_status status)
{
    if (status == TVI_OK) return status;
    return jet_refuse(status, "%s: %s", evaluated_quantity,
                      status == TVI_EDOMAIN ? jet_last_refusal_text() : tvi_status_string(status));
}

/* ---- Components beyond the end of a vector ----------------------------------------------------------------------- */

void tvi_set_poison_beyond_end(int n, jet x[], jet_reason reason)
{
    const int count = (int)tvi_padded_vector_count(n);
    for (int i = n; i < count; i++) x[i] = jet_make_poison_beyond_end(reason, i);
}

jet *tvi_copy_with_poison_beyond_end(int n, const jet x[], jet_reason reason)
{
    jet *copy = malloc(tvi_padded_vector_count(n) * sizeof *copy);
    if (!copy) return NULL;
    memcpy(copy, x, (size_t)n * sizeof *copy);
    tvi_set_poison_beyond_end(n, copy, reason);
    return copy;
}

jet *tvi_create_unset_outputs(int n)
{
    const size_t count = tvi_padded_vector_count(n);
    jet *output = malloc(count * sizeof *output);
    for (size_t i = 0; i < count && output; i++) output[i] = jet_make_unset_poison();
    return output;
}

tvi_status tvi_refuse_outputs_beyond_end(const char *name, int n, const jet output[])
{
    const int count = (int)tvi_padded_vector_count(n);
    const jet unset = jet_make_unset_poison();
    for (int i = n; i < count; i++)
        if (output[i].node != unset.node)
            return jet_refuse(TVI_EINVAL, "%s[%d] was set: it is beyond the last component, %s[%d]", name, i, name,
                              n - 1);
    return TVI_OK;
}
