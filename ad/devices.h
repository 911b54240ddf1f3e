/* devices.h - Names the devices: parts of the library that exist for speed alone, each with its file and the place
 * where it is chosen. Without devices all results are the same to roundoff. docs/adding.md says when a device applies
 * and what it must gain to stay; `make devices` measures what each one gains.
 *
 * A library built by `make PLAIN=1` (TVI_PLAIN) has no devices. A library built by `make devices` (TVI_DEVICES) has all
 * devices except those whose bits are set in the variable jet_without. */
#ifndef TVI_AD_DEVICES_H
#define TVI_AD_DEVICES_H

#define JET_DEVICE_TERMS 1 /* bit of the device that makes one operation of a sum of products: lowering.c */
/* The bit of the device that gives generated code runs of one operation: tape_split.c, chosen in emit.c. */
#define JET_DEVICE_SPLIT 2

#ifdef TVI_PLAIN
#define JET_WITHOUT (~0)
#elif defined TVI_DEVICES
extern int jet_without;
#define JET_WITHOUT jet_without
#else
#define JET_WITHOUT 0
#endif
#define JET_HAS(device) (!(JET_WITHOUT & JET_DEVICE_##device))

#endif
