/* record.h - Declares helpers that record a function, run it, compare its series.
 *
 * Series of several quantities and lanes are stored as x[(quantity * (degree + 1) + k) * lanes + lane]. */
#ifndef TVI_TESTS_AD_RECORD_H
#define TVI_TESTS_AD_RECORD_H

#include "functions.h"
#include "graph.h"
#include "tape.h"

/* A closed graph and its tape. */
typedef struct {
    jet_graph *graph;
    jet_tape *tape;
    int inputs, outputs;
} recording;

/* The outputs of f. */
recording record_outputs(const function *f, jet_tape_kind kind);
/* The gradient of output `output` of f. */
recording record_gradient(const function *f, int output, jet_tape_kind kind);
/* The gradient of component i of that gradient. */
recording record_second_gradient(const function *f, int output, int i, jet_tape_kind kind);
/* The lift of the outputs of f, or of the gradient of its last one: value, then rate. The inputs of f and their
 * directions come in reverse, the last input of f first. */
recording record_lift(const function *f, bool of_gradient, jet_tape_kind kind);
/* Accepts the outputs of an open graph, closes and lowers it. */
recording record_close(jet_graph *graph, int outputs, jet output[], jet_tape_kind kind);
void recording_free(recording *r);

/* count numbers, zero; the caller frees them. */
double *numbers(size_t count);

/* Outputs z from inputs x; false where an operation is outside its domain. All slots that a sweep has to set hold NaN
 * beforehand, so that what is read before it is set shows. */
bool run_values(const recording *r, int lanes, const double x[], double z[]);
/* The size that roundoff of the outputs is relative to: of a sum the sizes of its terms together, else of the
 * output. */
void run_sizes(const recording *r, int lanes, const double x[], double size[]);
bool run_series(const recording *r, int degree, int lanes, const double x[], double z[]);
/* Tangents dz (several lanes) along the series x (one lane); orders of x above k hold NaN while order k is swept. */
void run_tangents(const recording *r, int degree, int lanes_of_x, int lanes, const double x[], const double dx[],
                  double dz[]);

/* Adjoints of the inputs, xbar, from those of the outputs, zbar, along the series x: sum zbar dz = sum xbar dx. */
void run_adjoints(const recording *r, int degree, const double x[], const double zbar[], double xbar[]);

/* The size by which roundoff in coefficient k is judged: max over i <= 2 of sqrt |z_{k-i} z_{k+i}|, which an isolated
 * small coefficient does not lower; for the last coefficient also z_{k-1}^2 / |z_{k-2}|, at most |z_{k-1}|. */
double natural_scale(int degree, const double z[], int k);

/* The largest error of a coefficient relative to the natural scale of `scale`; NaN and infinity count as infinite. */
double series_error(int degree, const double got[], const double want[], const double scale[]);

/* Lane `lane` of `count` series of degree + 1 coefficients in `lanes` lanes. */
void get_lane(int count, int degree, int lanes, int lane, const double all[], double one[]);
void set_lane(int count, int degree, int lanes, int lane, const double one[], double all[]);

/* Asserts that the error is within the bound. */
void check_series(const char *what, int degree, const double got[], const double want[], double bound);

/* How many operations of a kind a tape has. */
int operations_of(const jet_tape *tape, jet_op op);

#endif
