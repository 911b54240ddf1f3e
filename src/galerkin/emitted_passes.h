/* emitted_passes.h - the passes of whole steps of generated code (emitted_steps.h), by the form of the field. */
#ifndef TVI_SRC_GALERKIN_EMITTED_PASSES_H
#define TVI_SRC_GALERKIN_EMITTED_PASSES_H

#include "galerkin/folded.h"
#include "galerkin/hamiltonian_passes.h"
#include "galerkin/lagrangian_passes.h"
#include "galerkin/steady.h"

/* Sets the impulses at the nodes, or, where they are not weighed, the drives; false outside the field's domain. */
typedef bool steady_field(const galerkin_nodes *nodes, bool weighs, int lanes);

/* What a pass is made by: the field, or passes of their own. The rule is of constants where the registers are not the
 * field's. */
typedef struct {
    int rows; /* of the nodes' x, that it begins with */
    const tvi_passes_rule *rule;
    steady_field *drive;
    bool folds; /* passes that cannot be the last are folded.h's */
    galerkin_sweep *sweep;
    lagrangian_passes *lagrangian;
    hamiltonian_passes *hamiltonian;
} steady_form;

/* A pass in two parts, between which its impulses are stored. Many unknowns that stayed in registers until the next one
 * would take those that it needs. */
JET_INLINE bool steady_drive(const galerkin_nodes *nodes, const steady_form *form, bool weighs, int lanes)
{
    double *x = nodes->x;
    if (!form->drive) return true;
    if (nodes->unknowns > GALERKIN_FEW) LEAVE_REGISTERS(x);
    return form->drive(nodes, weighs, lanes);
}
JET_INLINE bool steady_begin(const galerkin_nodes *nodes, const steady_form *form, int lanes)
{
    return steady_drive(nodes, form, true, lanes);
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
        few_vector squares;
        follow_few(nodes, frame->matrix, &squares);
        *moved = sum_of_few(squares);
    } else {
        *moved = follow_to(nodes, frame->matrix, NULL, NULL, lanes);
    }
    return true;
}

/* Passes that are not judged: what those moved that were measured, and whether the last one moved nothing. */
enum { STEADY_SILENT = 24 };
typedef struct {
    int count;
    bool rests;
    double moved[STEADY_SILENT];
} steady_silence;

/* Of a step so many passes behind the first one are not even measured, as none can be its last. Of those that are
 * measured again, the second one shows whether that may be one more of the next step, as it has moved by more than
 * roundoff, and the first one whether it has to be one fewer, as it may have put right no more than how those that are
 * folded are rounded. */
enum { STEADY_BLIND = 16 };
#define STEADY_NEAR 0x1p-4
JET_INLINE bool steady_is_blind(int pass, long blind) { return 0 < pass && pass <= blind; }
/* The first one that is judged: that behind these. */
JET_INLINE int steady_first(long blind) { return blind > 0 ? (int)blind + 1 : 0; }

JET_INLINE long steady_blind(const tvi_passes_rule *rule, long blind, const steady_silence *silence)
{
    const int first = steady_first(blind), second = first + 1;
    if (silence->count <= first || silence->moved[first] <= STEADY_NEAR * rule->noise) return blind > 1 ? blind - 1 : 0;
    const bool may_be_more = silence->count > second && silence->moved[second] > rule->noise;
    return may_be_more && blind < STEADY_BLIND ? blind + 1 : blind;
}

JET_INLINE bool steady_may_be_silent(const steady_form *form)
{
    const tvi_passes_rule *rule = form->rule;
    return form->drive && rule->exactly == 0 && rule->goal <= rule->noise;
}
JET_INLINE long steady_blind_now(const steady_form *form, const galerkin_trial *last)
{
    return steady_may_be_silent(form) ? last->pace.blind : 0;
}

/* The first pass of a step begins, of a few unknowns; one that is folded is made. */
JET_INLINE bool steady_begin_first(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                                   const galerkin_trial *last, galerkin_folding *folding, int lanes)
{
    if (nodes->unknowns > GALERKIN_FEW) return true;
    if (!form->folds) return steady_begin(nodes, form, lanes);
    if (!steady_drive(nodes, form, false, lanes)) return false;
    if (steady_blind_now(form, last) < 1) {
        weigh_drives(nodes);
        return true;
    }
    const int blocks = nodes->unknowns * OF_EIGHT;
    for (int k = 0; k < blocks; k++) folding->change[k] = BLOCK_OF(few_vector, nodes->x, k);
    follow_folded(nodes, frame->folded, folding->origin);
    for (int k = 0; k < blocks; k++) folding->change[k] -= BLOCK_OF(few_vector, nodes->x, k);
    return true;
}

