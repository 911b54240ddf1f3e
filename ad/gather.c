/* gather.c - the sum of jets that are sums themselves, in which what they have in common is one term. */
#include "graph.h"

#include <stdlib.h>

double jet_take_factor(jet *x)
{
    double factor = 1;
    if (!x->node) {
        factor = x->number;
        *x = jet_const(1);
    } else if (x->node->op == OP_LINEAR && x->node->count == 1 && x->node->number == 0) {
        factor = x->node->terms[0].coefficient;
        *x = jet_of_node(x->node->terms[0].node);
    }
    return factor;
}

/* A term of x[of], which is a sum, or has this one. */
typedef struct {
    jet_term term;
    int of;
    bool is_of_sum;
} part;

static bool is_sum(jet x) { return x.node && x.node->op == OP_LINEAR; }
static int terms_of(jet x) { return is_sum(x) ? x.node->count : x.node ? 1 : 0; }

/* x[of] as terms and a number; returns how many. */
static int take_apart(jet x, int of, part *parts, double *number)
{
    const double factor = jet_take_factor(&x);
    const int count = terms_of(x);
    for (int k = 0; k < count; k++) {
        parts[k] = (part){is_sum(x) ? x.node->terms[k] : (jet_term){1, x.node}, of, is_sum(x)};
        parts[k].term.coefficient *= factor;
    }
    *number += factor * (is_sum(x) ? x.node->number : x.node ? 0 : x.number);
    return count;
}

/* Which of x have an operation in common, one of them as a term of a sum; whether any have. Coordinates are not meant:
 * their differences, which have less roundoff than they, would be lost. */
static bool find_meeting(const part parts[], int count, bool *meets)
{
    bool any = false;
    for (int i = 0; i < count; i++) {
        struct jet_node *node = parts[i].term.node;
        const part *first = node->mark >= 0 && node->mark < i ? &parts[node->mark] : NULL;
        if (!first || first->term.node != node) node->mark = i;
        else if (node->op != OP_INPUT && (first->is_of_sum || parts[i].is_of_sum))
            any = meets[first->of] = meets[parts[i].of] = true;
    }
    return any;
}

static int by_index(const void *first, const void *second)
{
    const part *x = first, *y = second;
    return x->term.node->index - y->term.node->index;
}

/* Room for all terms, and which of x have one in common. */
typedef struct {
    part *parts;
    bool *meets;
    double *coefficient;
    jet *of;
} gathering;

/* The terms of those that meet, what was recorded first first, as it is there first; then the others as they are. */
static jet merge(const gathering *w, const jet x[], int count)
{
    int terms = 0;
    double number = 0;
    for (int i = 0; i < count; i++)
        if (w->meets[i]) terms += take_apart(x[i], i, w->parts + terms, &number);
    qsort(w->parts, (size_t)terms, sizeof *w->parts, by_index);
    for (int i = 0; i < terms; i++) {
        w->coefficient[i] = w->parts[i].term.coefficient;
        w->of[i] = jet_of_node(w->parts[i].term.node);
    }
    w->coefficient[terms] = number;
    w->of[terms++] = jet_const(1);
    for (int i = 0; i < count; i++) {
        if (w->meets[i]) continue;
        w->coefficient[terms] = 1;
        w->of[terms++] = x[i];
    }
    return jet_linear(terms, w->coefficient, w->of);
}

jet jet_gather(const jet x[], int count)
{
    bool has_sum = false, has_poison = false;
    size_t most = 1;
    for (int i = 0; i < count; i++) {
        jet one = x[i];
        has_poison |= jet_is_poison(one);
        (void)jet_take_factor(&one);
        has_sum |= is_sum(one);
        most += 1 + (size_t)terms_of(one);
    }
    if (!has_sum || has_poison || count < 2) return jet_sum(x, count);
    const gathering w = {malloc(most * sizeof(part)), calloc(most, sizeof(bool)), malloc(most * sizeof(double)),
                         malloc(most * sizeof(jet))};
    jet sum = jet_poison(JET_NO_MEMORY);
    if (w.parts && w.meets && w.coefficient && w.of) {
        int parts = 0;
        double number = 0;
        for (int i = 0; i < count; i++) parts += take_apart(x[i], i, w.parts + parts, &number);
        sum = find_meeting(w.parts, parts, w.meets) ? merge(&w, x, count) : jet_sum(x, count);
    }
    free(w.parts);
    free(w.meets);
    free(w.coefficient);
    free(w.of);
    return sum;
}
