/* main.c - Runs the suites of the jets layer; what is printed, and whether tests fork, is for Check's environment. */
#include "suites.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {record_suite,   domain_suite,  tape_suite, series_suite, identity_suite,
                                         tangent_suite,  adjoint_suite, isa_suite,  roots_suite,  elementary_suite,
                                         gradient_suite, hash_suite,    emit_suite, scales_suite};

int main(void) { return RUN_SUITES(suites); }
