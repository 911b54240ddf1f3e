/* defect.c - checks that a step of "taylor" to a tolerance solves the equations of motion: the defect of its curve, by
 * how much the curve misses the equations, is compared with the tolerance at three places inside the step and at its
 * end (W. H. Enright, A new error-control for initial value solvers, Applied Mathematics and Computation 31 (1989)),
 * and so is the change of the energy, if the system conserves one. The coefficients at the start do not show a force
 * that the body meets only within the step. taylor.c calls it for each step.
 *
 * The scaled time s goes from 0 to 1 in the step, and x' is the derivative of x by s. The factor kappa scales momenta:
 * it is h/m in a separable system, whose force is F, and 1 in all others. With u = kappa p the defects are
 *     separable      h kappa F - u',                    relative to the largest u,
 *     Hamiltonian    h H_p - q'  and  -h H_q - p',      relative to the largest q and p,
 *     Lagrangian     L_v - p  and  h L_q - p',          relative to the largest p.
 * An error of q and p of the size that the tolerance allows changes the energy by at most
 *     tolerance * sum_i (p_largest |q_i'| + q_largest |p_i'|) / h. */
#include "generating/step.h"
#include "sums.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The places are s = 1/4, 1/2, 3/4 and the end: four lanes, which are one vector or two. */
enum { PLACES = TVI_DEFECT_PLACES, SAMPLES = TVI_ROUNDOFF_SAMPLES };

void tvi_defect_allocate(tvi_defect *defect, tvi_arena *arena, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const size_t orders = (size_t)curve->highest_order + 1;
    tvi_arena_allocate_each(arena, orders * PLACES,
                            (double **[]){&defect->power, &defect->slope, &defect->second, NULL});
    defect->field = tvi_arena_allocate_block(arena, system->field_values, 1, PLACES, 0);
    tvi_roundoff_allocate(&defect->roundoff, arena, system);
    if (!system->energy.tape || system->uses_time || system->is_driven) return;
    defect->energy = tvi_arena_allocate_block(arena, system->energy.tape, 1, 2, 0);
    defect->energy_at_point = tvi_arena_allocate_block(arena, system->energy.tape, 1, 1, 0);
    defect->energy_roundoff = tvi_arena_allocate_doubles(arena, (size_t)system->energy.tape->slot_count * SAMPLES);
}

void tvi_defect_set_tables(const tvi_defect *defect, const tvi_curve *curve)
{
    for (int place = 0; place < PLACES; place++) {
        const double s = (place + 1.0) / PLACES;
        double power = 1;
        for (int k = 0; k <= curve->highest_order; k++, power *= s) {
            defect->power[k * PLACES + place] = power;
            defect->slope[k * PLACES + place] = k * power / s;
            defect->second[k * PLACES + place] = k * (k - 1) * power / (s * s);
        }
    }
}

/* Returns the coefficients of the series of the scaled momentum u_i, which are a stride apart, in a system that is not
 * separable. A separable system has no such series: u is q' there, and its defect is computed from q''. */
static const double *locate_series_of_u(const tvi_curve *curve, int i)
{
    const int n = curve->n;
    return curve_Q(curve, 0) +
           (curve->system->form == TVI_LAGRANGIAN ? curve->system->field_series->output_slot[n + i] : n + i);
}

/* Computes the sum of a series at the places, with the weights of a table. */
static void sum_at_places(const tvi_curve *curve, int degree, const double *series, const double *table, double row[])
{
    jet_combine_rows(degree + 1, series, curve_stride(curve), PLACES, table, row);
}

