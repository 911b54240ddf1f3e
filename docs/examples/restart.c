/* restart.c - a long run in two parts: the second one goes on from a file, bit for bit as if it had not been interrupted.
 *   cc restart.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <stdio.h>
#include <stdlib.h>
#include <stdlib.h>

enum { ROOM = 1 << 16 }; /* tvi_state_to_text with a buffer of NULL asks how much it needs */
static char text[ROOM];
static const char file_name[] = "kepler.state";

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

/* Reads or writes the text, and returns its number of characters. */
static size_t transfer(const char *mode, size_t size)
{
    FILE *file = fopen(file_name, mode);
    const size_t count = !file ? 0 : *mode == 'r' ? fread(text, 1, size, file) : fwrite(text, 1, size, file);
    if (file && fclose(file) == 0 && count > 0) return count;
    perror(file_name);
    exit(EXIT_FAILURE);
}

int main(void)
{
    double t = 0, q[] = {1, 0}, p[] = {0, 0.8}, t_whole = 0, q_whole[] = {1, 0}, p_whole[] = {0, 0.8};
    size_t size = sizeof text;
    int n;
    tvi_system *system;
    tvi_integrator *first, *second, *whole;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&first, system, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&second, system, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&whole, system, NULL));
    TVI_OR_EXIT(tvi_integrate(whole, 0.25, 8000, &t_whole, q_whole, p_whole, NULL, NULL));
    TVI_OR_EXIT(tvi_integrate(first, 0.25, 4000, &t, q, p, NULL, NULL));
    TVI_OR_EXIT(tvi_state_to_text(first, t, q, p, text, &size));
    transfer("w", size);
    /* into a new integrator, as another process would; t, q and p become what the last step returned */
    size = transfer("r", sizeof text);
    TVI_OR_EXIT(tvi_state_peek(text, size, &n, &t, q, p));
    printf("the file has t = %g, n = %d\n", t, n);
    TVI_OR_EXIT(tvi_state_from_text(second, text, size, &t, q, p));
    TVI_OR_EXIT(tvi_integrate(second, 0.25, 4000, &t, q, p, NULL, NULL));
    printf("t = %g: %s bits\n", t, q[0] == q_whole[0] && p[1] == p_whole[1] ? "the same" : "other");
    tvi_integrator_free(first), tvi_integrator_free(second), tvi_integrator_free(whole);
    tvi_system_free(system);
}
