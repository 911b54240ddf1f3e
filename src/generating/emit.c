/* emit.c - the series of a curve in one function of generated code. */
#include "generating/curve.h"

extern const char *const tvi_embedded_curve[];

void tvi_curve_emit(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    (void)options;
    const bool is_separable = system->form == TVI_SEPARABLE;
    for (const char *const *line = tvi_embedded_curve; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "#define RISE %d\n#define ADVANCE tvi_advance_%s\n", is_separable ? 2 : 1,
                 is_separable ? "separable" : "hamiltonian");
    jet_text_add(text, "static const int %s_output[] = {", name);
    for (int i = 0; i < system->field_series->outputs; i++) jet_text_add(text, "%d, ", system->field_series->output[i]);
    jet_text_add(text, "};\nCURVE_EMITTED(%s, %d)\n", name, system->n);
}
