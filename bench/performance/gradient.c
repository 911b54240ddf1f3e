/* gradient.c - one gradient of the discrete action (the force at the nodes, the seeds, one adjoint sweep) against one
 * plain expansion, at N = 8. Writes DIR/gradient.md and DIR/gradient.csv.
 *
 *   gradient DIR */
#include "bodies.h"
#include "curves.h"
#include "experiments/experiment.h"
#include "turns.h"

enum { DEGREE = 8 };
static const int sizes[] = {3, 6, 10, 20, 30, 40};
enum { SIZES = sizeof sizes / sizeof *sizes };

typedef struct {
    FILE *table, *csv;
} files;

static void measure(const tvi_system *system, const double q[], const double p[], double h, const char *title,
                    const files *f)
{
    open_curve *c = curve_open(system, DEGREE, q, p, h);
    turn t[] = {{.work = curve_expand, .ctx = c}, {.work = curve_gradient, .ctx = c}, {.work = curve_pull, .ctx = c}};
    turns_time(3, t);
    const double sweep = t[2].seconds / t[0].seconds, gradient = t[1].seconds / t[0].seconds;
    fprintf(f->table, "| %s | %d | %.2f | %.2f | %.2f | %.2f |\n", title, system->n, 1e6 * t[0].seconds,
            gradient - sweep, sweep, gradient);
    fprintf(f->csv, "%s,%d,%.1f,%.1f,%.1f\n", title, system->n, 1e9 * t[0].seconds, 1e9 * t[1].seconds,
            1e9 * t[2].seconds);
    curve_close(c);
}

static void measure_solar(const files *f)
{
    const scene *s = &scene_solar;
    tvi_system *system = experiment_system(s);
    measure(system, s->q, s->p, 400, "outer Solar System", f);
    tvi_system_free(system);
}

static void measure_bodies(int count, const files *f)
{
    char title[32];
    snprintf(title, sizeof title, "%d bodies", count);
    big_system b = bodies_make(count, 3);
    measure(b.system, b.q, b.p, b.h, title, f);
    tvi_system_free(b.system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    const files f = {experiment_table(&e, "gradient",
                                      "system|n|expansion, us (time)|nodes and seeds / expansion (time)|"
                                      "adjoint sweep / expansion (time)|gradient / expansion (time)"),
                     experiment_csv(&e, "gradient", "system,n,expansion ns,gradient ns,adjoint sweep ns")};
    measure_solar(&f);
    for (int i = 0; i < SIZES; i++) {
        measure_bodies(sizes[i], &f);
        experiment_progress("gradient: %d bodies", sizes[i]);
    }
    experiment_close(f.table);
    experiment_close(f.csv);
    return 0;
}
