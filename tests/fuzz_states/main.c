/* main.c - Loads texts of states that were changed and given a right last word, or were cut short, into integrators and
 * members of ensembles, and runs from those that are accepted: nothing is read outside of a text, whatever it has.
 * `fuzz_states SEED COUNT` tries others; make check-sanitizers tries a million. */
#include "problems/problems.h"
#include "problems/random.h"
#include "problems/texts.h"
#include "tape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { STATES = 20000, MEMBERS = 9, STEPS = 40, N = 3, LONGEST = 60 /* s, for one system and method */ };

static void insist(bool good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_states: %s\n", what);
    abort();
}

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_add(jet_dot(q, q, N), 0.1), -0.5));
}

/* Stiff springs in a row. */
static jet chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_sqr(q[0]), jet_mul(50, jet_add(jet_sqr(jet_sub(q[1], q[0])), jet_sqr(jet_sub(q[2], q[1])))));
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet kinetic = jet_mul(jet_add(1, jet_sqr(q[0])), jet_dot(p, p, N));
    return jet_add(jet_mul(0.5, kinetic), jet_mul(jet_parameter(q[0], 1, 0.3), jet_sin(q[1])));
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(jet_add(1, jet_mul(0.25, jet_sin(q[0]))), jet_dot(v, v, N)), jet_dot(q, q, N));
}

static tvi_status make_potential(tvi_system **out) { return tvi_system_potential(out, N, NULL, potential, NULL); }
static tvi_status make_chain(tvi_system **out) { return tvi_system_potential(out, N, NULL, chain, NULL); }
static tvi_status make_hamiltonian(tvi_system **out) { return tvi_system_hamiltonian(out, N, hamiltonian, NULL); }
static tvi_status make_lagrangian(tvi_system **out) { return tvi_system_lagrangian(out, N, lagrangian, NULL); }
static tvi_status make_rescaled(tvi_system **out)
{
    static tvi_system *base; /* which lives as long as the program */
    const tvi_status status = base ? TVI_OK : make_potential(&base);
    return status == TVI_OK ? tvi_system_rescaled(out, base, NULL, NULL) : status;
}

static tvi_status (*const systems[])(tvi_system **) = {make_potential, make_chain, make_hamiltonian, make_lagrangian,
                                                       make_rescaled};
static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16}, {"galerkin", 8}, {"midpoint", 8},       {"taylor", 10},
               {"poincare", 4},  {"tvi", 4},      {"stormer-verlet", 2}, {"svhd", 2}};
enum { SYSTEMS = sizeof systems / sizeof *systems, METHODS = sizeof methods / sizeof *methods };

/* ---- Changes ----------------------------------------------------------------------------------------------------- */

static uint64_t below(uint64_t *bits, uint64_t count) { return (uint64_t)(number_of(bits) * (double)count); }

/* A number of eight bytes that a state may hold by accident or by intent. */
static uint64_t word_of(uint64_t *bits)
{
    const double reals[] = {NAN, INFINITY, -INFINITY, 1e308, 5e-324, -1, 0};
    uint64_t word = below(bits, 2000) - 1000;
    const uint64_t kind = below(bits, 4);
    if (kind == 0) memcpy(&word, &reals[below(bits, sizeof reals / sizeof *reals)], sizeof word);
    if (kind == 1) word = (uint64_t)INT64_MAX - below(bits, 3);
    if (kind == 2) word = below(bits, UINT64_C(1) << 53) << 11;
    return word;
}

/* Writes a word that stands in the place of another one. If the change is mild, a number becomes another number, so
 * that many texts are read. Returns its length. */
static size_t change_word(uint64_t *bits, bool is_mild, const char *word, size_t length, char *changed)
{
    static const char *const others[] = {"+0x1.0000000000000p+1023",
                                         "-0x1.fffffffffffffp+1023",
                                         "+0x0.0000000000000p+0000",
                                         "+0x0.0000000000001p-1022",
                                         "+0x1.0000000000000p+1024",
                                         "0x1.p+0",
                                         "0x1p+",
                                         "nan",
                                         "-inf",
                                         "1.5",
                                         "0x2p+0",
                                         "e",
                                         "q",
                                         "end",
                                         "tvi",
                                         "h",
                                         "stop",
                                         "9223372036854775807",
                                         "100000000000000000",
                                         "-1",
                                         "1",
                                         "0x1.00000000000000000000000000000000000p+0"};
    enum { NUMBERS = 4 };
    const bool is_double = length > 3 && strncmp(word + 1, "0x", 2) == 0, is_open = !is_mild || is_double;
    if (length == 16 && !is_double && below(bits, 8) > 0)
        return (size_t)sprintf(changed, "%016llx", (unsigned long long)word_of(bits));
    if (!is_open) return (size_t)sprintf(changed, "%.*s", (int)length, word);
    const char *const other = others[below(bits, is_mild ? NUMBERS : sizeof others / sizeof *others)];
    const size_t count = (size_t)sprintf(changed, "%s", other);
    if (!is_mild && below(bits, 3) == 0) changed[below(bits, count)] = (char)below(bits, 256);
    return count;
}

