/* table_guard.c - Writes the table of refused steps of docs/stability.md. */
#include "ladder.h"
#include "method/list.h"
#include "tables.h"

#include <math.h>

/* Rungs: 6 to 3200 steps of the case's time, each climbed for that time and LEAST_STEPS at least. */
#define FEWEST 6.0
#define MOST   3200.0
#define RATIO  2.0
enum { LEAST_STEPS = 60 };

static ladder_counts climb(const ladder_case *c, const hard_method *m)
{
    ladder_counts sum = {0};
    for (double steps = FEWEST; steps < MOST * RATIO; steps *= RATIO) {
        const double cut = fmin(steps, MOST);
        const ladder_counts rung = ladder_climb(c, m, c->period / cut, (int)fmax(cut, LEAST_STEPS));
        ladder_add(&sum, &rung);
    }
    return sum;
}

/* All that the library has a name for: of both rules for nodes, at each order. The counts of the explicit one, which
 * may change the energy by much, are added to *verlet instead. */
static ladder_counts climb_all(const ladder_case *c, FILE *csv, ladder_counts *verlet)
{
    ladder_counts sum = {0};
    const char *names[64] = {tvi_svhd.name};
    int count = 1;
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        for (int rule = 0; rule <= TVI_NODES_TRUNCATED; rule++)
            if ((*d)->nodes[rule].name) names[count++] = (*d)->nodes[rule].name;
    for (int i = 0; i < count * LADDER_ORDERS; i++) {
        const hard_method m = ladder_method(names[i / LADDER_ORDERS], i % LADDER_ORDERS);
        if (m.order == 0) continue;
        const ladder_counts counts = climb(c, &m);
        fprintf(csv, "%s,%s,%d,%ld,%ld,%.3e,%ld,%ld,%ld,%ld,%ld\n", c->problem->name, m.name, m.order, counts.accepted,
                counts.wrong, counts.most, counts.refused, counts.right, counts.near, counts.unread, counts.failed);
        ladder_add(ladder_is_explicit(&m) ? verlet : &sum, &counts);
    }
    return sum;
}

static void write_row(FILE *md, const char *title, const ladder_counts *counts)
{
    fprintf(md, "| %s | %ld | %.3f | %ld | %ld | %ld | %ld | %ld |\n", title, counts->accepted, counts->most,
            counts->wrong, counts->failed, counts->refused, counts->right, counts->near);
}

bool table_guard(const table_command *at)
{
    FILE *md = table_open(at, "guard.md"), *csv = table_open(at, "guard.csv");
    ladder_counts all = {0}, verlet = {0};
    if (!md || !csv) return false;
    fprintf(md,
            "| steps of | accepted (chaotic) | their largest change of energy (chaotic) | of more than 5 %% | failed "
            "(chaotic) | TVI_ETOOLARGE (chaotic) | of these right | right but for the energy (chaotic) |\n"
            "|---|---|---|---|---|---|---|---|\n");
    fprintf(csv, "case,method,order,accepted,wrong,most,refused,right,near,unread,failed\n");
    for (const ladder_case *c = ladder_cases; c->problem; c++) {
        table_progress("guard", c->title);
        const ladder_counts counts = climb_all(c, csv, &verlet);
        write_row(md, c->title, &counts);
        ladder_add(&all, &counts);
    }
    write_row(md, "all", &all);
    write_row(md, "all, of stormer-verlet", &verlet);
    return fclose(md) == 0 && fclose(csv) == 0;
}
