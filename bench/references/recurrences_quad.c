/* recurrences_quad.c - Implements recurrences_quad.h. */
#include "recurrences_quad.h"

#include <quadmath.h>

quad quad_product(const quad *a, const quad *b, int k)
{
    quad sum = 0;
    for (int j = 0; j <= k; j++) sum += a[j] * b[k - j];
    return sum;
}

quad quad_quotient(const quad *a, const quad *b, const quad *z, int k)
{
    quad sum = a[k];
    for (int j = 0; j < k; j++) sum -= z[j] * b[k - j];
    return sum / b[0];
}

quad quad_root(const quad *a, const quad *z, int k)
{
    if (k == 0) return sqrtq(a[0]);
    quad sum = a[k];
    for (int j = 1; j < k; j++) sum -= z[j] * z[k - j];
    return sum / (2 * z[0]);
}

quad quad_chain(const quad *a, const quad *w, int k)
{
    quad sum = 0;
    for (int j = 1; j <= k; j++) sum += j * a[j] * w[k - j];
    return sum / k;
}

quad quad_inverse_chain(const quad *a, const quad *w, const quad *z, int k)
{
    quad sum = k * a[k];
    for (int j = 1; j < k; j++) sum -= j * z[j] * w[k - j];
    return sum / (k * w[0]);
}

bool quad_solve(int n, quad *A, quad x[])
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabsq(A[i * n + k]) > fabsq(A[pivot * n + k])) pivot = i;
        if (!(fabsq(A[pivot * n + k]) > 0)) return false;
        for (int j = 0; j < n; j++) {
            const quad kept = A[k * n + j];
            A[k * n + j] = A[pivot * n + j], A[pivot * n + j] = kept;
        }
        const quad kept = x[k];
        x[k] = x[pivot], x[pivot] = kept;
        for (int i = k + 1; i < n; i++) {
            const quad factor = A[i * n + k] / A[k * n + k];
            for (int j = k; j < n; j++) A[i * n + j] -= factor * A[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) x[i] -= A[i * n + j] * x[j];
        x[i] /= A[i * n + i];
    }
    return true;
}
