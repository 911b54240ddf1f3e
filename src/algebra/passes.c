/* passes.c - see passes.h. */
#include "algebra/passes.h"

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

tvi_passes_rule tvi_passes_rule_asked(const tvi_passes_rule *rule, const tvi_options *options, double tolerance)
{
    tvi_passes_rule asked = *rule;
    if (options->max_passes > 0) asked.most = options->max_passes;
    if (options->passes > 0) asked.most = asked.exactly = options->passes;
    if (tolerance > 0) {
        asked.goal = tolerance;
        asked.far = 0;
    }
    return asked;
}

/* ---- What the next correction should be -------------------------------------------------------------------------- */

static bool contracts(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->size <= rule->stuck * passes->before;
}

/* Passes that gain little where the first correction was small make later ones leave more than the first one did. The
 * slack that one correction shows is believed when the next one contracts again: one that was roundoff does not. */
static void learn_slack(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const bool shows = contracts(passes, rule);
    if (shows) passes->slack = smaller(larger(passes->slack, passes->seen), rule->most_slack);
    const double slack = larger(passes->slack, passes->seen) * passes->size / passes->next;
    passes->seen = shows && passes->size > rule->slack_above ? slack : 0;
}

static bool is_known(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    return passes->slowest > 0 && passes->slowest < rule->contraction;
}

/* A correction before that is larger than 1 counts as 1: it says more of the unknown's size than of the passes. */
static void show_part(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const double part = passes->size / smaller(passes->before, 1);
    passes->slowest = rule->memory > 1 ? larger(part, passes->part) : part;
    passes->part = part;
}

static void expect(tvi_passes *passes, const tvi_passes_rule *rule)
{
    const double noise = passes->slowest > 0 ? rule->noise : rule->first_noise;
    const bool is_far = passes->count == 1 || passes->size > rule->far;
    if (!is_far && passes->size > noise) show_part(passes, rule);
    const double part = is_known(passes, rule) ? passes->slowest : 1;
    passes->shown = is_far || passes->size > noise ? passes->size : smaller(passes->size, part * passes->shown);
    passes->next = is_far ? passes->size : larger(passes->slack, passes->seen) * part * passes->shown;
}

/* ---- The verdict ------------------------------------------------------------------------------------------------- */

static bool is_stuck(const tvi_passes *passes, const tvi_passes_rule *rule)
{
    if (passes->count <= rule->patience || contracts(passes, rule)) return false;
    const bool has_two = rule->turns > 1 && passes->count > 2;
    return !has_two || passes->size > rule->stuck * rule->stuck * passes->earlier;
}

/* The last bits go to and fro, and nothing else moves. */
static bool is_cycle(const tvi_passes *passes)
{
    return passes->size == passes->before && passes->size == passes->earlier;
}

tvi_passes_verdict tvi_passes_judge(tvi_passes *passes, const tvi_passes_rule *rule, double size)
{
    const bool was_enough = passes->next <= rule->goal;
    passes->earlier = passes->before;
    passes->before = passes->size;
    passes->size = size;
    passes->count++;
    if (rule->exactly > 0) return passes->count == rule->exactly ? TVI_PASSES_MAY_END : TVI_PASSES_GO_ON;
    if (rule->most_slack > 0 && passes->count > 1) learn_slack(passes, rule);
    expect(passes, rule);
    const bool is_enough = passes->next <= rule->goal && (was_enough || !passes->checks);
    if (is_enough || size <= passes->roundoff) return TVI_PASSES_MAY_END;
    if (!is_stuck(passes, rule)) return TVI_PASSES_GO_ON;
    if (size > rule->roundoff) return TVI_PASSES_STUCK;
    return is_known(passes, rule) && !is_cycle(passes) ? TVI_PASSES_GO_ON : TVI_PASSES_MAY_END;
}
