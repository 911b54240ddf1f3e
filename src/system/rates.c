/* rates.c - Computes q' and p' by the field (rates.h): p / m and F of a separable system, H_p and -H_q of a
 * Hamiltonian. */
#include "system/rates.h"

#include <stdlib.h>
#include <string.h>

tvi_status tvi_state_rates_open(tvi_rates_evaluator *rates, const tvi_system *system, const double parameters[])
{
    *rates = (tvi_rates_evaluator){.system = system};
    if (system->form == TVI_LAGRANGIAN) return TVI_OK;
    rates->field_block = malloc((size_t)system->field_values->slot_count * sizeof *rates->field_block);
    if (!rates->field_block) return TVI_ENOMEM;
    jet_tape_prepare_block(system->field_values, rates->field_block, 1, 1);
    tvi_state_rates_set_parameters(rates, parameters);
    return TVI_OK;
}

void tvi_state_rates_set_parameters(tvi_rates_evaluator *rates, const double parameters[])
{
    const tvi_system *system = rates->system;
    if (!rates->field_block) return;
    jet_tape_set_parameters(system->field_values, rates->field_block, 1, tvi_system_parameters(system), 1, parameters);
}

void tvi_state_rates_close(tvi_rates_evaluator *rates) { free(rates->field_block); }

tvi_status tvi_state_rates_compute(tvi_rates_evaluator *rates, const double x[], double rate[])
{
    const tvi_system *system = rates->system;
    const jet_tape *tape = system->field_values;
    const int n = system->n, *output = tape->output_slot;
    const double *block = rates->field_block;
    memcpy(rates->field_block, x, (size_t)system->input_count * sizeof *x);
    tvi_system_write_time(system, rates->field_block, 1, &x[2 * n]);
    if (!jet_sweep_values(tape, rates->field_block, 1)) return TVI_EDOMAIN;
    for (int i = 0; i < n; i++) {
        const bool has_masses = system->form == TVI_SEPARABLE;
        rate[i] = has_masses ? x[n + i] / system->mass[i] : block[output[n + i]];
        rate[n + i] = has_masses ? block[output[i]] : -block[output[i]];
    }
    return TVI_OK;
}