static uint64_t count_words(const char *text)
{
    uint64_t count = 0;
    for (; *text; text++) count += *text == ' ' || *text == '\n';
    return count;
}

/* Changes some words of a text, half of them in its portable part, and gives it the right last word. Returns the new
 * size, of at most LONGEST_TEXT. */
enum { LONGEST_TEXT = 1 << 18, MOST_CHANGES = 3, PORTABLE = 30 };
static size_t forge_text(uint64_t *bits, const char *text, char forged[LONGEST_TEXT])
{
    const uint64_t words = count_words(text) - 1;
    const bool is_mild = below(bits, 2) == 0;
    uint64_t hash = JET_HASH_OF_NOTHING, places[MOST_CHANGES], changes = 1 + below(bits, MOST_CHANGES);
    for (uint64_t k = 0; k < changes; k++) places[k] = below(bits, below(bits, 2) ? words : PORTABLE);
    size_t size = 0;
    for (uint64_t i = 0; i < words; i++) {
        const size_t length = strcspn(text, " \n");
        bool is_changed = false;
        for (uint64_t k = 0; k < changes; k++) is_changed = is_changed || places[k] == i;
        const size_t count = is_changed ? change_word(bits, is_mild, text, length, forged + size)
                                        : (memcpy(forged + size, text, length), length);
        hash = jet_continue_hash(jet_continue_hash(hash, forged + size, count), " ", 1);
        size += count;
        forged[size++] = text[length];
        text += length + 1;
    }
    return size + (size_t)sprintf(forged + size, "%016llx\n", (unsigned long long)hash);
}

/* ---- Trials ------------------------------------------------------------------------------------------------------ */

/* How many states were loaded, and how many refused. */
typedef struct {
    long loaded, refused;
} counts;

static void start(double t[], double q[], double p[], int members)
{
    for (int m = 0; m < members; m++) t[m] = 0;
    for (int k = 0; k < N * members; k++) {
        q[k] = 0.9 - 0.11 * (k / members) + 0.01 * (k % members);
        p[k] = 0.3 + 0.07 * (k / members);
    }
}

static bool is_finite(const double x[], int count)
{
    for (int k = 0; k < count; k++)
        if (!isfinite(x[k])) return false;
    return true;
}

static void *copy_of(const void *bytes, size_t size)
{
    void *copy = malloc(size); /* exactly: what is read behind it is seen */
    insist(copy != NULL, "no memory");
    return memcpy(copy, bytes, size);
}

static void run_integrator(tvi_integrator *it)
{
    double t, q[N], p[N];
    if (tvi_state_last(it, &t, q, p) != TVI_OK) return;
    for (int k = 0; k < 3; k++) {
        const tvi_status status = tvi_step(it, 0.05, &t, q, p);
        insist(status < TVI_STATUS_COUNT, "a step has no such status");
        insist(status != TVI_OK || (is_finite(q, N) && is_finite(p, N)), "a step is TVI_OK, and not finite");
        if (status != TVI_OK) return;
    }
}

/* A forged text in memory of its size. One of four is cut short. It is NULL if it is as it was. */
static char *make_trial(uint64_t *bits, const char *text, size_t *size, bool *is_cut)
{
    static char forged[LONGEST_TEXT];
    *size = forge_text(bits, text, forged);
    *is_cut = below(bits, 4) == 0;
    if (*is_cut) *size = (size_t)below(bits, *size);
    else if (*size == strlen(text) && memcmp(forged, text, *size) == 0) return NULL;
    int n;
    double t;
    char *copy = copy_of(forged, *size);
    const tvi_status seen = tvi_state_peek(copy, *size, &n, &t, NULL, NULL);
    insist(seen == TVI_OK || seen == TVI_EINVAL, "tvi_state_peek has no such status");
    return copy;
}

