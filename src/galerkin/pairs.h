/* pairs.h - the sums over the nodes that a step ends with, of two unknowns at a time (loops.c). They are compensated by
 * two-sums: what an addition loses is added up by itself, and what the sum of both loses is its second part. */
#ifndef TVI_SRC_GALERKIN_PAIRS_H
#define TVI_SRC_GALERKIN_PAIRS_H

#include "galerkin/lanes.h"

/* Of u, u, v, v: once and twice in turns, as galerkin_sums has them, and last and reach, last with its sign. */
typedef struct {
    jet_v4 of_pair, low, last, reach;
} pair_sums;

/* *total += *term; *lost += what that loses. */
#define ADD_TWO_SUM(V)                                                                                                 \
    JET_INLINE void add_two_sum_of_##V(V *total, V *lost, const V *term)                                               \
    {                                                                                                                  \
        const V next = *total + *term, added = next - *total;                                                          \
        *lost += (*total - (next - added)) + (*term - added);                                                          \
        *total = next;                                                                                                 \
    }
ADD_TWO_SUM(jet_v4)

/* Nodes in turns make two chains, which do not wait for each other. */
JET_INLINE void sum_in_chains(const galerkin_weights *weights, const double *u, const double *v, int lanes,
                              pair_sums *sums)
{
    jet_v4 total[2] = {{0}}, lost[2] = {{0}}, last[2] = {{0}};
    for (int j = 0; j < lanes; j++) {
        const jet_v4 of_node = {u[j], u[j], v[j], v[j]};
        const jet_v4 term = *(const jet_v4 *)(weights->pair + j * OF_PAIR) * of_node;
        last[j % 2] += weights->last[j] * of_node;
        if (j < 2) total[j] = term;
        else add_two_sum_of_jet_v4(&total[j % 2], &lost[j % 2], &term);
    }
    add_two_sum_of_jet_v4(&total[0], &lost[0], &total[1]);
    lost[0] += lost[1];
    sums->of_pair = total[0] + lost[0];
    sums->low = lost[0] - (sums->of_pair - total[0]);
    sums->last = last[0] + last[1];
}

#ifdef JET_WIDE
ADD_TWO_SUM(jet_v8)

/* Of two vectors side by side the numbers at even places, and at odd ones; and those of the other pair of each half. */
#define EVEN_OF(x) JET_SHUFFLE_8(x[0], x[1], 0, 8, 2, 10, 4, 12, 6, 14)
#define ODD_OF(x)  JET_SHUFFLE_8(x[0], x[1], 1, 9, 3, 11, 5, 13, 7, 15)
#define SWAPPED(x) JET_SHUFFLE_8(x, x, 2, 3, 0, 1, 6, 7, 4, 5)

/* Eight nodes are one vector. Halves are added to halves: of each unknown once and twice side by side, then of both
 * unknowns; so half as many operations, and no chain, as above. */
JET_INLINE void sum_as_tree(const galerkin_weights *weights, const double *u, const double *v, pair_sums *sums)
{
    const jet_v8 *halves = (const jet_v8 *)weights->halves, of_last = *(const jet_v8 *)weights->last;
    const jet_v8 impulse[2] = {*(const jet_v8 *)u, *(const jet_v8 *)v};
    jet_v8 sum[2], lost[2] = {{0}}, last[2];
    for (int i = 0; i < 2; i++) {
        const jet_v8 late = halves[1] * JET_SHUFFLE_8(impulse[i], impulse[i], 4, 5, 6, 7, 4, 5, 6, 7);
        sum[i] = halves[0] * JET_SHUFFLE_8(impulse[i], impulse[i], 0, 1, 2, 3, 0, 1, 2, 3);
        add_two_sum_of_jet_v8(&sum[i], &lost[i], &late);
        last[i] = of_last * impulse[i];
    }
    jet_v8 total = EVEN_OF(sum), less = EVEN_OF(lost) + ODD_OF(lost);
    const jet_v8 odd = ODD_OF(sum);
    add_two_sum_of_jet_v8(&total, &less, &odd);
    less += SWAPPED(less);
    const jet_v8 other = SWAPPED(total);
    add_two_sum_of_jet_v8(&total, &less, &other);
    const jet_v8 whole = total + less, low = less - (whole - total);
    const jet_v8 of_both = EVEN_OF(last) + ODD_OF(last), of_half = of_both + SWAPPED(of_both);
    const double last_of_u = of_half[0] + of_half[4], last_of_v = of_half[1] + of_half[5];
    sums->of_pair = (jet_v4){whole[0], whole[4], whole[1], whole[5]};
    sums->low = (jet_v4){low[0], low[4], low[1], low[5]};
    sums->last = (jet_v4){last_of_u, last_of_u, last_of_v, last_of_v};
}
#elif defined(__AVX2__)

