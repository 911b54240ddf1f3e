/* fast_math.cpp - Passes numbers that are not finite from a program that is compiled with -ffast-math, as C and as C++:
 * they are refused, and what the program has stays as it was. */
#include "tvi_bodies.h"

#ifdef __cplusplus
#include "tvi.hpp"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void expect(const char *what, int row, int number, int holds)
{
    if (holds) return;
    failures++;
    printf("failed: %s %d, number %d\n", what, row, number);
}

/* The compiler does not know these. */
enum { NUMBERS = 3, ELEMENTS = sizeof(tvi_orbit) / sizeof(double) };
static double number(int which)
{
    static const char *const texts[NUMBERS] = {"nan", "inf", "-inf"};
    return strtod(texts[which], NULL);
}

static int is_refusal(tvi_status status) { return status == TVI_ENONFINITE || status == TVI_EINVAL; }

static const double SEVEN[] = {7, 7, 7, 7, 7, 7};

static void expect_refused_orbit(int element, int which, double values[], double mu)
{
    double state[6];
    tvi_orbit orbit;
    memcpy(&orbit, values, sizeof orbit);
    memcpy(state, SEVEN, sizeof state);
    expect("status of element", element, which, is_refusal(tvi_orbit_state(&orbit, mu, state, state + 3)));
    expect("state of element", element, which, !memcmp(state, SEVEN, sizeof state));
}

/* Each element, and mu, on an ellipse, a parabola and a hyperbola. Only the a of a parabola may be infinite. */
static void elements(void)
{
    for (int e = 0; e < 3; e++)
        for (int which = 0; which < NUMBERS; which++) {
            double good[ELEMENTS] = {0};
            good[1] = 1, good[2] = e == 0 ? 0.5 : e, good[6] = 1;
            expect_refused_orbit(-1, which, good, number(which));
            for (int element = 0; element < ELEMENTS; element++) {
                double values[ELEMENTS];
                memcpy(values, good, sizeof values);
                values[element] = number(which);
                if (element > 0 || which == 0 || e != 1) expect_refused_orbit(element, which, values, 1);
            }
        }
}

static void states(void)
{
    tvi_orbit orbit, before;
    memset(&before, 0x5a, sizeof before);
    for (int which = 0; which < NUMBERS; which++)
        for (int k = 0; k < 7; k++) {
            double numbers[7] = {1, 0.5, 0.25, 0, 0.75, 1, 1};
            numbers[k] = number(which);
            orbit = before;
            expect("status of state", k, which, is_refusal(tvi_orbit_of(numbers[6], numbers, numbers + 3, &orbit)));
            expect("elements of state", k, which, !memcmp(&orbit, &before, sizeof before));
        }
}

/* The mass of each body, and each number that bodies have. */
static void bodies(void)
{
    for (int which = 0; which < NUMBERS; which++)
        for (int k = 0; k < 10; k++) {
            double mass[2] = {1, 0.5};
            tvi_bodies b;
            memset(&b, 0, sizeof b);
            b.bodies = 2, b.axes = 3, b.mass = mass, b.J2 = 0.001, b.radius = 0.5;
            double *const numbers[] = {mass,      mass + 1, &b.G,       &b.softening, &b.J2,
                                       &b.radius, b.pole,   b.pole + 1, b.pole + 2,   &b.sharpness};
            *numbers[k] = number(which);
            tvi_system *system = NULL;
            expect("status of bodies", k, which, is_refusal(tvi_bodies_system(&system, &b)));
            expect("system of bodies", k, which, !system);
            tvi_system_free(system);
#ifdef __cplusplus
            try {
                const tvi::gravity made(b);
                expect("tvi::gravity", k, which, 0);
            } catch (const tvi::error &error) {
                expect("tvi::error", k, which, is_refusal(error.status()) && error.what()[0]);
            }
#endif
        }
}

/* Elements and states go there and back to 1e-12. */
static void there_and_back(void)
{
    for (int k = 0; k < 40; k++) {
        tvi_orbit orbit, found;
        double x[3], v[3];
        memset(&orbit, 0, sizeof orbit);
        orbit.q = 1, orbit.e = k / 20.0, orbit.i = 0.3, orbit.node = 0.5, orbit.pericentre = 1, orbit.time = 0.4;
        const int is_made = tvi_orbit_state(&orbit, 1.5, x, v) == TVI_OK && tvi_orbit_of(1.5, x, v, &found) == TVI_OK;
        expect("there and back", k, 0, is_made);
        if (is_made) {
            double far = fabs(found.q - 1) + fabs(found.e - orbit.e) + fabs(found.i - 0.3) + fabs(found.node - 0.5);
            if (k > 0) far += fabs(found.pericentre - 1) + fabs(found.time - 0.4);
            expect("distance", k, 0, far < 1e-12);
            double y[3], w[3];
            const int is_again = tvi_orbit_state(&found, 1.5, y, w) == TVI_OK;
            far = fabs(y[0] - x[0]) + fabs(y[1] - x[1]) + fabs(w[0] - v[0]) + fabs(w[2] - v[2]);
            expect("again", k, 0, is_again && far < 1e-12);
        }
    }
}

int main(void)
{
    elements();
    states();
    bodies();
    there_and_back();
    return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
