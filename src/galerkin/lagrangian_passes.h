/* lagrangian_passes.h - Makes the passes of a Lagrangian's Galerkin curve (lagrangian.c). The library runs them with
 * the loops of its tables, and generated code with its own, where all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H
#define TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The work of the passes. The rows of nodes->x, n each, are Q, P, V, F, and L_v after F. */
typedef struct {
    const galerkin_loops *loops;
    const galerkin_nodes *nodes;
    galerkin_nodes rates; /* V and F as unknowns that begin at 0 */
    const double *matrix; /* of a movement */
    const int *slot;
    galerkin_blocks blocks;
    const int *output[2];  /* [2n] slots of the gradient */
    double *displacements; /* [n][lanes] Q less the nodes' high */
    /* [n][lanes] The nodes' high less the points where the gradient was evaluated, in two parts. */
    double *rise[2];
    double *gradient;   /* [2n][lanes] as evaluated */
    lanes_model model;  /* of the gradient */
    lanes_inverse mass; /* of L_vv */
    int factors;        /* number of inversions */
    /* Movement of the last pass, as `move` measures it; infinite before the first one of a step. */
    double moved;
} lagrangian_passes;

typedef enum { LAGRANGIAN_PASSED, LAGRANGIAN_OUTSIDE, LAGRANGIAN_NO_NUMBER, LAGRANGIAN_SINGULAR } lagrangian_passed;

/* The iterations of a pass. More would save less than they cost, as measured. After a single one F would not follow V,
 * and the energy would drift by the error that the pass before has left in V. */
enum { LAGRANGIAN_ITERATIONS = 3, LAGRANGIAN_LEAST_ITERATIONS = 2 };
/* The square of a relative movement after which second derivatives serve again. */
#define LAGRANGIAN_SERVES 1e-8
/* The square of a relative movement that is roundoff: no other one follows from it. */
#define LAGRANGIAN_NOTHING (0.25 * DBL_EPSILON * DBL_EPSILON)

static inline double *lagrangian_row(const galerkin_nodes *nodes, int i) { return nodes->x + i * nodes->lanes; }

static inline galerkin_nodes lagrangian_half(const galerkin_nodes *given, int first)
{
    galerkin_nodes nodes = *given;
    const int offset = first * nodes.lanes;
    nodes.unknowns /= 2;
    nodes.moving = nodes.unknowns;
    nodes.x += offset;
    nodes.high += offset;
    nodes.base += offset;
    nodes.impulse += offset;
    nodes.start += first;
    nodes.scale += first;
    nodes.inverse_size += first;
    return nodes;
}

static inline double lagrangian_move_momenta(const lagrangian_passes *w)
{
    const int n = w->nodes->unknowns / 2;
    const galerkin_nodes momenta = lagrangian_half(w->nodes, n);
    double moved;
    GALERKIN_LOOP(w->loops, move, &momenta, w->matrix, w->nodes->x, w->slot + n, &moved);
    return moved;
}

static inline double lagrangian_move_positions(const lagrangian_passes *w)
{
    const galerkin_nodes positions = lagrangian_half(w->nodes, 0);
    return GALERKIN_LOOP(w->loops, move_in_parts, &positions, w->matrix, w->nodes->x, w->slot, w->displacements);
}

/* Sets the unknowns by the V and F that are there. */
static inline void lagrangian_place(lagrangian_passes *w)
{
    (void)lagrangian_move_momenta(w);
    (void)lagrangian_move_positions(w);
    w->moved = INFINITY;
}

static inline void lagrangian_predict(lagrangian_passes *w, const galerkin_extrapolation *by)
{
    galerkin_predict_rates(w->loops, &w->rates, by);
    lagrangian_place(w);
}

/* Rounds the points where the gradient is evaluated by their last bits. The last passes of a step then use the same
 * points, with the gradient to first order from there. At the nodes themselves the roundoff of the gradient would
 * change with their last bits. The nodes would rest where that roundoff happens to be small, first on the side that
 * they come from, and the energy would drift. */
enum { LAGRANGIAN_LAST_BITS = 6 };
static inline void lagrangian_set_places(int count, const double *nodes, double *places)
{
    const uint64_t unit = UINT64_C(1) << LAGRANGIAN_LAST_BITS;
    for (int i = 0; i < count; i++) {
        const uint64_t bits = (tvi_double_bits(nodes[i]) + unit / 2) & ~(unit - 1);
        memcpy(&places[i], &bits, sizeof bits);
    }
}