/* What is cut short counts as neither loaded nor refused. What was forged is counted. */
static void try_integrator(uint64_t *bits, const tvi_system *system, const tvi_options *options, long count,
                           counts *sum)
{
    tvi_integrator *it;
    double t, q[N], p[N];
    if (tvi_integrator_create(&it, system, options) != TVI_OK) return;
    start(&t, q, p, 1);
    for (int k = 0; k < STEPS; k++) insist(tvi_step(it, 0.05, &t, q, p) == TVI_OK, tvi_last_error());
    char *text = text_of_state(it, t, q, p);
    for (long k = 0; k < count; k++) {
        size_t size;
        bool is_cut;
        char *trial = make_trial(bits, text, &size, &is_cut);
        if (!trial) continue;
        const tvi_status status = tvi_state_from_text(it, trial, size, &t, q, p);
        insist(status < TVI_STATUS_COUNT && is_finite(q, N) && is_finite(p, N), "a text is read as no state");
        if (status == TVI_OK) run_integrator(it);
        if (!is_cut) *(status == TVI_OK ? &sum->loaded : &sum->refused) += 1;
        free(trial);
    }
    insist(tvi_state_from_text(it, text, strlen(text), &t, q, p) == TVI_OK, tvi_last_error());
    free(text);
    tvi_integrator_free(it);
}

static void run_ensemble(tvi_ensemble *e)
{
    double t[MEMBERS], q[N * MEMBERS], p[N * MEMBERS];
    tvi_status status[MEMBERS];
    if (tvi_ensemble_last(e, t, q, p, status) != TVI_OK) return;
    insist(tvi_ensemble_integrate(e, 0.05, 2, t, q, p, status, NULL, NULL) == TVI_OK, tvi_last_error());
    for (int m = 0; m < MEMBERS; m++) {
        insist(status[m] < TVI_STATUS_COUNT, "a member has no such status");
        for (int k = m; k < N * MEMBERS; k += MEMBERS)
            insist(status[m] != TVI_OK || (isfinite(q[k]) && isfinite(p[k])), "a member is TVI_OK, and not finite");
    }
}

static void try_ensemble(uint64_t *bits, const tvi_system *system, const tvi_options *options, long count, counts *sum)
{
    tvi_ensemble *e;
    double t[MEMBERS], q[N * MEMBERS], p[N * MEMBERS];
    tvi_status status[MEMBERS];
    if (tvi_ensemble_create(&e, system, options, MEMBERS, 1) != TVI_OK) return;
    start(t, q, p, MEMBERS);
    insist(tvi_ensemble_integrate(e, 0.05, STEPS, t, q, p, status, NULL, NULL) == TVI_OK, tvi_last_error());
    char *text = text_of_member(e, 1, t, q, p);
    for (long k = 0; k < count; k++) {
        size_t size;
        bool is_cut;
        char *trial = make_trial(bits, text, &size, &is_cut);
        if (!trial) continue;
        const int m = (int)below(bits, MEMBERS);
        const bool is_loaded = tvi_ensemble_member_from_text(e, m, trial, size, t, q, p) == TVI_OK;
        if (is_loaded) run_ensemble(e);
        if (!is_cut) *(is_loaded ? &sum->loaded : &sum->refused) += 1;
        free(trial);
    }
    for (int m = 0; m < MEMBERS; m++)
        insist(tvi_ensemble_member_from_text(e, m, text, strlen(text), t, q, p) == TVI_OK, tvi_last_error());
    free(text);
    tvi_ensemble_free(e);
}

/* Nine in ten are states of integrators. */
static counts try_all(uint64_t seed, long count)
{
    const long each = count / (SYSTEMS * METHODS) + 1;
    counts sum = {0, 0};
    for (int s = 0; s < SYSTEMS; s++)
        for (int k = 0; k < METHODS; k++) {
            tvi_system *system;
            tvi_options options;
            uint64_t bits = seed * 1000003 + (uint64_t)(s * METHODS + k);
            insist(systems[s](&system) == TVI_OK, tvi_last_error());
            if (tvi_options_named(methods[k].name, methods[k].order, &options) == TVI_OK) {
                alarm(LONGEST * (unsigned)(1 + each / 2000)); /* a hang ends the test */
                try_integrator(&bits, system, &options, each - each / 10, &sum);
                try_ensemble(&bits, system, &options, each / 10, &sum);
            }
            tvi_system_free(system);
        }
    return sum;
}

int main(int argc, char *argv[])
{
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    const long count = argc > 2 ? strtol(argv[2], NULL, 10) : STATES;
    const counts sum = try_all(seed, count);
    printf("%ld forged texts: %ld read, %ld refused\n", sum.loaded + sum.refused, sum.loaded, sum.refused);
    /* else it tried nothing */
    return sum.loaded < count / 8 || sum.refused < count / 6;
}
