/* defect.c - Computes the defect of a step of bodies that attract each other (guard.h): how far the forces on them at
 * the ends of the step are from the polynomial through the forces at its nodes. A light body has no say in the energy
 * of all, and another solution of the equations of a step is smooth, so that its tail is small; but its curve passes
 * places where the forces are others. guard.c calls it. */
#include "integrator/guard.h"
#include "algebra/sizes.h"

#include <math.h>
#include <string.h>

/* A defect counts if the force moves a body, in the step, by more than this part of its movement: a body of which
 * nothing is felt is right to that part, whatever the defect is. */
static const double LEAST_EFFECT = 1e-3;

/* Evaluates p' at q and p, arrays as in a tvi_run_state, by the variable of the steps. Returns false if it is not
 * finite. */
static bool compute_true_forces(tvi_integrator *it, const double *q, const double *p, double *force)
{
    const tvi_system *system = it->stepped;
    const double sign = system->form == TVI_SEPARABLE ? 1 : -1;
    if (!tvi_integrator_compute_field(it, q, p)) return false;
    for (int i = 0; i < system->n; i++) force[i] = sign * it->guard.field_block[system->field_values->output_slot[i]];
    return true;
}

/* The bodies of a step: their number, their axes, and the mass of each coordinate. */
typedef struct {
    int count, axes;
    const double *mass;
    double largest_mass;
    bool attract; /* each other; otherwise each is alone in a given field */
} step_bodies;

/* Returns the square of the distance of body a from body b (-1: from 0), or of the movement relative to it if q are
 * increments. */
static double squared_distance(const step_bodies *bodies, const double *q, int a, int b)
{
    double sum = 0;
    for (int k = 0; k < bodies->axes; k++) {
        const double d = q[a * bodies->axes + k] - (b < 0 ? 0 : q[b * bodies->axes + k]);
        sum += d * d;
    }
    return sum;
}

/* Tells whether two bodies attract each other: they are not one, and not both test particles (system/bodies.c). */
static bool attract(const step_bodies *bodies, int a, int b)
{
    const double larger = fmax(bodies->mass[a * bodies->axes], bodies->mass[b * bodies->axes]);
    return bodies->attract && a != b && larger > 2 * TVI_TEST_MASS * bodies->largest_mass;
}

/* Returns the body that is nearest to body a of those that attract it, or -1 if there is none. */
static int nearest_body(const step_bodies *bodies, const double *q, int a)
{
    int nearest = -1;
    double least = INFINITY;
    for (int b = 0; b < bodies->count; b++) {
        const double square = attract(bodies, a, b) ? squared_distance(bodies, q, a, b) : INFINITY;
        if (square < least) least = square, nearest = b;
    }
    return nearest;
}

/* Returns component k of the acceleration of body a relative to body b (-1: to nothing), from forces that are `stride`
 * numbers apart. A pull that both feel cancels. */
static double relative_acceleration(const step_bodies *bodies, const double *force, int stride, int a, int b, int k)
{
    const int i = a * bodies->axes + k, j = b * bodies->axes + k;
    return force[i * stride] / bodies->mass[i] - (b < 0 ? 0 : force[j * stride] / bodies->mass[j]);
}

/* Returns the defect of body a relative to its nearest neighbour, at the start (end = 0) or the end (end = 1) of the
 * step: the difference of the true acceleration from the curve's, relative to the largest in the step. *effect becomes
 * this largest one. */
static double defect_of_body(const step_bodies *bodies, const double *curve, int points, const double *at_end, int end,
                             int a, int b, double *effect)
{
    double difference = 0, largest = 0;
    for (int k = 0; k < bodies->axes; k++) {
        const double d = relative_acceleration(bodies, at_end, 1, a, b, k) -
                         relative_acceleration(bodies, curve + end, TVI_FORCE_POINTS, a, b, k);
        difference += d * d;
    }
    for (int point = 1; point < points; point++) { /* the end itself in the place of point 1, then the nodes */
        double square = 0;
        for (int k = 0; k < bodies->axes; k++) {
            const double x = point == 1 ? relative_acceleration(bodies, at_end, 1, a, b, k)
                                        : relative_acceleration(bodies, curve + point, TVI_FORCE_POINTS, a, b, k);
            square += x * x;
        }
        largest = fmax(largest, square);
    }
    *effect = sqrt(largest);
    return tvi_ratio_or_zero(sqrt(difference), *effect);
}

double tvi_defect_of_bodies(tvi_integrator *it)
{
    if (!it->guard.curve_forces) return 0;
    const tvi_system *system = it->system;
    const int axes = system->axes < 0 ? -system->axes : system->axes;
    const step_bodies bodies = {system->n / axes, axes, system->mass, tvi_largest_magnitude(system->n, system->mass, 1),
                                system->axes > 0};
    double *at_end = it->guard.curve_forces + it->stepped->n * TVI_FORCE_POINTS, largest = 0;
    const int points = it->stepper->compute_curve_forces(it->work, it->guard.curve_forces);
    const double *const p[] = {it->state.p, it->guard.end.p}, *const q[] = {it->state.q, it->guard.end.q};
    const double h_times_dt = fabs(it->last_step.h * it->last_step.increments.dq[system->n]);
    tvi_set_step_end(it);
    for (int end = 0; end < 2; end++) {
        if (!compute_true_forces(it, q[end], p[end], at_end)) return INFINITY;
        for (int a = 0; a < bodies.count; a++) {
            double effect;
            const int b = nearest_body(&bodies, q[end], a);
            const double defect = defect_of_body(&bodies, it->guard.curve_forces, points, at_end, end, a, b, &effect);
            const double movement = sqrt(squared_distance(&bodies, it->last_step.increments.dq, a, b));
            if (h_times_dt * effect > LEAST_EFFECT * movement) largest = fmax(largest, defect);
        }
    }
    return largest;
}
