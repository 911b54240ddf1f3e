/* halves.c - see halves.h. */
#include "galerkin/halves.h"

/* K_ij, or mu_ij - 1/2. */
static double symmetric_part(const galerkin_coefficients *of, bool is_second_order, int i, int j)
{
    return of->matrix[j * of->lanes + i] - (is_second_order ? (of->c[i] - of->c[j]) / 2 : 0.5);
}

void tvi_galerkin_halves_prepare(galerkin_halves *halves, const galerkin_coefficients *of, bool is_second_order)
{
    const int m = of->points, pairs = (m + 1) / 2;
    *halves = (galerkin_halves){.is_crossed = !is_second_order};
    for (int j = 0; j < pairs; j++) {
        const double late = (of->c[j] - 0.5) / 2;
        halves->shift[j] = is_second_order ? -late : 0.5;
        halves->slope[j] = is_second_order ? late : 0;
        for (int i = 0; i < pairs; i++) {
            const double here = symmetric_part(of, is_second_order, i, j) / 2,
                         there = symmetric_part(of, is_second_order, i, m - 1 - j) / 2;
            halves->even[j * MOST_PAIRS + i] = is_second_order ? here + there : here - there;
            halves->odd[j * MOST_PAIRS + i] = is_second_order ? here - there : here + there;
        }
    }
}