/* Evaluates the field on the curve at the places. Returns false if it has no value. */
static bool evaluate_field(const tvi_defect *defect, const tvi_curve *curve, double h, const tvi_step_origin *origin)
{
    const tvi_system *system = curve->system;
    const int n = curve->n;
    double t[PLACES], *second = defect->field + n * PLACES;
    for (int i = 0; i < n; i++) {
        const double *Q = curve_Q(curve, 0) + i;
        sum_at_places(curve, curve->q_degree, Q, defect->power, defect->field + i * PLACES);
        if (system->form == TVI_HAMILTONIAN)
            sum_at_places(curve, curve->p_degree, locate_series_of_u(curve, i), defect->power, second + i * PLACES);
        if (system->form != TVI_LAGRANGIAN) continue;
        sum_at_places(curve, curve->q_degree, Q, defect->slope, second + i * PLACES);
        for (int place = 0; place < PLACES; place++) second[i * PLACES + place] /= h;
    }
    for (int place = 0; place < PLACES; place++) t[place] = origin->t + (place + 1.0) / PLACES * h;
    tvi_system_write_time(system, defect->field, PLACES, t);
    return system->field_values->sweeps->values(system->field_values, defect->field, PLACES);
}

/* What the defects are compared with. */
typedef struct {
    tvi_defect *defect;
    const tvi_curve *curve;
    double h, tolerance;
    double largest_q, largest_u; /* the largest |q_i| and |u_i|, with their movements in the step */
    bool is_roundoff_known;
} comparison;

/* Tells whether the row of the curve is `factor` times this output of the field, to the tolerance times `size` or to
 * the roundoff of the field. */
static bool is_row_met(comparison *with, int output, double factor, double size, const double row[])
{
    const tvi_system *system = with->curve->system;
    const double *field = with->defect->field + system->field_values->output_slot[output] * PLACES;
    const jet_v4 difference = factor * *(const jet_v4 *)field - *(const jet_v4 *)row, d = JET_ABS(jet_v4, difference);
    const JET_MASK(jet_v4) is_met = d <= with->tolerance * size; /* not met by NaN */
    if (is_met[0] & is_met[1] & is_met[2] & is_met[3]) return true;
    const double largest = fmax(fmax(d[0], d[1]), fmax(d[2], d[3]));
    if (!isfinite(d[0] + d[1] + d[2] + d[3])) return false;
    if (!with->is_roundoff_known)
        (void)tvi_roundoff_estimate_field(&with->defect->roundoff, system, with->defect->field, PLACES, PLACES);
    with->is_roundoff_known = true;
    return largest <=
           with->tolerance * size + ROUNDOFF_MAX_UNITS * fabs(factor) * with->defect->roundoff.output_roundoff[output];
}

static bool is_field_met(comparison *with)
{
    const tvi_curve *curve = with->curve;
    const tvi_defect *defect = with->defect;
    const double h = with->h;
    const int n = curve->n;
    double row[PLACES];
    for (int i = 0; i < n; i++) {
        const double *Q = curve_Q(curve, 0) + i,
                     *u = curve->system->form == TVI_SEPARABLE ? NULL : locate_series_of_u(curve, i);
        switch (curve->system->form) {
        case TVI_SEPARABLE:
            sum_at_places(curve, curve->q_degree, Q, defect->second, row);
            if (!is_row_met(with, i, h * curve->kappa[i], with->largest_u, row)) return false;
            break;
        case TVI_HAMILTONIAN:
        case TVI_FIELD:
            sum_at_places(curve, curve->q_degree, Q, defect->slope, row);
            if (!is_row_met(with, n + i, h, with->largest_q, row)) return false;
            sum_at_places(curve, curve->p_degree, u, defect->slope, row);
            if (!is_row_met(with, i, -h, with->largest_u, row)) return false;
            break;
        case TVI_LAGRANGIAN:
            sum_at_places(curve, curve->p_degree, u, defect->power, row);
            if (!is_row_met(with, n + i, 1, with->largest_u, row)) return false;
            sum_at_places(curve, curve->p_degree, u, defect->slope, row);
            if (!is_row_met(with, i, h, with->largest_u, row)) return false;
            break;
        }
    }
    return true;
}

/* ---- The energy -------------------------------------------------------------------------------------------------- */

/* Sets the inputs of the energy tape at the start and at the end of the step. Returns the change of the energy over the
 * step less that of the tape's output: that of the kinetic energy of a separable system, of p.v of a Lagrangian. */
