/* emit.c - the series of a curve, and its tangents, in one function of generated code each. */
#include "generating/curve.h"

extern const char *const tvi_embedded_curve[];

static void emit(jet_text *text, const tvi_system *system, const char *name, int lanes)
{
    const bool is_separable = system->form == TVI_SEPARABLE;
    const char *form = is_separable ? "separable" : "hamiltonian";
    for (const char *const *line = tvi_embedded_curve; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "enum { RISE = %d, LANES = %d };\n", is_separable ? 2 : 1, lanes);
    jet_text_add(text, "#define ADVANCE tvi_advance_%s\n#define TANGENTS tvi_tangents_%s\n", form, form);
    jet_text_add(text, "static const int %s_output[] = {", name);
    for (int i = 0; i < system->field_series->outputs; i++) jet_text_add(text, "%d, ", system->field_series->output[i]);
    jet_text_add(text, "};\nCURVE_EMITTED_EXPAND(%s, %d)\n", name, system->n);
    if (lanes > 0) jet_text_add(text, "CURVE_EMITTED_DIFFERENTIATE(%s, %d)\n", name, system->n);
    jet_text_add(text, "static const tvi_curve_code %s = {tvi_series_top, LANES, %s_expand, ", name, name);
    jet_text_add(text, lanes > 0 ? "%s_differentiate};\n" : "0};\n", name);
}

void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    (void)options;
    emit(text, system, name, 0);
}

void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name)
{
    (void)options;
    emit(text, system, name, tvi_curve_lanes_of(system));
}
