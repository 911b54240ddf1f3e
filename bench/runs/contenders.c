/* contenders.c - Lists the methods and baselines of a sweep (contenders.h). */
#include "contenders.h"

#include <stdlib.h>
#include <string.h>

/* "midpoint-truncated" is no named method of the library: it shows what the on-curve nodes of "midpoint" are worth. */
static tvi_status options_named(const char *name, int order, tvi_options *options)
{
    if (strcmp(name, "midpoint-truncated") != 0) return tvi_options_named(name, order, options);
    *options =
        (tvi_options){.method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT, .nodes = TVI_NODES_TRUNCATED, .order = order};
    return TVI_OK;
}

static void add(contenders *list, const contender *who)
{
    if (list->count < CONTENDERS_MOST) list->of[list->count++] = *who;
}

void contenders_add_methods(contenders *list, const method_range ranges[], int count)
{
    for (const method_range *r = ranges; r < ranges + count; r++)
        for (int order = r->first; order <= r->last; order += r->step) {
            contender who = {.name = r->name, .order = order, .symplectic = r->symplectic};
            if (options_named(r->name, order, &who.options) == TVI_OK) add(list, &who);
        }
}

void contenders_add_baselines(contenders *list)
{
    const baseline *b;
    for (int i = 0; (b = baseline_at(i)); i++)
        add(list, &(contender){.name = b->name, .order = b->order, .symplectic = b->symplectic, .baseline = b});
}

void contenders_add_compiled(contenders *list, const char *name, const char *method, int order)
{
    contender who = {.name = name, .order = order, .symplectic = true, .is_compiled = true};
    if (tvi_options_named(method, order, &who.options) == TVI_OK) add(list, &who);
}

static int falling_order(const void *a, const void *b)
{
    const contender *x = a, *y = b;
    if (x->order != y->order) return y->order - x->order;
    return strcmp(x->name, y->name);
}

void contenders_sort(contenders *list) { qsort(list->of, (size_t)list->count, sizeof *list->of, falling_order); }