static double set_energy_inputs(const comparison *with, const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_curve *curve = with->curve;
    const tvi_form form = curve->system->form;
    const int n = curve->n;
    const double one_over_h = 1 / with->h;
    double *q = with->defect->energy, *second = q + 2 * n, change = 0;
    for (int i = 0; i < n; i++) {
        const double p = origin->p[i], dp = increments->dp[i];
        q[2 * i] = origin->q[i];
        q[2 * i + 1] = origin->q[i] + increments->dq[i];
        if (form == TVI_HAMILTONIAN) second[2 * i] = p, second[2 * i + 1] = p + dp;
        if (form == TVI_SEPARABLE) change += curve->kappa[i] * one_over_h * dp * (p + dp / 2); /* 1/m is kappa / h */
        if (form != TVI_LAGRANGIAN) continue;
        second[2 * i] = curve_Q(curve, 1)[i] / with->h;
        second[2 * i + 1] = with->defect->field[(n + i) * PLACES + PLACES - 1];
        change += (p + dp) * second[2 * i + 1] - p * second[2 * i];
    }
    return change;
}

/* Returns the roundoff of the energy tape's output at the two ends. */
static double energy_roundoff(const tvi_defect *defect, const tvi_system *system)
{
    const jet_tape *tape = system->energy.tape;
    double sum = 0;
    for (int end = 0; end < 2; end++) {
        for (int i = 0; i < tape->input_count; i++) defect->energy_at_point[i] = defect->energy[2 * i + end];
        if (!jet_sweep_values(tape, defect->energy_at_point, 1)) return INFINITY;
        tvi_roundoff_sweep_tape(tape, tape->input_count, NULL, defect->energy_at_point, defect->energy_roundoff);
        sum += tvi_largest_magnitude(SAMPLES, defect->energy_roundoff + tape->output_slot[0] * SAMPLES, 1);
    }
    return sum;
}

static bool is_energy_kept(const comparison *with, const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_curve *curve = with->curve;
    const tvi_system *system = curve->system;
    const jet_tape *tape = system->energy.tape;
    if (!with->defect->energy) return true;
    const double change = set_energy_inputs(with, origin, increments);
    if (!tape->sweeps->values(tape, with->defect->energy, 2)) return false;
    const double *output = with->defect->energy + 2 * tape->output_slot[0],
                 sign = system->form == TVI_LAGRANGIAN  ? -1
                        : system->form == TVI_SEPARABLE ? system->energy.sign
                                                        : 1,
                 all = change + sign * (output[1] - output[0]);
    const double one_over_h = 1 / with->h;
    double allowed = 0, terms = 0;
    for (int i = 0; i < curve->n; i++) {
        const double one_over_kappa = system->form == TVI_SEPARABLE ? system->mass[i] * one_over_h : 1;
        allowed += fabs(one_over_kappa) * (with->largest_u * curve->sizes.dq[i] + with->largest_q * curve->sizes.u[i]);
        terms += fabs(increments->dq[i] * origin->p[i]);
    }
    allowed *= with->tolerance / fabs(with->h);
    terms = fabs(change) + terms / fabs(with->h);
    if (fabs(all) <= allowed) return true;
    allowed += TVI_LEAST_SIZE; /* of which all digits are lost to underflow */
    return fabs(all) <= allowed + ROUNDOFF_MAX_UNITS * (energy_roundoff(with->defect, system) + DBL_EPSILON * terms);
}

bool tvi_defect_is_small(tvi_curve_work *w, double h, const tvi_increments *increments)
{
    const tvi_curve *curve = &w->c.curve;
    const tvi_step_origin *origin = w->step.origin;
    comparison with = {.defect = &w->adapted.defect, .curve = curve, .h = h, .tolerance = w->adapted.tolerance};
    with.largest_q = with.largest_u = TVI_LEAST_SIZE;
    for (int i = 0; i < curve->n; i++) {
        const double u = fabs(origin->p[i]) + fabs(increments->dp[i]);
        with.largest_q = tvi_larger(fabs(origin->q[i]) + fabs(increments->dq[i]), with.largest_q);
        with.largest_u = tvi_larger(fabs(curve->kappa[i]) * u, with.largest_u);
    }
    return evaluate_field(&w->adapted.defect, curve, h, origin) && is_field_met(&with) &&
           is_energy_kept(&with, origin, increments);
}
