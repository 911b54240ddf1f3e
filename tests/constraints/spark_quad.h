/* spark_quad.h - Declares steps on constraints from their definition (docs/method.md, section 12), in quadruple
 * precision, and problems in closed form that share nothing with the library. */
#ifndef TESTS_SPARK_QUAD_H
#define TESTS_SPARK_QUAD_H

#include "references/quad.h"
#include "tvi.h"

enum { SPARK_N = 4, SPARK_M = 2, SPARK_NODES = 10 };

typedef struct {
    const char *name;
    int n, m;
    bool is_separable;                /* H = sum p_i^2 / (2 m_i) + V(q) */
    quad masses[SPARK_N];             /* of it */
    double t, q[SPARK_N], p[SPARK_N]; /* near the constraints */
    /* H_q, H_p, and where it is not separable W = H_pp [n][n]; W NULL: it is not asked for. */
    void (*slopes)(quad t, const quad q[], const quad p[], quad Hq[], quad Hp[], quad *W);
    /* phi [m], G [m][n], phi_t [m]. */
    void (*constrain)(quad t, const quad q[], quad phi[], quad *G, quad phi_t[]);
    /* The same for the library. */
    tvi_status (*make)(tvi_system **base);
    tvi_constraint_fn *phi;
} spark_problem;
extern const spark_problem spark_problems[];
extern const int spark_problem_count;

typedef struct {
    quad t, q[SPARK_N], p[SPARK_N];
} spark_state;

/* Gauss nodes c_i and weights b_i, i < count, Lobatto nodes d_0, ..., d_count; A_k(x) = int_0^x l_k / b_k. */
typedef struct {
    int count;
    quad b[SPARK_NODES], c[SPARK_NODES], d[SPARK_NODES + 1];
    /* A_k(c_i) and A_k(d_i), and 1 - A_k of both, [k][i]. */
    quad A_at_c[SPARK_NODES][SPARK_NODES], A_at_d[SPARK_NODES][SPARK_NODES + 1];
    quad mu_c[SPARK_NODES][SPARK_NODES], mu_d[SPARK_NODES][SPARK_NODES + 1];
    /* Of separable systems nu(c_i, c_l), nu(c_i, d_j), nu(d_i, c_l), and of all nu(d_i, d_j). */
    quad nu_cc[SPARK_NODES][SPARK_NODES], nu_cd[SPARK_NODES][SPARK_NODES + 1];
    quad nu_dc[SPARK_NODES + 1][SPARK_NODES], nu_dd[SPARK_NODES + 1][SPARK_NODES + 1];
} spark_method;

spark_method spark_method_of(int count);

/* The start of the problem, put onto its constraints: q along W G^T, and p along G^T. Ends the test where it fails. */
spark_state spark_start(const spark_problem *of);
void spark_project(const spark_problem *of, spark_state *x);
/* Ends the test where the passes do not come to rest. */
void spark_step(const spark_problem *of, const spark_method *method, quad h, spark_state *x);
/* The largest phi or G H_p + phi_t. */
double spark_defect(const spark_problem *of, const spark_state *x);

#endif
