/* state_text.c - Writes a state as text, and reads it (state_text.h). travel.c calls it. One function,
 * read_or_write_state, lists the words of the text both for writing and for reading. An example of a text is
 *
 *     tvi state 1
 *     n 2
 *     parameters 1
 *     value 0x1.8p+0
 *     t 0x1.9p+5 -0x1p-50
 *     q 0x1.06f48c7a1p-2 0x1.8p-56
 *     q -0x1.5f34d6a161e4fp-1 0x0p+0
 *     p 0x1p-1 0x0p+0
 *     p 0x1.4p-1 0x0p+0
 *     end 9ae16a3b2f90404f
 *
 * Numbers are written as printf does by %a, with a point in every locale. Any white space may separate words, since
 * other programs may change the ends of lines. The last word is the FNV-1a hash of all words before it, each followed
 * by a blank. The fields of tvi_state_text tell the order of the rows. */
#include "integrator/state_text.h"
#include "tape.h"
#include "algebra/sizes.h"

#include <stdlib.h>
#include <string.h>

/* LONGEST_WORD is the number of characters of the longest word; MANTISSA and DIGITS are the largest numbers of
 * hexadecimal digits of a mantissa and of digits of an integer. */
enum { LONGEST_WORD = 31, MANTISSA = 13, DIGITS = 20 };

static const char NO_STATE[] = "the text is no state", DAMAGED[] = "the text of the state is damaged or cut short";

bool tvi_state_text_open(tvi_state_text *state_text, int n, int parameter_count)
{
    *state_text = (tvi_state_text){.n = n, .parameter_count = parameter_count};
    state_text->parameter_values =
        calloc((size_t)parameter_count + 4 * ((size_t)n + 1), sizeof *state_text->parameter_values);
    state_text->state_values = state_text->parameter_values + parameter_count;
    return state_text->parameter_values != NULL;
}

/* ---- Numbers ----------------------------------------------------------------------------------------------------- */

/* Writes a number in the given base, with at least least_digits digits. Returns the address of the end of the text. */
static char *write_digits(char *text, uint64_t number, unsigned base, int least_digits)
{
    char digit[DIGITS];
    int count = 0;
    for (; number > 0 || count < least_digits; number /= base) digit[count++] = "0123456789abcdef"[number % base];
    while (count > 0) *text++ = digit[--count];
    *text = '\0';
    return text;
}

/* Writes a double as printf does by %a: its sign, 0x, the bits of its mantissa in hexadecimal, and its binary exponent.
 * Denormal numbers begin with 0x0 and have the exponent -1022. */
