/* state.c - Writes the state of an integrator as text, and loads it, so that a run goes on as if it had not been
 * interrupted (tvi_state_to_text, tvi_state_from_text). ensemble.c calls it for members. An example of a text is
 *
 *     tvi state 2
 *     n 1
 *     parameters 1
 *     from_step 1
 *     value +0x1.8000000000000p+0000
 *     t +0x1.9000000000000p+0005 -0x1.0000000000000p-0050
 *     q -0x1.5f34d6a161e4fp-0001 +0x0.0000000000000p+0000
 *     p +0x1.4000000000000p-0001 +0x0.0000000000000p+0000
 *     stop 0000000000000000 0000000000000000 ...
 *     history 51b0c7b3f1a3d9c4 72
 *     h 0000000000000032 00000000000000c8 ...
 *     end 9ae16a3b2f90404f
 *
 * Every version, machine, instruction set and method reads the part up to the stop. Numbers are those of %+.13a, with
 * a point in every locale and four digits of the exponent. A state that a step returned (from_step 1) has low-order
 * parts, the second numbers of its rows. A rescaled system has a row for e, the constant -H at the start of the run,
 * after p; a text may lack it. The words of the stop are those of tvi_event_stop.
 *
 * The history has the counts of steps and everything that a step leaves to the next one (algebra/arena.h). After its
 * label stand the hash of what its bits depend on, and the number of its words. An integrator with another hash skips
 * them. Any white space may separate words, since other programs may change the ends of lines. The last word is the
 * FNV-1a hash of all words before it, each followed by a blank. Format 1 has neither from_step, nor a stop, nor a
 * history, and writes its numbers by %a. */
#include "integrator/integrator.h"
#include "tape.h"
#include "algebra/sizes.h"
#include "compiled/compiled.h"
#include "method/fingerprint.h"
#include "system/refuse.h"

#include <float.h>
#include <stdlib.h>

/* LONGEST_WORD is the number of characters of the longest word; MANTISSA is the number of hexadecimal digits of a
 * mantissa, DIGITS the largest number of digits of a count. A row of words has ROW of them. */
enum { LONGEST_WORD = 31, MANTISSA = 13, DIGITS = 18, ROW = 4, FORMAT = 2 };
/* The first COUNTS words of a history are the members of tvi_stats before `bytes`, the first STEP_COUNTS of them
 * integers. */
enum { COUNTS = offsetof(tvi_stats, bytes) / sizeof(uint64_t), STEP_COUNTS = offsetof(tvi_stats, residual) / 8 };

/* A low-order part of a state beside its largest number: half of the digits of a double. */
#define LARGEST_LOW_PART 0x1p-26

static const char NO_STATE[] = "the text is no state", NO_MEMORY[] = "out of memory",
                  DAMAGED[] = "the text of the state is damaged or cut short", BLANKS[] = " \t\r\n";

/* The contents of a text, and what they are compared with when it is read. */
typedef struct {
    int64_t n, parameter_count; /* if n is not 0, the text that is read has to have the same numbers */
    int64_t is_from_step;       /* 1 if a step returned the state, otherwise 0 */
    bool has_e;                 /* true if the text has the e of K = g (H + e) */
    /* The hash of what the bits of the integrator's history depend on, and its number of words. Both are 0 if there is
     * no integrator, and then all histories are skipped. */
    uint64_t own_hash;
    int64_t own_words;
    bool is_history_own, is_history_dropped; /* what becomes of the history that was read */
    double *state;                           /* [2n + 2][2] t, q, p and e, each followed by its low-order part */
    double *parameters;                      /* [parameter_count] */
    uint64_t *stop, *history;                /* [count_stop_words(n)], [own_words] */
} state_page;

static size_t count_stop_words(int64_t n) { return tvi_stop_bytes((int)n) / sizeof(uint64_t); }

/* Allocates all arrays in one block, which the caller frees by free(page->state). */
static bool allocate_page(state_page *page)
{
    const size_t pairs = 4 * ((size_t)page->n + 1), parameters = (size_t)page->parameter_count;
    const size_t words = count_stop_words(page->n) + (size_t)page->own_words;
    page->state = calloc(pairs + parameters + words, sizeof *page->state);
    if (!page->state) return false;
    page->parameters = page->state + pairs;
    page->stop = (uint64_t *)(page->parameters + parameters);
    page->history = page->stop + count_stop_words(page->n);
    return true;
}

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

