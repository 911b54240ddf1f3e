/* hand.h - States the problems of the comparison by hand, M q'' = F - G^T lambda, for methods whose text is compiled
 * once for each of them. */
#ifndef CONSTRAINTS_HAND_H
#define CONSTRAINTS_HAND_H

#include "baselines/baseline.h"
#include "work.h"

#include <math.h>
#include <string.h>

/* g are the numbers that G is made of, W = M^-1. S = G1 W G0^T is stored as its band, S[k][l - k + band]; beyond it S
 * has zeros. */
typedef struct {
    int n, m, band, numbers;                          /* of g */
    double unit;                                      /* phi has roundoff of this */
    void (*accelerate)(const double q[], double a[]); /* W F */
    void (*evaluate)(const double q[], double phi[], double g[]);
    void (*set_S)(const double g1[], const double g0[], double S[]);
    void (*apply_WGT)(const double g[], const double mu[], double out[]);
    void (*apply_G)(const double g[], const double x[], double out[]);
    void (*bend)(const double v[], double out[]); /* v phi_qq v */
} hand;

/* ---- Chains, of masses of 1 -------------------------------------------------------------------------------------- */

/* g has the links, x_j - x_(j-1); phi_j = (|link j|^2 - l^2) / 2. */
static INLINE void chain_set_links(int links, const double q[], double g[])
{
    for (int i = 0; i < 2; i++) g[i] = q[i];
    for (int i = 2; i < 2 * links; i++) g[i] = q[i] - q[i - 2];
}

static INLINE void chain_evaluate(int links, double length, const double q[], double phi[], double g[])
{
    chain_set_links(links, q, g);
    for (int j = 0; j < links; j++)
        phi[j] = 0.5 * (g[2 * j] * g[2 * j] + g[2 * j + 1] * g[2 * j + 1] - length * length);
}

static INLINE double dot_2(const double x[], const double y[]) { return x[0] * y[0] + x[1] * y[1]; }

static INLINE void chain_set_S(int links, const double g1[], const double g0[], double S[])
{
    const int band = links > 1, width = 2 * band + 1;
    for (int j = 0; j < links; j++) {
        S[j * width + band] = (j ? 2 : 1) * dot_2(g1 + 2 * j, g0 + 2 * j);
        if (j) S[j * width + band - 1] = -dot_2(g1 + 2 * j, g0 + 2 * j - 2);
        if (j + 1 < links) S[j * width + band + 1] = -dot_2(g1 + 2 * j, g0 + 2 * j + 2);
    }
}

static INLINE void chain_apply_WGT(int links, const double g[], const double mu[], double out[])
{
    for (int i = 0; i < 2 * links; i++) out[i] = mu[i / 2] * g[i] - (i / 2 + 1 < links ? mu[i / 2 + 1] * g[i + 2] : 0);
}

static INLINE void chain_apply_G(int links, const double g[], const double x[], double out[])
{
    double of_links[2 * LINKS_MOST];
    chain_set_links(links, x, of_links);
    for (int j = 0; j < links; j++) out[j] = dot_2(g + 2 * j, of_links + 2 * j);
}

static INLINE void chain_bend(int links, const double v[], double out[])
{
    double of_links[2 * LINKS_MOST];
    chain_set_links(links, v, of_links);
    for (int j = 0; j < links; j++) out[j] = dot_2(of_links + 2 * j, of_links + 2 * j);
}

static INLINE void chain_accelerate(int links, const double q[], double a[])
{
    (void)q;
    for (int i = 0; i < 2 * links; i++) a[i] = i % 2 ? -WORK_GRAVITY : 0;
}

