/* jet.h - the arithmetic in which a user writes a force, a potential or any other function. It declares jets and the
 * operations on them, which record the function.
 *
 * A jet stands for a quantity that depends on the state. The user's function is called once, while its system is
 * created. Every operation below records itself, and the recording is later run on numbers, on Taylor series and on
 * dual numbers. Therefore the function is straight-line in its jets: loops and branches on ordinary numbers are fine, a
 * branch on the value of a jet cannot be written.
 *
 * Rules
 *   1. Every argument for a jet takes a jet or an ordinary number: jet_mul(2, x), jet_sub(x, 0.5). Operations on
 *      numbers alone are computed at once and record nothing.
 *   2. A jet lives as long as the call that received it. A jet that is kept longer, or mixed with the jets of another
 *      recording, makes a poison jet, and the system whose function returns one is refused with TVI_EINVAL. A jet that
 *      is kept after its system was freed must not be used at all, like any freed memory.
 *   3. An operation is refused with TVI_EDOMAIN wherever its power series does not exist: sqrt at 0, asin at 1,
 *      pow(0, 1.5), log at 0, hypot at (0, 0), division by 0. If the operand is a number this happens at once,
 *      otherwise at the step.
 *   4. C++ users may write operators, 0.5 * a * b - sin(a) / 2 and a += b, and the functions sqr, sqrt, exp, log, pow,
 *      sin and the others without the prefix; both spellings record the same.
 *   5. jet_pow(a, c) takes any a for c = 0, 1, 2, ...; a != 0 for c = -1, -2, ...; a > 0 otherwise.
 *   6. A component just beyond the end of a vector that the function gets, such as q[2] for n = 2, makes a poison jet,
 *      too; a force there must not be set. Both are refused with TVI_EINVAL. */
#ifndef TVI_JET_H
#define TVI_JET_H

#if defined(__GNUC__)
#pragma GCC system_header /* the arguments below leave out braces and initialisers on purpose */
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the rest of the library is hidden */
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* Every status of the library and its text, in one list. */
#define TVI_STATUS_LIST(ROW)                                                                                           \
    ROW(TVI_OK, "success")                                                                                             \
    ROW(TVI_EINVAL, "invalid argument")                                                                                \
    ROW(TVI_ENOMEM, "out of memory")                                                                                   \
    ROW(TVI_EDOMAIN, "a function was evaluated where its power series does not exist")                                 \
    ROW(TVI_ENOCONV, "the corrector did not converge: the step is too large")                                          \
    ROW(TVI_ESINGULAR, "a matrix of the step is singular")                                                             \
    ROW(TVI_ENONFINITE, "a value is not finite")                                                                       \
    ROW(TVI_ESTOPPED, "stopped by an observer or a terminal event")                                                    \
    ROW(TVI_EUNSUPPORTED, "this system or method does not provide that")                                               \
    ROW(TVI_ETOOLARGE, "the step is too large for the orbit")                                                          \
    ROW(TVI_ECOMPILE, "the generated code could not be compiled or loaded")                                            \
    ROW(TVI_EROUNDOFF, "the wanted error is below roundoff")

#define TVI_STATUS_CODE(code, text) code,
typedef enum { TVI_STATUS_LIST(TVI_STATUS_CODE) TVI_STATUS_COUNT } tvi_status;
#undef TVI_STATUS_CODE

struct jet_node;
typedef struct jet jet;

/* The functions of one jet: name and code. */
#define JET_FUNCTION_LIST(ROW)                                                                                         \
    ROW(sqr, JET_SQR)                                                                                                  \
    ROW(sqrt, JET_SQRT)                                                                                                \
    ROW(exp, JET_EXP)                                                                                                  \
    ROW(log, JET_LOG)                                                                                                  \
    ROW(sin, JET_SIN)                                                                                                  \
    ROW(cos, JET_COS)                                                                                                  \
    ROW(tan, JET_TAN)                                                                                                  \
    ROW(asin, JET_ASIN)                                                                                                \
    ROW(acos, JET_ACOS)                                                                                                \
    ROW(atan, JET_ATAN)                                                                                                \
    ROW(sinh, JET_SINH)                                                                                                \
    ROW(cosh, JET_COSH)                                                                                                \
    ROW(tanh, JET_TANH)                                                                                                \
    ROW(asinh, JET_ASINH)                                                                                              \
    ROW(acosh, JET_ACOSH)                                                                                              \
    ROW(atanh, JET_ATANH)                                                                                              \
    ROW(erf, JET_ERF)