/* Of two vectors side by side the numbers at even places, at odd ones, and their first and last halves. */
#define EVEN_OF(a, b)  JET_SHUFFLE_4(a, b, 0, 4, 2, 6)
#define ODD_OF(a, b)   JET_SHUFFLE_4(a, b, 1, 5, 3, 7)
#define FIRST_OF(a, b) JET_SHUFFLE_4(a, b, 0, 1, 4, 5)
#define LAST_OF(a, b)  JET_SHUFFLE_4(a, b, 2, 3, 6, 7)

/* Eight nodes are two vectors. Halves are added to halves: of each unknown once and twice, which are then side by side,
 * then of both unknowns; so half as many operations, and no chain, as above. */
JET_INLINE void sum_as_tree(const galerkin_weights *weights, const double *u, const double *v, pair_sums *sums)
{
    const jet_v4 *halves = (const jet_v4 *)weights->halves, *of_last = (const jet_v4 *)weights->last;
    const jet_v4 *impulse[2] = {(const jet_v4 *)u, (const jet_v4 *)v};
    jet_v4 pair[2], less[2], last[2];
    for (int i = 0; i < 2; i++) {
        jet_v4 once = impulse[i][0], twice = halves[1] * impulse[i][0], lost[2] = {{0}};
        const jet_v4 late = halves[3] * impulse[i][1];
        add_two_sum_of_jet_v4(&once, &lost[0], &impulse[i][1]);
        add_two_sum_of_jet_v4(&twice, &lost[1], &late);
        const jet_v4 odd = ODD_OF(once, twice);
        pair[i] = EVEN_OF(once, twice);
        less[i] = EVEN_OF(lost[0], lost[1]) + ODD_OF(lost[0], lost[1]);
        add_two_sum_of_jet_v4(&pair[i], &less[i], &odd);
        last[i] = of_last[0] * impulse[i][0] + of_last[1] * impulse[i][1];
    }
    jet_v4 total = FIRST_OF(pair[0], pair[1]), lost = FIRST_OF(less[0], less[1]) + LAST_OF(less[0], less[1]);
    const jet_v4 other = LAST_OF(pair[0], pair[1]);
    add_two_sum_of_jet_v4(&total, &lost, &other);
    sums->of_pair = total + lost;
    sums->low = lost - (sums->of_pair - total);
    const jet_v4 of_both = EVEN_OF(last[0], last[1]) + ODD_OF(last[0], last[1]);
    const double last_of_u = of_both[0] + of_both[2], last_of_v = of_both[1] + of_both[3];
    sums->last = (jet_v4){last_of_u, last_of_u, last_of_v, last_of_v};
}
#endif

/* A tree where a step waits for its sums: with the widest vectors, of more unknowns none does. */
JET_INLINE void sum_pair(const galerkin_weights *weights, const double *u, const double *v, int unknowns, int lanes,
                         pair_sums *sums)
{
    const int end = POINTS_OF(weights) - 1;
    const jet_v4 first = {u[0], u[0], v[0], v[0]}, final = {u[end], u[end], v[end], v[end]};
    sums->reach = JET_ABS(jet_v4, first) + JET_ABS(jet_v4, final);
#ifdef __AVX2__
    if ((unknowns <= GALERKIN_FEWEST || WIDEST < 8) && lanes == 8) {
        sum_as_tree(weights, u, v, sums);
        return;
    }
#endif
    (void)unknowns;
    sum_in_chains(weights, u, v, lanes, sums);
}

/* Those that stand there, of unknown u. */
JET_INLINE void put_sums(const pair_sums *pair, int at, const galerkin_sums *sums, int u)
{
    sums->once[u] = pair->of_pair[at];
    sums->twice[u] = pair->of_pair[at + 1];
    sums->once_low[u] = pair->low[at];
    sums->twice_low[u] = pair->low[at + 1];
    sums->last[u] = fabs(pair->last[at]);
    sums->reach[u] = pair->reach[at];
}

#endif
