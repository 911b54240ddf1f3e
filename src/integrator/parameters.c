/* parameters.c - Sets the values that an integrator uses for the parameters of its system, and computes energies,
 * momenta, velocities and what belongs to constraints with these values. */
#include "integrator/integrator.h"
#include "system/refuse.h"

#include <math.h>
#include <string.h>

static tvi_status refuse_null_integrator(void) { return jet_refuse(TVI_EINVAL, "integrator is NULL"); }

void tvi_integrator_apply_parameters(tvi_integrator *it)
{
    tvi_blocks_set_parameters(it->blocks, tvi_system_parameters(it->system), it->parameters);
}

void tvi_integrator_load_parameters(tvi_integrator *it, const double value[], size_t stride)
{
    bool is_same = true;
    for (int i = 0; i < tvi_system_parameters(it->system); i++) {
        is_same = is_same && it->parameters[i] == value[(size_t)i * stride];
        it->parameters[i] = value[(size_t)i * stride];
    }
    if (!is_same) tvi_integrator_apply_parameters(it);
}

tvi_status tvi_integrator_set_parameters(tvi_integrator *it, const double value[])
{
    if (!it || !value)
        return tvi_refuse_first_null_pointer(2, (const void *const[]){it, value},
                                             (const char *const[]){"integrator", "value"});
    const int count = tvi_system_parameters(it->system);
    for (int i = 0; i < count; i++)
        if (!isfinite(value[i])) return jet_refuse(TVI_ENONFINITE, "value[%d] is not finite", i);
    if (count == 0) return TVI_OK;
    memmove(it->parameters, value, (size_t)count * sizeof *value);
    tvi_integrator_apply_parameters(it);
    tvi_integrator_reset(it);
    it->last_step.has_curve = false;
    tvi_event_stop_clear(it->stop, it->system->n); /* The events at the last stop had other parameters. */
    it->parameter_version++;
    return TVI_OK;
}

tvi_status tvi_integrator_energy(const tvi_integrator *it, double t, const double q[], const double p[], double *H)
{
    return it ? tvi_energy_with_parameters(it->system, it->parameters, t, q, p, H) : refuse_null_integrator();
}

tvi_status tvi_integrator_momentum(const tvi_integrator *it, double t, const double q[], const double v[], double p[])
{
    return it ? tvi_apply_legendre_transform(it->system, it->parameters, t, q, v, p, true) : refuse_null_integrator();
}

tvi_status tvi_integrator_velocity(const tvi_integrator *it, double t, const double q[], const double p[], double v[])
{
    return it ? tvi_apply_legendre_transform(it->system, it->parameters, t, q, p, v, false) : refuse_null_integrator();
}

tvi_status tvi_integrator_project(const tvi_integrator *it, double t, double q[], double p[])
{
    return it ? tvi_project_with_parameters(it->system, it->parameters, t, q, p) : refuse_null_integrator();
}

tvi_status tvi_integrator_constraint_values(const tvi_integrator *it, double t, const double q[], const double p[],
                                            double value[], double rate[])
{
    return it ? tvi_phi_with_parameters(it->system, it->parameters, t, q, p, value, rate) : refuse_null_integrator();
}

tvi_status tvi_integrator_multipliers(const tvi_integrator *it, double t, const double q[], const double p[],
                                      double lambda[], double force[])
{
    return it ? tvi_multipliers_with_parameters(it->system, it->parameters, t, q, p, lambda, force)
              : refuse_null_integrator();
}
