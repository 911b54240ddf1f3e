/* emit.c - the loops of generated code: those of loops.c for one number of unknowns and lanes, and a whole step in one
 * function, by the passes of the field's form. */
#include "galerkin/field.h"

extern const char *const tvi_embedded_galerkin[];

void tvi_galerkin_emit_ints(jet_text *text, const char *name, const char *what, int count, const int value[])
{
    jet_text_add(text, "static const int %s_%s[] = {", name, what);
    for (int i = 0; i < count; i++) jet_text_add(text, "%d, ", value[i]);
    jet_text_add(text, "0};\n");
}

#define FIELD(name) #name, r->name

static void emit_rule(jet_text *text, const tvi_passes_rule *r, const char *name)
{
    const struct {
        const char *name;
        double value; /* of integers, too */
    } field[] = {{FIELD(most)},        {FIELD(exactly)}, {FIELD(goal)},  {FIELD(noise)},
                 {FIELD(contraction)}, {FIELD(stuck)},   {FIELD(turns)}, {FIELD(is_quadratic)}};
    jet_text_add(text, "static const tvi_passes_rule %s_rule = {", name);
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        jet_text_add(text, ".%s = %a, ", field[i].name, field[i].value);
    jet_text_add(text, "};\n");
}

void tvi_galerkin_emit(jet_text *text, const galerkin_field *field, const tvi_passes_rule *rule, const char *name)
{
    const int lanes = field->nodes.lanes;
    jet_text_add(text, "enum { GALERKIN_LANES = %d, GALERKIN_POINTS = %d };\n", lanes, field->points);
    for (const char *const *line = tvi_embedded_galerkin; *line; line++) jet_text_add(text, "%s", *line);
    jet_text_add(text, "GALERKIN_EMITTED_LOOPS(%s, %d, %d, %d, %d, %d)\n", name, field->system->n,
                 field->system->parts.count, field->nodes.moving, field->nodes.unknowns, lanes);
    emit_rule(text, rule, name);
    field->form->emit(text, field, name);
    jet_text_add(text, "GALERKIN_EMITTED_ROW(%s)\n", name);
    jet_text_add(text, "static const galerkin_loops %s = {GALERKIN_EMITTED_TABLE(%s)};\n", name, name);
}