static void write_double(char *text, double number)
{
    const uint64_t bits = tvi_double_bits(number), mantissa = bits << 12 >> 12;
    const int biased = (int)(bits >> 52 & 0x7ff), exponent = biased > 0 ? biased - 1023 : mantissa > 0 ? -1022 : 0;
    if (bits >> 63) *text++ = '-';
    *text++ = '0', *text++ = 'x', *text++ = biased > 0 ? '1' : '0';
    if (mantissa > 0) {
        *text++ = '.';
        text = write_digits(text, mantissa, 16, MANTISSA);
        while (text[-1] == '0') text--;
    }
    *text++ = 'p', *text++ = exponent < 0 ? '-' : '+';
    (void)write_digits(text, (uint64_t)abs(exponent), 10, 1);
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

/* Reads a word as a double. Returns whether it is a finite number in the form that write_double writes. */
static bool read_double(const char *text, double *number)
{
    int count;
    const bool is_negative = *text == '-';
    text += is_negative;
    if (strncmp(text, "0x0", 3) != 0 && strncmp(text, "0x1", 3) != 0) return false;
    const bool is_normal = text[2] == '1';
    uint64_t mantissa = 0;
    text += 3;
    if (*text == '.') {
        text++;
        mantissa = read_digits(&text, 16, MANTISSA, &count);
        if (count == 0) return false;
        mantissa <<= 4 * (MANTISSA - count);
    }
    if (strncmp(text, "p+", 2) != 0 && strncmp(text, "p-", 2) != 0) return false;
    const int sign = text[1] == '-' ? -1 : 1;
    text += 2;
    const int exponent = sign * (int)read_digits(&text, 10, 4, &count);
    const bool is_one = is_normal ? exponent >= -1022 && exponent <= 1023 : mantissa == 0 || exponent == -1022;
    if (count == 0 || *text || !is_one) return false;
    const uint64_t biased = is_normal ? (uint64_t)(exponent + 1023) : 0;
    const uint64_t bits = (uint64_t)is_negative << 63 | biased << 52 | mantissa;
    memcpy(number, &bits, sizeof *number);
    return true;
}

/* ---- Words ------------------------------------------------------------------------------------------------------- */

/* A text of a state that is being read, or written, or only measured to find its length. */
typedef struct {
    const char *input;           /* the text that is read; NULL if a text is written or measured */
    char *output;                /* memory for the text that is written; NULL if it is only measured */
    size_t next_character_index; /* index of the next character in the input or the output */
    size_t input_size;           /* the number of characters of the input */
    uint64_t hash;               /* FNV-1a of the words so far, each followed by a blank */
    const char *first_fault;     /* describes the first error in the input; NULL if there is none */
} text_stream;

static void record_first_fault(text_stream *stream, bool has_fault, const char *fault)
{
    if (has_fault && !stream->first_fault) stream->first_fault = fault;
}

static void skip_whitespace(text_stream *stream)
{
    while (stream->next_character_index < stream->input_size && stream->input[stream->next_character_index] &&
           strchr(" \t\r\n", stream->input[stream->next_character_index]))
        stream->next_character_index++;
}

/* Reads the next word of the input. A longer word than LONGEST_WORD is cut, and matches nothing that is expected. */
static void read_word(text_stream *stream, char word[LONGEST_WORD + 1])
{
    size_t length = 0;
    skip_whitespace(stream);
    for (; stream->next_character_index < stream->input_size && length < LONGEST_WORD; stream->next_character_index++) {
        if (strchr(" \t\r\n", stream->input[stream->next_character_index])) break; /* a 0, too */
        word[length++] = stream->input[stream->next_character_index];
    }
    word[length] = '\0';
}

static void write_word(text_stream *stream, char separator, const char *word)
{
    if (stream->next_character_index > 0) {
        if (stream->output) stream->output[stream->next_character_index] = separator;
        stream->next_character_index++;
    }
    if (stream->output) memcpy(stream->output + stream->next_character_index, word, strlen(word));
    stream->next_character_index += strlen(word);
}

/* Writes `word` to the output, or reads the next word of the input into `word`. Adds the word to the hash. */
static void read_or_write_word(text_stream *stream, char separator, char word[LONGEST_WORD + 1])
{
    if (stream->input) read_word(stream, word);
    else write_word(stream, separator, word);
    stream->hash = jet_continue_hash(jet_continue_hash(stream->hash, word, strlen(word)), " ", 1);
}

static void read_or_write_expected_word(text_stream *stream, char separator, const char *wanted, const char *fault)
{
    char word[LONGEST_WORD + 1];
    memcpy(word, wanted, strlen(wanted) + 1);
    read_or_write_word(stream, separator, word);
    record_first_fault(stream, strcmp(word, wanted) != 0, fault);
}

static void read_or_write_expected_count(text_stream *stream, const char *label, int count, const char *fault)
{
    char word[LONGEST_WORD + 1];
    read_or_write_expected_word(stream, '\n', label, NO_STATE);
    (void)write_digits(word, (uint64_t)count, 10, 1);
    read_or_write_expected_word(stream, ' ', word, fault);
}

static void read_or_write_rows(text_stream *stream, const char *label, int rows, int columns, double *numbers)
{
    char word[LONGEST_WORD + 1];
    for (int i = 0; i < rows && !stream->first_fault; i++) {
        read_or_write_expected_word(stream, '\n', label, DAMAGED);
        for (int k = 0; k < columns; k++, numbers++) {
            if (!stream->input) write_double(word, *numbers);
            read_or_write_word(stream, ' ', word);
            record_first_fault(stream, stream->input && !read_double(word, numbers), DAMAGED);
        }
    }
}

/* Tells whether the next word of the input is "e". */
static bool is_next_word_energy_offset_label(const text_stream *stream)
{
    text_stream ahead = *stream;
    char word[LONGEST_WORD + 1];
    read_word(&ahead, word);
    return strcmp(word, "e") == 0;
}

/* ---- The text ---------------------------------------------------------------------------------------------------- */

static void read_or_write_state(text_stream *stream, tvi_state_text *state_text)
{
    const int n = state_text->n;
    char word[LONGEST_WORD + 1];
    read_or_write_expected_word(stream, ' ', "tvi", NO_STATE);
    read_or_write_expected_word(stream, ' ', "state", NO_STATE);
    read_or_write_expected_word(stream, ' ', "1", "the text is of a format that this version does not know");
    read_or_write_expected_count(stream, "n", n, "the text is of a system of another dimension");
    read_or_write_expected_count(stream, "parameters", state_text->parameter_count,
                                 "the text is of a system with other parameters");
    read_or_write_rows(stream, "value", state_text->parameter_count, 1, state_text->parameter_values);
    read_or_write_rows(stream, "t", 1, 2, state_text->state_values);
    read_or_write_rows(stream, "q", n, 2, state_text->state_values + 2);
    read_or_write_rows(stream, "p", n, 2, state_text->state_values + 2 * (n + 1));
    if (stream->input) state_text->has_energy_offset = is_next_word_energy_offset_label(stream);
    read_or_write_rows(stream, "e", state_text->has_energy_offset, 2, state_text->state_values + 2 * (2 * n + 1));
    read_or_write_expected_word(stream, '\n', "end", DAMAGED);
    (void)write_digits(word, stream->hash, 16, 16);
    read_or_write_expected_word(stream, ' ', word, DAMAGED);
}

size_t tvi_state_text_write(const tvi_state_text *state_text, char *text)
{
    text_stream stream = {.output = text, .hash = JET_HASH_OF_NOTHING};
    tvi_state_text same = *state_text;
    read_or_write_state(&stream, &same);
    if (text) text[stream.next_character_index] = '\n';
    return stream.next_character_index + 1;
}

const char *tvi_state_text_read(tvi_state_text *state_text, const char *text, size_t size)
{
    text_stream stream = {.input = text, .input_size = size, .hash = JET_HASH_OF_NOTHING};
    read_or_write_state(&stream, state_text);
    skip_whitespace(&stream);
    record_first_fault(&stream, stream.next_character_index < size, "something follows the end of the state's text");
    return stream.first_fault;
}