/* The kinds of numbers, all of which have eight bytes: counts in decimal, words in hexadecimal, and doubles. */
typedef enum { COUNT, WORD, DOUBLE } number_kind;

/* Writes a number in the given base, with at least least_digits digits. Returns the address of the end of the text. */
static char *write_digits(char *text, uint64_t number, unsigned base, int least_digits)
{
    char digit[20];
    int count = 0;
    for (; number > 0 || count < least_digits; number /= base) digit[count++] = "0123456789abcdef"[number % base];
    while (count > 0) *text++ = digit[--count];
    *text = '\0';
    return text;
}

/* Writes a number. A double has its sign, 0x, the bits of its mantissa in hexadecimal, and its binary exponent;
 * denormal numbers begin with 0x0 and have the exponent -1022. */
static void write_number(char *text, number_kind kind, uint64_t bits)
{
    const uint64_t mantissa = bits << 12 >> 12;
    const int biased = (int)(bits >> 52 & 0x7ff), exponent = biased > 0 ? biased - 1023 : mantissa > 0 ? -1022 : 0;
    if (kind == DOUBLE) {
        *text++ = bits >> 63 ? '-' : '+';
        *text++ = '0', *text++ = 'x', *text++ = biased > 0 ? '1' : '0', *text++ = '.';
        text = write_digits(text, mantissa, 16, MANTISSA);
        *text++ = 'p', *text++ = exponent < 0 ? '-' : '+';
        (void)write_digits(text, (uint64_t)abs(exponent), 10, 4);
    } else {
        (void)write_digits(text, bits, kind == WORD ? 16 : 10, kind == WORD ? 16 : 1);
    }
}

/* Reads up to most_digits digits in the given base from *text on, and moves *text past them. Sets *count to the
 * number of digits that were read, and returns the number that they form. */
static uint64_t read_digits(const char **text, unsigned base, int most_digits, int *count)
{
    uint64_t number = 0;
    for (*count = 0; *count < most_digits && **text; ++*count, ++*text) {
        const char *const digits = "0123456789abcdef", *digit = memchr(digits, **text, base);
        if (!digit) break;
        number = number * base + (uint64_t)(digit - digits);
    }
    return number;
}

/* Reads a double. Returns whether the text is a finite number as %a writes it. Format 1 has no plus signs before
 * numbers. */
static bool read_double(const char *text, int64_t format, uint64_t *bits)
{
    int count = 1;
    const bool is_negative = *text == '-';
    text += is_negative || (format > 1 && *text == '+');
    const bool is_normal = strncmp(text, "0x1", 3) == 0;
    if (!is_normal && strncmp(text, "0x0", 3) != 0) return false;
    text += 3;
    const uint64_t fraction = *text == '.' ? text++, read_digits(&text, 16, MANTISSA, &count) : 0;
    const uint64_t mantissa = fraction > 0 ? fraction << 4 * (MANTISSA - count) : 0;
    if (count == 0 || text[0] != 'p' || (text[1] != '+' && text[1] != '-')) return false;
    const int sign = text[1] == '-' ? -1 : 1;
    text += 2;
    const int exponent = sign * (int)read_digits(&text, 10, 4, &count);
    *bits = (uint64_t)is_negative << 63 | (uint64_t)(is_normal ? exponent + 1023 : 0) << 52 | mantissa;
    const bool is_one = is_normal ? exponent >= -1022 && exponent <= 1023 : mantissa == 0 || exponent == -1022;
    return count > 0 && !*text && is_one;
}