#define CHAIN_BY_HAND(name, links, length)                                                                             \
    static INLINE void name##_accelerate(const double q[], double a[]) { chain_accelerate(links, q, a); }              \
    static INLINE void name##_evaluate(const double q[], double phi[], double g[])                                     \
    {                                                                                                                  \
        chain_evaluate(links, length, q, phi, g);                                                                      \
    }                                                                                                                  \
    static INLINE void name##_set_S(const double g1[], const double g0[], double S[])                                  \
    {                                                                                                                  \
        chain_set_S(links, g1, g0, S);                                                                                 \
    }                                                                                                                  \
    static INLINE void name##_apply_WGT(const double g[], const double mu[], double out[])                             \
    {                                                                                                                  \
        chain_apply_WGT(links, g, mu, out);                                                                            \
    }                                                                                                                  \
    static INLINE void name##_apply_G(const double g[], const double x[], double out[])                                \
    {                                                                                                                  \
        chain_apply_G(links, g, x, out);                                                                               \
    }                                                                                                                  \
    static INLINE void name##_bend(const double v[], double out[]) { chain_bend(links, v, out); }                      \
    static const hand name = {2 * links,         links,           links > 1,    2 * links,        (length) * (length), \
                              name##_accelerate, name##_evaluate, name##_set_S, name##_apply_WGT, name##_apply_G,      \
                              name##_bend};

CHAIN_BY_HAND(hand_pendulum, 1, 1.0)
CHAIN_BY_HAND(hand_double, 2, 1.0)
CHAIN_BY_HAND(hand_chain, LINKS_MOST, 1.0 / LINKS_MOST)

/* ---- The top, by its three directors about the fixed point ------------------------------------------------------- */

/* g = q. phi: (d_k.d_k - 1) / 2 for k = 0, 1, 2, then d_i.d_j for each pair of PAIR. */
static const double top_W[] = TOP_INVERSE_MASSES;
static const int top_pair[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

static INLINE double dot_3(const double x[], const double y[]) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

static INLINE void top_accelerate(const double q[], double a[])
{
    (void)q;
    memset(a, 0, 9 * sizeof *a);
    a[8] = -TOP_WEIGHT * top_W[2];
}

static INLINE void top_evaluate(const double q[], double phi[], double g[])
{
    memcpy(g, q, 9 * sizeof *g);
    for (int k = 0; k < 3; k++) phi[k] = 0.5 * (dot_3(q + 3 * k, q + 3 * k) - 1);
    for (int k = 3; k < 6; k++) phi[k] = dot_3(q + 3 * top_pair[k][0], q + 3 * top_pair[k][1]);
}

/* Row (i, j) of G has d_j at body part i and, if it is a pair, d_i at part j. */
static INLINE void top_set_S(const double g1[], const double g0[], double S[])
{
    double products[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) products[i][j] = dot_3(g1 + 3 * i, g0 + 3 * j);
    for (int r = 0; r < 6; r++)
        for (int s = 0; s < 6; s++) {
            double sum = 0;
            for (int a = 0; a < (r < 3 ? 1 : 2); a++)
                for (int b = 0; b < (s < 3 ? 1 : 2); b++)
                    if (top_pair[r][a] == top_pair[s][b])
                        sum += top_W[top_pair[r][a]] * products[top_pair[r][1 - a]][top_pair[s][1 - b]];
            S[r * 11 + s - r + 5] = sum;
        }
}

static INLINE void top_apply_WGT(const double g[], const double mu[], double out[])
{
    static const int number[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int i = 0; i < 3; i++)
        for (int x = 0; x < 3; x++) {
            double sum = 0;
            for (int j = 0; j < 3; j++) sum += mu[number[i][j]] * g[3 * j + x];
            out[3 * i + x] = top_W[i] * sum;
        }
}

static INLINE void top_apply_G(const double g[], const double x[], double out[])
{
    for (int k = 0; k < 3; k++) out[k] = dot_3(g + 3 * k, x + 3 * k);
    for (int k = 3; k < 6; k++) {
        const int i = top_pair[k][0], j = top_pair[k][1];
        out[k] = dot_3(g + 3 * i, x + 3 * j) + dot_3(g + 3 * j, x + 3 * i);
    }
}

static INLINE void top_bend(const double v[], double out[])
{
    for (int k = 0; k < 3; k++) out[k] = dot_3(v + 3 * k, v + 3 * k);
    for (int k = 3; k < 6; k++) out[k] = 2 * dot_3(v + 3 * top_pair[k][0], v + 3 * top_pair[k][1]);
}

static const hand hand_top = {9,           6,       5, 9, 1.0, top_accelerate, top_evaluate, top_set_S, top_apply_WGT,
                              top_apply_G, top_bend};

/* ---- Water, of longrun/constrained.c ----------------------------------------------------------------------------- */

/* g has the bonds O H, O H, H H; phi is (|bond|^2 - length^2) / 2. */
static const int water_bond[][2] = {{0, 1}, {0, 2}, {1, 2}};
static const double water_length[] = {1, 1, 1.5817}, water_W[] = {1.0 / 16, 1, 1}, water_charge[] = {-3, 1.5, 1.5};

static INLINE void water_accelerate(const double q[], double a[])
{
    for (int atom = 0; atom < 3; atom++) {
        const double s = 1 / sqrt(1 + dot_3(q + 3 * atom, q + 3 * atom));
        const double factor = water_W[atom] * (water_charge[atom] * s * s * s - (atom ? 0 : 0.125));
        for (int i = 0; i < 3; i++) a[3 * atom + i] = factor * q[3 * atom + i];
    }
}

static INLINE void water_set_bonds(const double q[], double g[])
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) g[3 * k + i] = q[3 * water_bond[k][1] + i] - q[3 * water_bond[k][0] + i];
}

