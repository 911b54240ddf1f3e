/* emit.c - the loops of generated code: those of loops.c for one number of unknowns and lanes, and a pass in one
 * function, where it is the field and `move`. */
#include "galerkin/field.h"

extern const char *const tvi_embedded_galerkin[];

static void emit_slots(jet_text *text, const tvi_system *system, const char *name)
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
}

void tvi_galerkin_emit(jet_text *text, const tvi_system *system, int lanes, bool has_pass, const char *name)
{
    for (const char *const *line = tvi_embedded_galerkin; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "GALERKIN_EMITTED_LOOPS(%s, %d, %d, %d)\n", name, system->n, system->inputs, lanes);
    if (has_pass) {
        emit_slots(text, system, name);
        jet_text_add(text, "GALERKIN_EMITTED_PASS(%s, values_values_of, %d, %d)\n", name, system->field_values->slots,
                     lanes);
    }
    jet_text_add(text, "static const galerkin_loops %s = {GALERKIN_EMITTED_TABLE(%s), ", name, name);
    jet_text_add(text, has_pass ? "%s_pass};\n" : "0};\n", name);
}