/* So are the other passes that are folded, and the one behind them begins. */
JET_INLINE bool steady_begin_others(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                                    const galerkin_trial *last, const galerkin_folding *folding, int lanes)
{
    const long blind = steady_blind_now(form, last);
    if (!form->folds || blind < 1) return true;
    for (long left = blind; left > 0; left--) {
        if (!steady_drive(nodes, form, false, lanes)) return false;
        follow_folded(nodes, frame->folded, folding->origin);
    }
    return steady_begin(nodes, form, lanes);
}

/* A few unknowns stay in registers from the end of a pass to the beginning of the next one, which follows directly: the
 * first one has begun. Sums of squares are had where they are needed. */
JET_INLINE bool steady_keep_silent(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                                   long blind, long most, const galerkin_folding *folding, steady_silence *of,
                                   int lanes)
{
    const bool few = nodes->unknowns <= GALERKIN_FEW;
    const int first = steady_first(blind);
    few_vector squares[STEADY_SILENT];
    of->count = 0;
    of->rests = false;
    if (form->folds) {
        of->count = first;
        if (blind > 0) of->moved[0] = squares_of(nodes, folding->change);
    }
    while (of->count < most) {
        const int now = of->count++;
        if (!few && !steady_begin(nodes, form, lanes)) return false;
        if (!ARE_EIGHT(lanes)) {
            double moved;
            (void)steady_end(frame, nodes, form, &moved, lanes);
            if (!steady_is_blind(now, blind)) of->moved[now] = moved, of->rests = moved == 0;
        } else {
            few_vector moved;
            if (ARE_FEW(nodes, lanes)) follow_few(nodes, frame->matrix, &moved);
            else (void)follow_to(nodes, frame->matrix, NULL, (double *)&moved, lanes);
            /* folded passes were all that were blind, which the compiler does not see by itself */
            if (form->folds || !steady_is_blind(now, blind)) squares[now] = moved, of->rests = are_zero(moved);
        }
        if (of->rests) break;
        if (few && !steady_begin(nodes, form, lanes)) return false;
    }
    if (!ARE_EIGHT(lanes)) return true;
    const int end = of->rests && of->count > first + 2 ? first + 2 : of->count;
    if (!form->folds || blind < 1) of->moved[0] = sum_of_few(squares[0]);
    for (int i = first; i < end; i++) of->moved[i] = sum_of_few(squares[i]);
    return true;
}

/* Steps end most often as nothing moves any more. No processor foresees with which pass, and a judge of each of them
 * makes it wait longer for what it took wrongly. So, if the last step ended like that, only this is asked of so many
 * passes as it took, and of some more: few unknowns rest nearly always, many often do not. If they do not rest, all
 * that were measured are judged. */
#define STEADY_MORE(unknowns) ((unknowns) <= GALERKIN_FEWEST ? 3 : 1)
JET_INLINE bool steady_passes(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                              const galerkin_folding *folding, galerkin_trial *shown, int lanes)
{
    const bool few = nodes->unknowns <= GALERKIN_FEW;
    const tvi_passes_rule *rule = form->rule;
    const bool may_be_silent = steady_may_be_silent(form);
    const long blind = steady_blind_now(form, shown);
    const int first = steady_first(blind);
    tvi_passes passes;
    tvi_passes_verdict verdict = TVI_PASSES_GO_ON;
    steady_silence silence;
    silence.count = 0;
    if (may_be_silent) {
        const long room = rule->most < STEADY_SILENT ? rule->most : STEADY_SILENT;
        const long wanted = shown->pace.silent > first + 2 ? shown->pace.silent : first + 2;
        if (!steady_keep_silent(frame, nodes, form, blind, wanted < room ? wanted : room, folding, &silence, lanes))
            return false;
        shown->count = silence.count;
        shown->size = 0;
        shown->pace.first = silence.moved[0];
        shown->pace.silent = silence.count + STEADY_MORE(nodes->unknowns);
        shown->pace.blind = steady_blind(rule, blind, &silence);
        if (silence.rests) return true;
    }
    tvi_passes_begin(&passes, shown->pace.slowest);
    while (verdict == TVI_PASSES_GO_ON && first + passes.count < rule->most) {
        double moved;
        const int now = first + passes.count;
        const bool was_made = now < silence.count;
        if (was_made) moved = silence.moved[now];
        else if (!few && !steady_begin(nodes, form, lanes)) return false;
        else if (!steady_end(frame, nodes, form, &moved, lanes)) return false;
        if (!(moved < INFINITY)) return false;
        verdict = tvi_passes_judge(&passes, rule, moved);
        if (now == 0) shown->pace.first = moved;
        if (was_made || verdict != TVI_PASSES_GO_ON) continue;
        if (few && !steady_begin(nodes, form, lanes)) return false;
    }
    const int made = first + passes.count;
    shown->count = made > silence.count ? made : silence.count;
    shown->size = passes.size;
    shown->pace.slowest = passes.slowest;
    shown->pace.silent = passes.size == 0 ? made + STEADY_MORE(nodes->unknowns) : 0;
    return verdict == TVI_PASSES_MAY_END;
}

#endif