static INLINE void water_evaluate(const double q[], double phi[], double g[])
{
    water_set_bonds(q, g);
    for (int k = 0; k < 3; k++) phi[k] = 0.5 * (dot_3(g + 3 * k, g + 3 * k) - water_length[k] * water_length[k]);
}

static INLINE void water_set_S(const double g1[], const double g0[], double S[])
{
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) {
            double sum = 0;
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++)
                    if (water_bond[k][a] == water_bond[l][b]) sum += (a == b ? 1 : -1) * water_W[water_bond[k][a]];
            S[k * 5 + l - k + 2] = sum * dot_3(g1 + 3 * k, g0 + 3 * l);
        }
}

static INLINE void water_apply_WGT(const double g[], const double mu[], double out[])
{
    memset(out, 0, 9 * sizeof *out);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            out[3 * water_bond[k][0] + i] -= water_W[water_bond[k][0]] * mu[k] * g[3 * k + i];
            out[3 * water_bond[k][1] + i] += water_W[water_bond[k][1]] * mu[k] * g[3 * k + i];
        }
}

static INLINE void water_apply_G(const double g[], const double x[], double out[])
{
    double of_bonds[9];
    water_set_bonds(x, of_bonds);
    for (int k = 0; k < 3; k++) out[k] = dot_3(g + 3 * k, of_bonds + 3 * k);
}

static INLINE void water_bend(const double v[], double out[])
{
    double of_bonds[9];
    water_set_bonds(v, of_bonds);
    for (int k = 0; k < 3; k++) out[k] = dot_3(of_bonds + 3 * k, of_bonds + 3 * k);
}

static const hand hand_water = {
    9, 3, 2, 9, 1.0, water_accelerate, water_evaluate, water_set_S, water_apply_WGT, water_apply_G, water_bend};

/* ---- Factors of S ------------------------------------------------------------------------------------------------ */

enum { MU_MOST = LINKS_MOST, S_MOST = 11 * 10 };

/* S = L U in place. S is nearly symmetric and positive, and needs no pivots. The diagonal becomes its reciprocal. */
static INLINE void hand_factor(const hand *p, double S[])
{
    const int band = p->band, width = 2 * band + 1;
    for (int k = 0; k < p->m; k++) {
        S[k * width + band] = 1 / S[k * width + band];
        for (int i = k + 1; i <= k + band && i < p->m; i++) {
            const double factor = S[i * width + k - i + band] *= S[k * width + band];
            for (int j = k + 1; j <= k + band && j < p->m; j++)
                S[i * width + j - i + band] -= factor * S[k * width + j - k + band];
        }
    }
}

static INLINE void hand_solve(const hand *p, const double S[], double x[])
{
    const int band = p->band, width = 2 * band + 1;
    for (int k = 0; k < p->m; k++)
        for (int j = k > band ? k - band : 0; j < k; j++) x[k] -= S[k * width + j - k + band] * x[j];
    for (int k = p->m - 1; k >= 0; k--) {
        for (int j = k + 1; j <= k + band && j < p->m; j++) x[k] -= S[k * width + j - k + band] * x[j];
        x[k] *= S[k * width + band];
    }
}

#endif
