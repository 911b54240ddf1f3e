/* compiled.c - a system as machine code, where there is a compiler: made once, kept for the next time.
 *   cc compiled.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Henon and Heiles. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet x = q[0], y = q[1];
    jet square = jet_mul(0.5, jet_dot(q, q, 2));
    return jet_add(square, jet_mul(y, jet_sub(jet_sqr(x), jet_div(jet_sqr(y), 3))));
}

/* 2000 units of time; returns the largest change of a coordinate from what is given. */
static double run(const tvi_system *system, const tvi_options *options, double end[2])
{
    double t = 0, q[] = {0.1, 0.2}, p[] = {0.3, 0.1}, change = 0;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, options));
    TVI_OR_EXIT(tvi_integrate(integrator, 0.5, 4000, &t, q, p, NULL, NULL));
    for (int i = 0; i < 2; i++) change = fmax(change, fabs(q[i] - end[i]));
    end[0] = q[0], end[1] = q[1];
    tvi_integrator_free(integrator);
    return change;
}

int main(void)
{
    double end[2] = {0};
    tvi_options options = tvi_options_default();
    tvi_compiled *code = NULL;
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    run(system, &options, end);
    if (tvi_compile(&code, system, &options, NULL) != TVI_OK) /* interpreted, then */
        fprintf(stderr, "%s\n", tvi_last_error());
    options.compiled = code;
    const double change = run(system, &options, end);
    printf("q = (%.6f, %.6f), compiled: another by %.0e\n", end[0], end[1], change);
    tvi_compiled_free(code);
    tvi_system_free(system);
    return 0;
}