static bool read_number(const char *text, number_kind kind, int64_t format, uint64_t *bits)
{
    int count;
    if (kind == DOUBLE) return read_double(text, format, bits);
    *bits = read_digits(&text, kind == WORD ? 16 : 10, kind == WORD ? 16 : DIGITS, &count);
    return !*text && (kind == WORD ? count == 16 : count > 0);
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

/* A text that is being read, or written, or only measured to find its length. */
typedef struct {
    const char *input; /* the rest of the text that is read, which ends with 0; NULL if a text is written or measured */
    char *output;      /* memory for the text that is written; NULL if it is only measured */
    size_t length;     /* the number of characters that were written or measured */
    uint64_t hash;     /* FNV-1a of the words so far, each followed by a blank */
    int64_t format;
    const char *fault; /* describes the first error in the input; NULL if there is none */
} text_stream;

static void record_fault(text_stream *stream, bool has_fault, const char *fault)
{
    if (has_fault && !stream->fault) stream->fault = fault;
}

/* Reads the next word of the input into `word`, or writes `word` after the separator. Adds the word to the hash. A
 * longer word than LONGEST_WORD is cut, and matches nothing that is expected. */
static void transfer_word(text_stream *stream, char separator, char word[LONGEST_WORD + 1])
{
    if (stream->input) {
        stream->input += strspn(stream->input, BLANKS);
        size_t length = strcspn(stream->input, BLANKS);
        if (length > LONGEST_WORD) length = LONGEST_WORD;
        memcpy(word, stream->input, length);
        word[length] = '\0';
        stream->input += length;
    } else {
        const size_t length = strlen(word), gap = stream->length > 0;
        if (stream->output && gap) stream->output[stream->length] = separator;
        if (stream->output) memcpy(stream->output + stream->length + gap, word, length);
        stream->length += gap + length;
    }
    stream->hash = jet_continue_hash(jet_continue_hash(stream->hash, word, strlen(word)), " ", 1);
}

static void transfer_fixed_word(text_stream *stream, char separator, const char *wanted, const char *fault)
{
    char word[LONGEST_WORD + 1];
    memcpy(word, wanted, strlen(wanted) + 1);
    transfer_word(stream, separator, word);
    record_fault(stream, strcmp(word, wanted) != 0, fault);
}

/* Transfers a number. While a text is read, the word that write_number has written is replaced by that of the input. */
static void transfer_number(text_stream *stream, number_kind kind, void *number)
{
    char word[LONGEST_WORD + 1];
    uint64_t bits;
    memcpy(&bits, number, sizeof bits);
    write_number(word, kind, bits);
    transfer_word(stream, ' ', word);
    record_fault(stream, !read_number(word, kind, stream->format, &bits), DAMAGED);
    if (stream->input) memcpy(number, &bits, sizeof bits);
}

/* Transfers `count` numbers in rows of `columns`. If `numbers` is NULL, the numbers of the input are skipped. */
static void transfer_rows(text_stream *stream, const char *label, number_kind kind, int64_t count, int columns,
                          void *numbers)
{
    uint64_t skipped = 0;
    for (int64_t i = 0; i < count && !stream->fault; i++) {
        if (i % columns == 0) transfer_fixed_word(stream, '\n', label, DAMAGED);
        transfer_number(stream, kind, numbers ? (uint64_t *)numbers + i : &skipped);
    }
}

/* ---- The text ---------------------------------------------------------------------------------------------------- */

/* Transfers the words before the first number, and allocates a page that is read. */
static void transfer_header(text_stream *stream, state_page *page)
{
    const int64_t n = page->n, parameter_count = page->parameter_count;
    transfer_fixed_word(stream, ' ', "tvi", NO_STATE);
    transfer_fixed_word(stream, ' ', "state", NO_STATE);
    transfer_number(stream, COUNT, &stream->format);
    record_fault(stream, stream->format < 1 || stream->format > FORMAT,
                 "the text is of a format that this version does not know");
    transfer_rows(stream, "n", COUNT, 1, 1, &page->n);
    record_fault(stream, n > 0 && page->n != n, "the text is of a system of another dimension");
    transfer_rows(stream, "parameters", COUNT, 1, 1, &page->parameter_count);
    record_fault(stream, n > 0 && page->parameter_count != parameter_count,
                 "the text is of a system with other parameters");
    transfer_rows(stream, "from_step", COUNT, stream->format > 1, 1, &page->is_from_step);
    if (!stream->input) return;
    record_fault(stream,
                 page->n < 1 || page->n > TVI_MAX_DIMENSION || page->is_from_step > 1 ||
                     (size_t)page->parameter_count > strlen(stream->input),
                 DAMAGED);
    if (!stream->fault && !allocate_page(page)) stream->fault = NO_MEMORY;
}

/* Transfers the stop and the history, which format 1 lacks. */
static void transfer_stop_and_history(text_stream *stream, state_page *page)
{
    uint64_t hash = page->own_hash;
    int64_t words = page->own_words;
    transfer_rows(stream, "stop", WORD, (int64_t)count_stop_words(page->n), ROW, page->stop);
    transfer_rows(stream, "history", WORD, 1, 1, &hash);
    transfer_number(stream, COUNT, &words);
    page->is_history_own = page->own_words > 0 && hash == page->own_hash && words == page->own_words;
    page->is_history_dropped = page->is_from_step && !page->is_history_own;
    transfer_rows(stream, "h", WORD, words, ROW, page->is_history_own ? page->history : NULL);
}

static void transfer_page(text_stream *stream, state_page *page)
{
    char word[LONGEST_WORD + 1];
    transfer_header(stream, page);
    if (stream->fault) return;
    const int64_t n = page->n;
    transfer_rows(stream, "value", DOUBLE, page->parameter_count, 1, page->parameters);
    transfer_rows(stream, "t", DOUBLE, 2, 2, page->state);
    transfer_rows(stream, "q", DOUBLE, 2 * n, 2, page->state + 2);
    transfer_rows(stream, "p", DOUBLE, 2 * n, 2, page->state + 2 + 2 * n);
    if (stream->input) {
        stream->input += strspn(stream->input, BLANKS);
        page->has_e = stream->input[0] == 'e' && stream->input[1] != 'n';
    }
    transfer_rows(stream, "e", DOUBLE, page->has_e ? 2 : 0, 2, page->state + 2 + 4 * n);
    if (stream->format > 1) transfer_stop_and_history(stream, page);
    transfer_fixed_word(stream, '\n', "end", DAMAGED);
    (void)write_digits(word, stream->hash, 16, 16);
    transfer_fixed_word(stream, ' ', word, DAMAGED);
}

/* Writes a page, or only measures it if `text` is NULL. Returns the number of characters. */
static size_t write_page(state_page *page, char *text)
{
    text_stream stream = {.output = text, .hash = JET_HASH_OF_NOTHING, .format = FORMAT};
    transfer_page(&stream, page);
    if (text) text[stream.length] = '\n';
    return stream.length + 1;
}

/* Checks the numbers of a page that was read. Returns NULL, or a message. A low-order part is the roundoff of its
 * number and of what steps added to it: it may exceed a number near 0, but is small beside the whole state. In format 1
 * a state that a step returned is recognized by its low-order parts or its e. */
static const char *check_page(state_page *page, int64_t format)
{
    const int64_t numbers = 2 * page->n + 2;
    double size = 0;
    tvi_event_stop stop;
    for (int64_t i = 1; i < numbers; i++) size = fmax(size, fabs(page->state[2 * i]));
    for (int64_t i = 0; i < numbers; i++) {
        const double low = page->state[2 * i + 1];
        if (fabs(low) > LARGEST_LOW_PART * fmax(size, fabs(page->state[2 * i])))
            return "a low-order part of the text is larger than roundoff";
        if (format == 1 && (page->has_e || low != 0)) page->is_from_step = 1;
    }
    for (int i = 0; page->is_history_own && i < STEP_COUNTS; i++)
        if (page->history[i] > INT64_MAX / 2) return DAMAGED;
    memcpy(&stop, page->stop, sizeof stop);
    return stop.event_count < 0 || stop.event_count > TVI_STOP_EVENTS ? DAMAGED : NULL;
}

/* Reads and checks a text. The caller frees page->state, also on failure. */
static tvi_status read_page(state_page *page, const char *text, size_t size)
{
    if (size >= 8 && memcmp(text, "tvistate", 8) == 0)
        return jet_refuse(TVI_EINVAL, "the bytes are no state as text, but of a version before 0.3: load them with the "
                                      "version that wrote them, and write them with tvi_state_to_text");
    char *const copy = malloc(size + 1);
    if (!copy) return jet_explain_out_of_memory(TVI_ENOMEM);
    memcpy(copy, text, size);
    copy[size] = '\0';
    text_stream stream = {.input = copy, .hash = JET_HASH_OF_NOTHING};
    transfer_page(&stream, page);
    stream.input += strspn(stream.input, BLANKS);
    record_fault(&stream, stream.input < copy + size, "something follows the end of the state's text");
    if (!stream.fault) stream.fault = check_page(page, stream.format);
    free(copy);
    if (!stream.fault) return TVI_OK;
    return jet_refuse(stream.fault == NO_MEMORY ? TVI_ENOMEM : TVI_EINVAL, "%s", stream.fault);
}

/* ---- The integrator ---------------------------------------------------------------------------------------------- */

/* Returns an empty page of the integrator. Its hash is that of everything that the bits of a step depend on; another
 * compiler, processor or order of bytes has another one, too. */
static state_page page_of(const tvi_integrator *it)
{
    static const char build[] = TVI_VERSION " " __VERSION__;
    const jet_tape *tape = it->stepped->field_values;
    const uint64_t code = it->options.compiled ? tvi_compiled_hash_library_text() : 0;
    const uint64_t parts[] = {tvi_system_fingerprint(it->stepped),
                              tvi_options_fingerprint(&it->options),
                              (uint64_t)tape->sweeps->isa,
                              (uint64_t)tape->interpreter_sweeps->isa,
                              code,
                              it->history.bytes,
                              LDBL_MANT_DIG};
    const uint64_t hash = jet_continue_hash(JET_HASH_OF_NOTHING, build, sizeof build);
    return (state_page){.n = it->system->n,
                        .parameter_count = tvi_system_parameters(it->system),
                        .own_hash = jet_continue_hash(hash, parts, sizeof parts),
                        .own_words = (int64_t)(COUNTS + it->history.bytes / sizeof(uint64_t))};
}

/* Copy numbers and their low-order parts to pairs[count][2], and back. NULL stands for zeros, or for nothing. */
static void join_pairs(int count, const double high[], const double low[], double pairs[])
{
    for (int i = 0; i < count; i++) pairs[2 * i] = high[i], pairs[2 * i + 1] = low ? low[i] : 0;
}
static void split_pairs(int count, const double pairs[], double high[], double low[])
{
    for (int i = 0; i < count && high; i++) high[i] = pairs[2 * i];
    for (int i = 0; i < count && low; i++) low[i] = pairs[2 * i + 1];
}

/* Copies all that the integrator has of the user's state to the page. */
static void fill_page(state_page *page, const tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    const tvi_run_state *state = &it->state;
    const bool is_own = *it->is_state_from_step && tvi_integrator_state_equals(it, t, q, p);
    page->is_from_step = is_own;
    page->has_e = tvi_steps_K(it);
    join_pairs(1, &t, is_own ? &state->q_low[n] : NULL, page->state);
    join_pairs(n, q, is_own ? state->q_low : NULL, page->state + 2);
    join_pairs(n, p, is_own ? state->p_low : NULL, page->state + 2 + 2 * n);
    if (is_own && page->has_e) join_pairs(1, &state->p[n], &state->p_low[n], page->state + 2 + 4 * n);
    memcpy(page->parameters, it->parameters, (size_t)page->parameter_count * sizeof *page->parameters);
    memcpy(page->stop, it->stop, tvi_stop_bytes(n));
    memcpy(page->history, &it->stats, offsetof(tvi_stats, bytes));
    if (is_own) tvi_arena_copy_history((char *)(page->history + COUNTS), it->history.now, it->history.bytes);
}

tvi_status tvi_state_to_text(const tvi_integrator *it, double t, const double q[], const double p[], char *text,
                             size_t *size)
{
    if (!it || !q || !p || !size)
        return tvi_refuse_first_null_pointer(4, (const void *const[]){it, q, p, size},
                                             (const char *const[]){"integrator", "q", "p", "size"});
    const tvi_status status = tvi_refuse_nonfinite_state(it->system->n, t, q, "p", p);
    if (status != TVI_OK) return status;
    state_page page = page_of(it);
    if (!allocate_page(&page)) return jet_explain_out_of_memory(TVI_ENOMEM);
    fill_page(&page, it, t, q, p);
    const size_t needed = write_page(&page, NULL), room = text ? *size : needed;
    if (room >= needed) *size = text ? write_page(&page, text) : needed;
    free(page.state);
    return room >= needed ? TVI_OK : jet_refuse(TVI_EINVAL, "the buffer has %zu bytes, the text %zu", room, needed);
}

/* Tells whether steps can go on from the history that the integrator has loaded: its numbers are finite, and its
 * indices lie within their arrays. */
static bool is_history_valid(const tvi_integrator *it)
{
    const tvi_run_state *state = &it->state;
    const tvi_reference_energy *reference = it->guard.reference_energy;
    const int dimension = it->stepped->n;
    return tvi_all_finite(dimension + 1, state->q) && tvi_all_finite(dimension + 1, state->q_low) &&
           tvi_all_finite(dimension, state->p) && tvi_all_finite(dimension, state->p_low) &&
           isfinite(reference->zero_level) && isfinite(reference->energy_scale) &&
           (!reference->is_H_known || isfinite(reference->H)) &&
           (!it->stepper->is_history_valid || it->stepper->is_history_valid(it->work));
}

/* Sets the state and the history to those of the page, after the parameters. A state that no step returned is loaded
 * like one that the user gives. */
static tvi_status set_state(tvi_integrator *it, const state_page *page)
{
    const int n = it->system->n;
    const double *const q = page->state + 2, *const p = q + 2 * n;
    const tvi_run_state *state = &it->state;
    split_pairs(n, q, it->guard.end.q, NULL); /* guard.end is scratch between steps */
    split_pairs(n, p, it->guard.end.p, NULL);
    *it->is_state_from_step = false;
    const tvi_status status = tvi_integrator_begin_step(it, page->state[0], it->guard.end.q, it->guard.end.p);
    if (status != TVI_OK) return status;
    if (page->is_from_step && page->is_history_own)
        tvi_arena_copy_history(it->history.now, (const char *)(page->history + COUNTS), it->history.bytes);
    *it->is_state_from_step = page->is_from_step;
    split_pairs(1, page->state, &state->q[n], &state->q_low[n]);
    split_pairs(n, q, state->q, state->q_low);
    split_pairs(n, p, state->p, state->p_low);
    if (page->has_e && tvi_steps_K(it)) split_pairs(1, p + 2 * n, &state->p[n], &state->p_low[n]);
    return is_history_valid(it) ? TVI_OK : jet_refuse(TVI_EINVAL, "%s", DAMAGED);
}

/* Sets all that the integrator holds to the contents of the page. On failure it is left as it was. */
static tvi_status load_page(tvi_integrator *it, const state_page *page)
{
    const size_t bytes = (size_t)page->parameter_count * sizeof(double);
    char *former = malloc(it->history.bytes + bytes + 1);
    if (!former) return jet_explain_out_of_memory(TVI_ENOMEM);
    tvi_arena_copy_history(former, it->history.now, it->history.bytes);
    memcpy(former + it->history.bytes, it->parameters, bytes);
    tvi_integrator_load_parameters(it, page->parameters, 1);
    const tvi_status status = set_state(it, page);
    if (status == TVI_OK) {
        it->last_step.has_curve = false;
        memcpy(it->stop, page->stop, tvi_stop_bytes(it->system->n));
        if (page->is_history_own) memcpy(&it->stats, page->history, offsetof(tvi_stats, bytes));
    } else {
        tvi_arena_copy_history(it->history.now, former, it->history.bytes);
        tvi_integrator_load_parameters(it, (const double *)(former + it->history.bytes), 1);
    }
    free(former);
    return status;
}

tvi_status tvi_state_from_text(tvi_integrator *it, const char *text, size_t size, double *t, double q[], double p[])
{
    if (!it || !text || !t || !q || !p)
        return tvi_refuse_first_null_pointer(5, (const void *const[]){it, text, t, q, p},
                                             (const char *const[]){"integrator", "text", "t", "q", "p"});
    if (it->is_in_observer)
        return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not load a state");
    state_page page = page_of(it);
    tvi_status status = read_page(&page, text, size);
    if (status == TVI_OK) status = load_page(it, &page);
    free(page.state);
    if (status != TVI_OK) return status;
    tvi_integrator_copy_state(it, t, q, p);
    return jet_refuse(TVI_OK, "%s",
                      page.is_history_dropped ? "the history of the steps is of another system, method, instruction "
                                                "set or version of the library, and was dropped"
                                              : "");
}

tvi_status tvi_state_peek(const char *text, size_t size, int *n, double *t, double q[], double p[])
{
    if (!text || !n) return jet_refuse(TVI_EINVAL, "%s is NULL", text ? "n" : "text");
    state_page page = {0};
    const tvi_status status = read_page(&page, text, size);
    if (status == TVI_OK) {
        *n = (int)page.n;
        split_pairs(1, page.state, t, NULL);
        split_pairs(*n, page.state + 2, q, NULL);
        split_pairs(*n, page.state + 2 + 2 * *n, p, NULL);
    }
    free(page.state);
    return status;
}