#define JET_FUNCTION2_LIST(ROW) /* functions of two jets */                                                            \
    ROW(atan2, JET_ATAN2)                                                                                              \
    ROW(hypot, JET_HYPOT)
#define JET_FUNCTION_CODE(name, code) code,
typedef enum { JET_NEG, JET_FUNCTION_LIST(JET_FUNCTION_CODE) JET_FUNCTION_COUNT } jet_function;
typedef enum { JET_FUNCTION2_LIST(JET_FUNCTION_CODE) JET_FUNCTION2_COUNT } jet_function2;
#undef JET_FUNCTION_CODE

/* The functions that record the operations below. C and C++ have no need to call them. Other languages do: the names,
 * the codes and the layout of a jet stay (docs/bindings.md). */
jet jet_record_add(jet a, jet b);
jet jet_record_sub(jet a, jet b);
jet jet_record_mul(jet a, jet b);
jet jet_record_div(jet a, jet b);
jet jet_record_pow(jet a, double c);
jet jet_record_function(jet_function f, jet a);
jet jet_record_function2(jet_function2 f, jet a, jet b);

/* A number (node NULL), or a node of a recording. It is passed by value; its members belong to the library. */
#ifndef __cplusplus
struct jet {
    double number;
    struct jet_node *node;
};
#else
}

/* The operators and functions are friends that only an argument of type jet finds: sin(1.0) stays what it was. */
struct jet {
    double number;
    struct jet_node *node;
    jet() : number(0), node(nullptr) {}
    jet(double value) : number(value), node(nullptr) {}

    friend inline jet operator+(jet a, jet b) { return jet_record_add(a, b); }
    friend inline jet operator-(jet a, jet b) { return jet_record_sub(a, b); }
    friend inline jet operator*(jet a, jet b) { return jet_record_mul(a, b); }
    friend inline jet operator/(jet a, jet b) { return jet_record_div(a, b); }
    friend inline jet operator+(jet a) { return a; }
    friend inline jet operator-(jet a) { return jet_record_function(JET_NEG, a); }
    jet &operator+=(jet b) { return *this = jet_record_add(*this, b); }
    jet &operator-=(jet b) { return *this = jet_record_sub(*this, b); }
    jet &operator*=(jet b) { return *this = jet_record_mul(*this, b); }
    jet &operator/=(jet b) { return *this = jet_record_div(*this, b); }

    friend inline jet pow(jet a, double c) { return jet_record_pow(a, c); }
    friend inline jet pow(jet a, jet b) { return exp(b * log(a)); } /* a > 0 */
    friend inline jet pow(double a, jet b) { return exp(b * log(jet(a))); }
#define JET_DEFINE_FRIEND(name, function)                                                                              \
    friend inline jet name(jet a) { return jet_record_function(function, a); }
    JET_FUNCTION_LIST(JET_DEFINE_FRIEND)
#undef JET_DEFINE_FRIEND
#define JET_DEFINE_FRIEND(name, function)                                                                              \
    friend inline jet name(jet a, jet b) { return jet_record_function2(function, a, b); }
    JET_FUNCTION2_LIST(JET_DEFINE_FRIEND)
#undef JET_DEFINE_FRIEND
};

extern "C" {
#endif

/* A number that may be changed after the recording, by tvi_integrator_set_parameters: number `index` of the values,
 * with 0 <= index < 1000, here with this value. Any jet of the recording serves as the first argument. The same index
 * again is the same number, and must have the same value; otherwise the system is refused with TVI_EINVAL. */
jet jet_parameter(jet of_recording, int index, double value);
/* x[0] + ... + x[count-1], added in that order, numbers last; 0 if count <= 0. */
jet jet_sum(const jet x[], int count);
/* x[0] y[0] + ... + x[count-1] y[count-1]; 0 if count <= 0. */
jet jet_dot(const jet x[], const jet y[], int count);

#ifdef __cplusplus
}

static inline jet jet_const(double value) { return jet(value); }
static inline jet jet_add(jet a, jet b) { return jet_record_add(a, b); }
static inline jet jet_sub(jet a, jet b) { return jet_record_sub(a, b); }
static inline jet jet_mul(jet a, jet b) { return jet_record_mul(a, b); }
static inline jet jet_div(jet a, jet b) { return jet_record_div(a, b); }
static inline jet jet_pow(jet a, double c) { return jet_record_pow(a, c); }
static inline jet jet_neg(jet a) { return -a; }
#define JET_DEFINE(name, function)                                                                                     \
    static inline jet jet_##name(jet a) { return name(a); }
