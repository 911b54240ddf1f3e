/* A program whose locale writes 0,1 for 0.1 compiles a system: the written code has numbers with a comma, which the
 * compiler refuses. Right: tvi_compile works, tvi_compiled_write writes the bytes that it writes in the locale "C",
 * and tvi_state_to_text does; the text of a state is read again as the state that it is of. The locale de_DE.UTF-8
 * is in LOCPATH. */
#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.1, jet_sqr(q[0]));
}

static void read_file(const char *name, char *text, size_t size)
{
    FILE *file = fopen(name, "r");
    if (!file) exit(1);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

static void test_files(const tvi_system *system)
{
    static char with_point[1 << 20], with_comma[1 << 20];
    setlocale(LC_ALL, "C");
    TVI_OR_EXIT(tvi_compiled_write(system, NULL, "spring", "point.c"));
    setlocale(LC_ALL, "de_DE.UTF-8");
    const tvi_status status = tvi_compiled_write(system, NULL, "spring", "comma.c");
    read_file("point.c", with_point, sizeof with_point), read_file("comma.c", with_comma, sizeof with_comma);
    row(status == TVI_OK && *with_point && !strcmp(with_point, with_comma), "tvi_compiled_write: %d", status);
}

static void test_states(const tvi_system *system)
{
    tvi_integrator *it;
    char text[2][1 << 14];
    double t = 0.25, q = 1.5, p = 0.125;
    size_t size[2] = {sizeof text[0], sizeof text[1]};
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    setlocale(LC_ALL, "C");
    TVI_OR_EXIT(tvi_state_to_text(it, t, &q, &p, text[0], &size[0]));
    setlocale(LC_ALL, "de_DE.UTF-8");
    TVI_OR_EXIT(tvi_state_to_text(it, t, &q, &p, text[1], &size[1]));
    row(size[0] == size[1] && !memcmp(text[0], text[1], size[0]), "tvi_state_to_text");
    t = q = p = 0;
    const tvi_status status = tvi_state_from_text(it, text[0], size[0], &t, &q, &p);
    row(status == TVI_OK && t == 0.25 && q == 1.5 && p == 0.125, "tvi_state_from_text: %d, q = %g", status, q);
    tvi_integrator_free(it);
}

int main(void)
{
    tvi_system *system;
    tvi_compiled *code = NULL;
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) return puts("no locale de_DE.UTF-8"), 1;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    const tvi_status status = tvi_compile(&code, system, NULL, &(tvi_compiler){.cache = ""});
    row(status == TVI_OK, "tvi_compile: %d", status);
    test_files(system);
    test_states(system);
    tvi_compiled_free(code), tvi_system_free(system);
    return verdict();
}
