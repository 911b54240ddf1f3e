/* peers.c - Compares Gauss collocation of order 16 against another program of it: peers DIR runs DIR/gauss
 * in turns with ours. */
#include "runs/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct {
    const scene *scene;
    const char *problem; /* the other program's name of it */
    double h;
} cases[] = {{&scene_kepler, "kep250", 0.25}, {&scene_solar, "oss", 400}};

enum { TURNS = 7 };
static const double MOST = 1.1; /* of the ratio: a rival of ours that is slower than this is a weak one */

/* The least time that `dir`/gauss prints, in s; infinite where it cannot be run. */
static double peers_time(const char *dir, const char *problem, double h)
{
    char command[4096], text[1024];
    double least = INFINITY;
    snprintf(command, sizeof command, "'%s/gauss' %s 8 %g", dir, problem, h);
    FILE *pipe = popen(command, "r");
    if (!pipe) return INFINITY;
    if (!fgets(text, sizeof text, pipe) || sscanf(text, "%*[^,],%*[^,],%*[^,],%*[^,],%lf", &least) != 1)
        least = INFINITY;
    return pclose(pipe) == 0 ? least : INFINITY;
}

/* false: ours is too slow, or theirs could not be run. */
static bool compare(const char *dir, const contender *gauss, const scene *s, const char *problem, double h)
{
    tvi_system *system;
    double ours = INFINITY, theirs = INFINITY;
    if (scene_system(s, &system) != TVI_OK) return false;
    for (int turn = 0; turn < TURNS; turn++) {
        run r;
        run_contender(system, s, gauss, h, INFINITY, &r);
        ours = r.status == TVI_OK ? fmin(ours, r.cpu) : ours;
        theirs = fmin(theirs, peers_time(dir, problem, h));
    }
    tvi_system_free(system);
    printf("%s, gauss 16, h = %g: %.4f ms, the peers' %.4f ms, ratio %.3f\n", s->name, h, 1e3 * ours, 1e3 * theirs,
           ours / theirs);
    return ours / theirs <= MOST;
}

int main(int argc, char *argv[])
{
    const contender gauss = {.name = "gauss", .order = 16, .baseline = baseline_find("gauss", 16)};
    bool good = argc == 2 && gauss.baseline;
    for (size_t i = 0; i < sizeof cases / sizeof *cases && good; i++)
        good = compare(argv[1], &gauss, cases[i].scene, cases[i].problem, cases[i].h);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
