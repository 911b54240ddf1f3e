/* emitted_passes.h - the passes of whole steps of generated code (emitted_steps.h), by the form of the field. */
#ifndef TVI_SRC_GALERKIN_EMITTED_PASSES_H
#define TVI_SRC_GALERKIN_EMITTED_PASSES_H

#include "galerkin/few.h"
#include "galerkin/hamiltonian_passes.h"
#include "galerkin/lagrangian_passes.h"
#include "galerkin/steady.h"

/* Sets the impulses at the nodes; false outside the field's domain. */
typedef bool steady_field(const galerkin_nodes *nodes, int lanes);

/* What a pass is made by: the field, or passes of their own. The rule is of constants where the registers are not the
 * field's. */
typedef struct {
    const tvi_passes_rule *rule;
    steady_field *drive;
    galerkin_sweep *sweep;
    lagrangian_passes *lagrangian;
    hamiltonian_passes *hamiltonian;
} steady_form;

/* A pass in two parts, between which its impulses are stored. Many unknowns that stayed in registers until the next one
 * would take those that it needs. */
JET_INLINE bool steady_begin(const galerkin_nodes *nodes, const steady_form *form, int lanes)
{
    double *x = nodes->x;
    if (!form->drive) return true;
    if (nodes->unknowns > GALERKIN_FEW) LEAVE_REGISTERS(x);
    return form->drive(nodes, lanes);
}

JET_INLINE bool steady_end(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                           double *moved, int lanes)
{
    if (form->lagrangian) {
        const lagrangian_passed passed = lagrangian_pass(form->lagrangian, form->sweep);
        *moved = form->lagrangian->moved;
        return passed == LAGRANGIAN_PASSED;
    }
    if (form->hamiltonian) {
        const bool is_inside = hamiltonian_pass(form->hamiltonian, form->sweep);
        *moved = form->hamiltonian->moved;
        return is_inside;
    }
    if (ARE_FEW(nodes, lanes)) {
        jet_v8 squares;
        follow_few(nodes, frame->matrix, &squares);
        *moved = sum_of_jet_v8(squares);
    } else {
        *moved = follow_lanes(nodes, frame->matrix, NULL, lanes);
    }
    return true;
}

/* Passes that are not judged: what they moved, and whether the last one moved nothing. */
enum { STEADY_SILENT = 24 };
typedef struct {
    int count;
    bool rests;
    double moved[STEADY_SILENT];
} steady_silence;

/* A few unknowns stay in registers from the end of a pass to the beginning of the next one, which follows directly: the
 * first one has begun. Sums of squares are had where they are needed. */
JET_INLINE bool steady_keep_silent(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                                   long most, steady_silence *of, int lanes)
{
    const bool few = nodes->unknowns <= GALERKIN_FEW;
    jet_v8 squares[STEADY_SILENT];
    of->count = 0;
    of->rests = false;
    while (of->count < most && !of->rests) {
        const int now = of->count++;
        if (!few && !steady_begin(nodes, form, lanes)) return false;
        if (!ARE_ONE_VECTOR(lanes)) {
            (void)steady_end(frame, nodes, form, &of->moved[now], lanes);
            of->rests = of->moved[now] == 0;
        } else {
            if (ARE_FEW(nodes, lanes)) follow_few(nodes, frame->matrix, &squares[now]);
            else (void)follow_to(nodes, frame->matrix, NULL, (double *)&squares[now], lanes);
            of->rests = are_at_rest(squares[now]);
        }
        if (few && !of->rests && !steady_begin(nodes, form, lanes)) return false;
    }
    if (ARE_ONE_VECTOR(lanes))
        for (int i = 0; i < (of->rests ? 1 : of->count); i++) of->moved[i] = sum_of_jet_v8(squares[i]);
    return true;
}

/* Steps end most often as nothing moves any more. No processor foresees with which pass, and a judge of each of them
 * makes it wait longer for what it took wrongly. So, if the last step ended like that, only this is asked of so many
 * passes as it took, and of some more: few unknowns rest nearly always, many often do not. If they do not rest, all are
 * judged as if they had been from the first one on. */
#define STEADY_MORE(unknowns) ((unknowns) <= FEW ? 3 : 1)
JET_INLINE bool steady_passes(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                              galerkin_trial *shown, int lanes)
{
    const bool few = nodes->unknowns <= GALERKIN_FEW;
    const tvi_passes_rule *rule = form->rule;
    tvi_passes passes;
    tvi_passes_verdict verdict = TVI_PASSES_GO_ON;
    steady_silence silence;
    silence.count = 0;
    if (form->drive && shown->pace.silent > 0) {
        const long room = rule->most < STEADY_SILENT ? rule->most : STEADY_SILENT;
        const long most = shown->pace.silent < room ? shown->pace.silent : room;
        if (!steady_keep_silent(frame, nodes, form, most, &silence, lanes)) return false;
        shown->count = silence.count;
        shown->size = 0;
        shown->pace.first = silence.moved[0];
        shown->pace.silent = silence.count + STEADY_MORE(nodes->unknowns);
        if (silence.rests) return true;
    }
    tvi_passes_begin(&passes);
    passes.slowest = shown->pace.slowest;
    passes.early = shown->early;
    while (verdict == TVI_PASSES_GO_ON && passes.count < rule->most) {
        double moved;
        const bool was_made = passes.count < silence.count;
        if (was_made) moved = silence.moved[passes.count];
        else if (!few && !steady_begin(nodes, form, lanes)) return false;
        else if (!steady_end(frame, nodes, form, &moved, lanes)) return false;
        if (!(moved < INFINITY)) return false;
        verdict = tvi_passes_judge(&passes, rule, moved);
        if (passes.count == 1) shown->pace.first = moved;
        if (few && !was_made && verdict == TVI_PASSES_GO_ON && !steady_begin(nodes, form, lanes)) return false;
    }
    shown->count = passes.count > silence.count ? passes.count : silence.count;
    shown->size = passes.size;
    shown->pace.slowest = passes.slowest;
    shown->pace.silent = passes.size == 0 && rule->exactly == 0 ? passes.count + STEADY_MORE(nodes->unknowns) : 0;
    return verdict == TVI_PASSES_MAY_END;
}

#endif
