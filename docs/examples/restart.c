/* restart.c - a long run in two parts: the second one goes on from a file, bit for bit as if it had not been interrupted.
 *   cc restart.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <stdio.h>

enum { BYTES = 1 << 16 }; /* tvi_state_save with a buffer of NULL asks how many */
static const char file_name[] = "kepler.state";

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static tvi_status save(const tvi_integrator *integrator)
{
    static char bytes[BYTES];
    size_t size = sizeof bytes;
    const tvi_status status = tvi_state_save(integrator, bytes, &size);
    FILE *file = status == TVI_OK ? fopen(file_name, "wb") : NULL;
    const size_t written = file ? fwrite(bytes, 1, size, file) : 0;
    return file && fclose(file) == 0 && written == size ? status : TVI_EINVAL;
}

/* Into a new integrator, as another process would; t, q and p are what the last step returned. */
static tvi_status load(tvi_integrator *integrator, double *t, double q[], double p[])
{
    static char bytes[BYTES];
    int n = 0;
    FILE *file = fopen(file_name, "rb");
    if (!file) return TVI_EINVAL;
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    (void)fclose(file);
    tvi_status status = tvi_state_peek(bytes, size, &n, t, q, p);
    if (status == TVI_OK) printf("the file has t = %g, n = %d\n", *t, n);
    return status == TVI_OK ? tvi_state_load(integrator, bytes, size) : status;
}

int main(void)
{
    double t = 0, q[] = {1, 0}, p[] = {0, 0.8}, t_whole = 0, q_whole[] = {1, 0}, p_whole[] = {0, 0.8};
    tvi_system *system;
    tvi_integrator *first = NULL, *second = NULL, *whole = NULL;
    tvi_status status = tvi_system_potential(&system, 2, NULL, potential, NULL);
    if (status == TVI_OK) status = tvi_integrator_create(&first, system, NULL);
    if (status == TVI_OK) status = tvi_integrator_create(&second, system, NULL);
    if (status == TVI_OK) status = tvi_integrator_create(&whole, system, NULL);
    if (status == TVI_OK) status = tvi_integrate(whole, 0.25, 8000, &t_whole, q_whole, p_whole, NULL, NULL);
    if (status == TVI_OK) status = tvi_integrate(first, 0.25, 4000, &t, q, p, NULL, NULL);
    if (status == TVI_OK) status = save(first);
    if (status == TVI_OK) status = load(second, &t, q, p);
    if (status == TVI_OK) status = tvi_integrate(second, 0.25, 4000, &t, q, p, NULL, NULL);
    if (status != TVI_OK) fprintf(stderr, "%s\n", tvi_last_error());
    else printf("t = %g: %s bits\n", t, q[0] == q_whole[0] && p[1] == p_whole[1] ? "the same" : "other");
    tvi_integrator_free(first), tvi_integrator_free(second), tvi_integrator_free(whole);
    tvi_system_free(system);
    return status != TVI_OK;
}
