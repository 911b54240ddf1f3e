/* fingerprint.c - Computes the hashes of systems and options that saved states and generated code store
 * (fingerprint.h). */
#include "method/fingerprint.h"
#include "system/constraint.h"

#define COUNT(list) (sizeof(list) / sizeof *(list))

uint64_t tvi_system_fingerprint(const tvi_system *system)
{
    const int numbers[] = {system->n, (int)system->form, system->input_count, system->uses_time, system->is_driven};
    const jet_tape *const tapes[] = {system->field_series, system->field_values, system->r_dot_Hp_values,
                                     system->hessian.values};
    uint64_t sum = jet_continue_hash(JET_HASH_OF_NOTHING, numbers, sizeof numbers);
    for (size_t i = 0; i < COUNT(tapes); i++) sum = jet_tape_continue_hash(sum, tapes[i]);
    for (int i = 0; i < system->hessian.entry_count; i++) {
        const int entry[] = {system->hessian.entry[i].row, system->hessian.entry[i].column};
        sum = jet_continue_hash(sum, entry, sizeof entry);
    }
    sum = tvi_constraints_continue_hash(sum, system->constraints);
    const bool has_masses = system->form == TVI_SEPARABLE;
    return jet_continue_hash(sum, system->mass, has_masses ? (size_t)system->n * sizeof *system->mass : 0);
}

/* Lists the fields of the options one by one: the structure cannot be hashed as a whole, since it has gaps between
 * fields. If a field is missing here, the compiler reports a missing initialiser. `compiled` is not part of the
 * hash. */
#define OPTION_FIELDS(field)                                                                                           \
    field(method) field(expansion) field(nodes) field(order) field(degree) field(compose_adjoint) field(quadrature)    \
        field(quadrature_points) field(tolerance) field(passes) field(max_passes) field(max_tail)
#define VALUE(field) options->field,
#define HASH(field)  sum = jet_continue_hash(sum, &copy.field, sizeof copy.field);

uint64_t tvi_options_fingerprint(const tvi_options *options)
{
    const tvi_options copy = {OPTION_FIELDS(VALUE) NULL};
    uint64_t sum = JET_HASH_OF_NOTHING;
    OPTION_FIELDS(HASH)
    return sum;
}