static inline bool lagrangian_evaluate(lagrangian_passes *w, galerkin_sweep *sweep, bool with_hessian)
{
    const galerkin_nodes *nodes = w->nodes;
    const int lanes = nodes->lanes, half = nodes->unknowns / 2 * lanes, *output = w->output[with_hessian];
    lagrangian_set_places(half, nodes->x, w->blocks.values);
    lagrangian_set_places(half, lagrangian_row(nodes, nodes->unknowns), w->blocks.values + half);
    const double *x = galerkin_sweep_there(&w->blocks, sweep, with_hessian);
    if (!x) return false;
    for (int i = 0; i < nodes->unknowns; i++)
        memcpy(w->gradient + i * lanes, x + output[i] * lanes, (size_t)lanes * sizeof *x);
    return true;
}

/* Inverts L_vv from the block of second derivatives. */
static inline lagrangian_passed lagrangian_invert(lagrangian_passes *w)
{
    const lanes_model *model = &w->model;
    const int n = model->n, lanes = model->lanes;
    double *a = w->mass.lu;
    memset(a, 0, (size_t)(n * n * lanes) * sizeof *a);
    for (int i = n; i < 2 * n; i++)
        for (int k = model->end[i - 1]; k < model->end[i]; k++) {
            const lanes_term *term = &model->term[k];
            double *element = a + ((i - n) * n + term->column - n) * lanes;
            if (term->column >= n) memcpy(element, w->blocks.hessian + term->slot * lanes, (size_t)lanes * sizeof *a);
        }
    w->factors++;
    if (GALERKIN_LOOP(w->loops, invert, &w->mass) > n * DBL_EPSILON) return LAGRANGIAN_PASSED;
    for (int k = model->end[n - 1]; k < model->end[2 * n - 1]; k++)
        if (!tvi_all_finite(lanes, w->blocks.hessian + model->term[k].slot * lanes)) return LAGRANGIAN_NO_NUMBER;
    return LAGRANGIAN_SINGULAR;
}

/* Moves the unknowns by the current gradient. */
static inline double lagrangian_iterate(lagrangian_passes *w)
{
    const galerkin_nodes *nodes = w->nodes;
    const int n = nodes->unknowns / 2, half = n * nodes->lanes;
    const double moved = lagrangian_move_momenta(w);
    GALERKIN_LOOP(w->loops, correct, &w->mass, lagrangian_row(nodes, n), w->gradient + half,
                  lagrangian_row(nodes, 4 * n), w->blocks.values + half, lagrangian_row(nodes, 2 * n));
    return moved + lagrangian_move_positions(w);
}

/* Sets `rise` to the nodes' high less the points where the gradient was evaluated. */
static inline void lagrangian_set_rise(lagrangian_passes *w)
{
    const int half = w->nodes->unknowns / 2 * w->nodes->lanes;
    const double *high = w->nodes->high, *from = w->blocks.values;
    for (int i = 0; i < half; i++) {
        const double rise = high[i] - from[i], less = high[i] - rise;
        w->rise[0][i] = rise;
        w->rise[1][i] = (high[i] - (rise + less)) + (less - from[i]);
    }
}

/* Computes the gradient to first order at Q and V, which have moved from the points where it was evaluated. The
 * movement of Q is known before it is rounded. */
static inline void lagrangian_linearise(lagrangian_passes *w)
{
    const galerkin_nodes *nodes = w->nodes;
    const int half = nodes->unknowns / 2 * nodes->lanes;
    const double *V = nodes->x + 2 * half, *from = w->blocks.values;
    double *moved = w->model.moved;
    for (int i = 0; i < half; i++) moved[i] = (w->rise[0][i] + w->displacements[i]) + w->rise[1][i];
    for (int i = 0; i < half; i++) moved[half + i] = V[i] - from[half + i];
    GALERKIN_LOOP(w->loops, linearise, &w->model, nodes->x + 3 * half);
}

/* Makes a pass. It evaluates new second derivatives if the last ones do not serve. */
static inline lagrangian_passed lagrangian_pass(lagrangian_passes *w, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = w->nodes;
    const int numbers = nodes->unknowns * nodes->lanes;
    if (w->moved <= LAGRANGIAN_SERVES * numbers) {
        if (!lagrangian_evaluate(w, sweep, false)) return LAGRANGIAN_OUTSIDE;
    } else {
        if (!lagrangian_evaluate(w, sweep, true)) return LAGRANGIAN_OUTSIDE;
        const lagrangian_passed inverted = lagrangian_invert(w);
        if (inverted != LAGRANGIAN_PASSED) return inverted;
    }
    double moved = w->moved = 0;
    lagrangian_set_rise(w);
    for (int i = 0; i < LAGRANGIAN_ITERATIONS; i++) {
        if (i >= LAGRANGIAN_LEAST_ITERATIONS && moved <= LAGRANGIAN_NOTHING * numbers) break;
        lagrangian_linearise(w);
        w->moved += moved = lagrangian_iterate(w);
    }
    return LAGRANGIAN_PASSED;
}

#endif
