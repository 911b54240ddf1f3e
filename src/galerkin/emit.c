/* emit.c - the loops of generated code: those of loops.c for one number of unknowns and lanes, and a whole step
 * in one function, where a pass is the field and `move`. */
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

void tvi_galerkin_emit(jet_text *text, const tvi_system *system, int lanes, bool is_plain, const char *name)
{
    const jet_tape *tape = system->field_values;
    for (const char *const *line = tvi_embedded_galerkin; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "GALERKIN_EMITTED_LOOPS(%s, %d, %d, %d)\n", name, system->n, system->inputs, lanes);
    if (is_plain) {
        emit_slots(text, system, name);
        jet_text_add(text, "GALERKIN_EMITTED_STEADY(%s, values_values_of, %d, %d, %d, %d)\n", name, system->inputs,
                     tape->inputs + tape->constants, tape->slots, lanes);
    }
    jet_text_add(text, "static const galerkin_loops %s = {GALERKIN_EMITTED_TABLE(%s), ", name, name);
    jet_text_add(text, is_plain ? "%s_steady};\n" : "0};\n", name);
}
