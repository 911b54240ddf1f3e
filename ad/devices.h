/* devices.h - Names what is done for speed alone: a device each, with its file and the place where it is asked for.
 * Without them all is the same to roundoff. docs/adding.md says where each applies and when one stays; `make devices`
 * measures what each gives.
 *
 * Built with TVI_PLAIN, as make PLAIN=1 does, the library has none of them. Built with TVI_DEVICES, as make devices
 * does, it has all but those of the mask jet_without, which then is a variable. */
#ifndef TVI_AD_DEVICES_H
#define TVI_AD_DEVICES_H

#define JET_DEVICE_PAD       1   /* runs as long as whole vectors: tape_pad.c, asked for in tape.c */
#define JET_DEVICE_TOGETHER  2   /* sine and cosine, and powers of one operand: rule_power.c, asked for in tape.c */
#define JET_DEVICE_TERMS     4   /* sums of products as one operation: lowering.c */
#define JET_DEVICE_SCATTERED 8   /* products read operands where they are: lowering.c */
#define JET_DEVICE_ROOTS     16  /* a^(-3/2) from an estimate, with AVX-512: roots.h */
#define JET_DEVICE_SPLIT     32  /* generated code has operations alone: tape_split.c, asked for in emit.c */
#define JET_DEVICE_PAIRS     64  /* and two neighbours in one vector: sum_products.c, asked for in emit.c */
#define JET_DEVICE_UNROLL    128 /* and orders of a series as constants: emit.c */
#define JET_DEVICE_FRESH     256 /* and no 0 added to: emit_adjoints.c */
#define JET_DEVICE_BARRIERS  512 /* for the compiler, which does not know what waits for stores: compiler.h */

/* Generated code is told in its first line (emit.c) of those that its text itself has. */
#define JET_DEVICES_OF_TEXT (JET_DEVICE_ROOTS | JET_DEVICE_PAIRS | JET_DEVICE_BARRIERS)
#ifdef JET_EMITTED
#elif defined TVI_PLAIN
#define JET_WITHOUT (~0)
#elif defined TVI_DEVICES
extern int jet_without;
#define JET_WITHOUT jet_without
#else
#define JET_WITHOUT 0
#endif
#define JET_HAS(device) (!(JET_WITHOUT & JET_DEVICE_##device))

#endif