JET_FUNCTION_LIST(JET_DEFINE)
#undef JET_DEFINE
#define JET_DEFINE(name, function)                                                                                     \
    static inline jet jet_##name(jet a, jet b) { return jet_record_function2(function, a, b); }
JET_FUNCTION2_LIST(JET_DEFINE)
#undef JET_DEFINE

#else

/* Brace elision lets one initialiser be a jet or a number, and the argument is expanded once, so that nesting is
 * free. */
struct jet_slot {
    jet jet;
};
#if defined(__clang__)
#define JET_SLOT(x)                                                                                                    \
    _Pragma("clang diagnostic push") _Pragma("clang diagnostic ignored \"-Wmissing-field-initializers\"")              \
        _Pragma("clang diagnostic ignored \"-Wmissing-braces\"")(((struct jet_slot){x}).jet)                           \
            _Pragma("clang diagnostic pop")
#else
/* The index, always 0, is an initialiser of its own after x. Without it gcc takes the missing braces of a number in the
 * last argument for missing braces of the list in which the operation stands, as in jet z[] = {jet_add(x, 1)}. */
#define JET_SLOT(x) ((&(struct jet_slot){x})[(int){0}].jet)
#endif

/* The number as a jet. */
static inline jet jet_const(double value)
{
    jet constant = {value, (struct jet_node *)0};
    return constant;
}

#define jet_add(a, b)   jet_record_add(JET_SLOT(a), JET_SLOT(b))   /* a + b */
#define jet_sub(a, b)   jet_record_sub(JET_SLOT(a), JET_SLOT(b))   /* a - b */
#define jet_mul(a, b)   jet_record_mul(JET_SLOT(a), JET_SLOT(b))   /* a b */
#define jet_div(a, b)   jet_record_div(JET_SLOT(a), JET_SLOT(b))   /* a / b,  b != 0 */
#define jet_pow(a, c)   jet_record_pow(JET_SLOT(a), (c))           /* a^c for a number c, see rule 5 */
#define jet_neg(a)      jet_record_function(JET_NEG, JET_SLOT(a))  /* -a */
#define jet_sqr(a)      jet_record_function(JET_SQR, JET_SLOT(a))  /* a^2 */
#define jet_sqrt(a)     jet_record_function(JET_SQRT, JET_SLOT(a)) /* a > 0 */
#define jet_exp(a)      jet_record_function(JET_EXP, JET_SLOT(a))
#define jet_log(a)      jet_record_function(JET_LOG, JET_SLOT(a)) /* natural logarithm, a > 0 */
#define jet_sin(a)      jet_record_function(JET_SIN, JET_SLOT(a))
#define jet_cos(a)      jet_record_function(JET_COS, JET_SLOT(a))
#define jet_tan(a)      jet_record_function(JET_TAN, JET_SLOT(a))
#define jet_asin(a)     jet_record_function(JET_ASIN, JET_SLOT(a)) /* -1 < a < 1 */
#define jet_acos(a)     jet_record_function(JET_ACOS, JET_SLOT(a)) /* -1 < a < 1 */
#define jet_atan(a)     jet_record_function(JET_ATAN, JET_SLOT(a))
#define jet_sinh(a)     jet_record_function(JET_SINH, JET_SLOT(a))
#define jet_cosh(a)     jet_record_function(JET_COSH, JET_SLOT(a))
#define jet_tanh(a)     jet_record_function(JET_TANH, JET_SLOT(a))
#define jet_asinh(a)    jet_record_function(JET_ASINH, JET_SLOT(a))
#define jet_acosh(a)    jet_record_function(JET_ACOSH, JET_SLOT(a)) /* a > 1 */
#define jet_atanh(a)    jet_record_function(JET_ATANH, JET_SLOT(a)) /* -1 < a < 1 */
#define jet_erf(a)      jet_record_function(JET_ERF, JET_SLOT(a))   /* 2/sqrt(pi) integral_0^a exp(-s^2) ds */
#define jet_atan2(a, b) jet_record_function2(JET_ATAN2, JET_SLOT(a), JET_SLOT(b)) /* angle of (b, a), not both 0 */
#define jet_hypot(a, b) jet_record_function2(JET_HYPOT, JET_SLOT(a), JET_SLOT(b)) /* sqrt(a^2 + b^2), not both 0 */

#endif

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#endif
