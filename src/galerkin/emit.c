/* emit.c - the loops of generated code: those of loops.c for one number of unknowns and lanes, and a whole step
 * in one function, where a pass is the field and `move`. */
#include "galerkin/model.h"

#include <stdlib.h>

extern const char *const tvi_embedded_galerkin[];

static void emit_ints(jet_text *text, const char *name, const char *what, int count, const int value[])
{
    jet_text_add(text, "static const int %s_%s[] = {", name, what);
    for (int i = 0; i < count; i++) jet_text_add(text, "%d, ", value[i]);
    jet_text_add(text, "0};\n");
}

static int rows_kept(const jet_tape *tape) { return tape->inputs + tape->constants; }

static void emit_plain(jet_text *text, const tvi_system *system, int lanes, const char *name)
{
    int copies = 0;
    jet_text_add(text, "static const int %s_copied[] = {", name);
    for (int u = 0; u < system->inputs; u++) {
        const int slot = tvi_galerkin_driving_slot(system, u);
        if (slot < system->inputs) jet_text_add(text, "%d, ", slot);
    }
    jet_text_add(text, "0};\nstatic const int %s_slot[] = {", name);
    for (int u = 0; u < system->inputs; u++) jet_text_add(text, "%d, ", tvi_galerkin_driven_slot(system, u, &copies));
    jet_text_add(text, "};\nenum { %s_copies = %d };\n", name, copies);
    jet_text_add(text, "GALERKIN_EMITTED_STEADY(%s, tvi_values_values_of, %d, %d, %d, %d)\n", name, system->inputs,
                 rows_kept(system->field_values), system->field_values->slots, lanes);
}

static void emit_terms(jet_text *text, const tvi_system *system, const char *name)
{
    const size_t rows = 2 * (size_t)system->n, most = 2 * (size_t)system->seconds + 1;
    lanes_term *term = calloc(most, sizeof *term);
    int *end = calloc(rows, sizeof *end);
    text->failed |= !term || !end;
    if (term && end) {
        tvi_galerkin_model_terms(system, term, end);
        emit_ints(text, name, "end", 2 * system->n, end);
        jet_text_add(text, "static const lanes_term %s_term[] = {", name);
        for (int k = 0; k < end[rows - 1]; k++) jet_text_add(text, "{%d, %d}, ", term[k].column, term[k].slot);
        jet_text_add(text, "{0}};\n");
    }
    free(term);
    free(end);
}

static void emit_lagrangian(jet_text *text, const tvi_system *system, int lanes, const char *name)
{
    const jet_tape *values = system->field_values, *second = system->second_values;
    emit_terms(text, system, name);
    emit_ints(text, name, "of_values", system->inputs, values->output);
    emit_ints(text, name, "of_second", system->inputs, second->output);
    jet_text_add(text, "static const int %s_slot[] = {", name);
    for (int u = 0; u < system->inputs; u++) jet_text_add(text, "%d, ", system->inputs + u);
    jet_text_add(text, "};\nGALERKIN_EMITTED_LAGRANGIAN(%s, %d, %d, %d, %d, %d, %d, %d)\n", name, system->n, lanes,
                 second->inputs, rows_kept(values), values->slots, rows_kept(second), second->slots);
}

void tvi_galerkin_emit(jet_text *text, const tvi_system *system, int lanes, const char *name)
{
    const bool is_plain = !system->second_values, is_lagrangian = !is_plain && system->form == TVI_LAGRANGIAN;
    jet_text_add(text, "enum { GALERKIN_LANES = %d };\n", lanes);
    for (const char *const *line = tvi_embedded_galerkin; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "GALERKIN_EMITTED_LOOPS(%s, %d, %d, %d)\n", name, system->n, system->inputs, lanes);
    if (is_plain) emit_plain(text, system, lanes, name);
    if (is_lagrangian) emit_lagrangian(text, system, lanes, name);
    jet_text_add(text, "static const galerkin_loops %s = {GALERKIN_EMITTED_TABLE(%s), ", name, name);
    jet_text_add(text, is_plain || is_lagrangian ? "%s_steady};\n" : "0};\n", name);
}
