/* linear_small.h - factor and solve of systems so small that a call of LAPACK costs more than its arithmetic: what
 * dgetf2 and dgetrs do, on the same data. Matrices are column-major, pivots count from 1. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_SMALL_H
#define TVI_SRC_ALGEBRA_LINEAR_SMALL_H

#include "vector.h"

#include <math.h>

/* The n up to which whole steps are faster with this: 1.2 to 1.5 times on pendulum, Kepler, Henon-Heiles and double
 * pendulum, 1.2 times on FPU, whose matrices have 12 rows, than with the reference LAPACK. Few curves have larger ones:
 * products.c. */
enum { LINEAR_SMALL = 16 };

/* call(n) with n known to the compiler where it can be. */
#define LINEAR_BY_SIZE(n, call)                                                                                        \
    switch (n) {                                                                                                       \
    case 1: call(1); break;                                                                                            \
    case 2: call(2); break;                                                                                            \
    case 4: call(4); break;                                                                                            \
    default: call(n);                                                                                                  \
    }

JET_INLINE void linear_swap(double *x, double *y)
{
    const double kept = *x;
    *x = *y;
    *y = kept;
}

/* Column j of what follows. */
JET_INLINE void linear_small_eliminate(int n, int j, double a[], int pivot[])
{
    int largest = j;
    for (int i = j + 1; i < n; i++)
        if (fabs(a[i + j * n]) > fabs(a[largest + j * n])) largest = i;
    pivot[j] = largest + 1;
    if (a[largest + j * n] == 0) return;
    for (int k = 0; largest != j && k < n; k++) linear_swap(&a[j + k * n], &a[largest + k * n]);
    const double inverse = 1 / a[j + j * n];
    for (int i = j + 1; i < n; i++) a[i + j * n] *= inverse;
    for (int k = j + 1; k < n; k++)
        for (int i = j + 1; i < n; i++) a[i + k * n] -= a[i + j * n] * a[j + k * n];
}

/* P L U in place of a, partial pivoting; a pivot that is 0 is left so. No loop over the first columns, so that all
 * places are known with a small n. */
JET_INLINE void linear_small_factor(int n, double a[], int pivot[])
{
    if (n > 0) linear_small_eliminate(n, 0, a, pivot);
    if (n > 1) linear_small_eliminate(n, 1, a, pivot);
    if (n > 2) linear_small_eliminate(n, 2, a, pivot);
    if (n > 3) linear_small_eliminate(n, 3, a, pivot);
    for (int j = 4; j < n; j++) linear_small_eliminate(n, j, a, pivot);
}

/* x <- A^-1 x. */
JET_INLINE void linear_small_solve(int n, const double lu[], const int pivot[], double x[])
{
    for (int i = 0; i < n; i++) linear_swap(&x[i], &x[pivot[i] - 1]);
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) x[i] -= lu[i + j * n] * x[j];
    for (int j = n - 1; j >= 0; j--) {
        x[j] /= lu[j + j * n];
        for (int i = 0; i < j; i++) x[i] -= lu[i + j * n] * x[j];
    }
}

/* x <- A^-T x. */
JET_INLINE void linear_small_solve_transposed(int n, const double lu[], const int pivot[], double x[])
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) x[i] -= lu[j + i * n] * x[j];
        x[i] /= lu[i + i * n];
    }
    for (int i = n - 1; i >= 0; i--)
        for (int j = i + 1; j < n; j++) x[i] -= lu[j + i * n] * x[j];
    for (int i = n - 1; i >= 0; i--) linear_swap(&x[i], &x[pivot[i] - 1]);
}

#endif
