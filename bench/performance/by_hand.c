/* by_hand.c - Computes the series by hand, compiled once for each instruction set (by_hand.h). */
#include "by_hand.h"

static void kepler(int N, double tau, const power_weights *weights, kepler_series *c)
{
    for (int k = 0; k + 2 <= N; k++) {
        double a[2];
        kepler_acceleration(k, weights, c, a);
        const double scale = tau * tau / ((k + 1) * (k + 2));
        c->x[k + 2] = scale * a[0], c->y[k + 2] = scale * a[1];
    }
}

static void solar(int N, double tau, const power_weights *weights, solar_series *c)
{
    for (int k = 0; k + 2 <= N; k++) {
        double a[18];
        solar_acceleration(k, weights, c, a);
        const double scale = tau * tau / ((k + 1) * (k + 2));
        for (int i = 0; i < 18; i++) c->q[k + 2][i] = scale * a[i];
    }
}

const by_hand series_by_hand = {kepler, solar};
