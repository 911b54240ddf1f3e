/* width.h - Says how many members of an ensemble a block holds: its width, a power of two. The batches of the curves
 * choose it; arrays on the stack with one number for each member have the greatest width. */
#ifndef TVI_SRC_ALGEBRA_WIDTH_H
#define TVI_SRC_ALGEBRA_WIDTH_H

/* The least width fills one vector of the widest instruction set, so that no block needs a part of a vector. The
 * greatest width is a power of two times the least one. */
enum { TVI_LEAST_WIDTH = 8, TVI_MOST_WIDTH = 32 };

#endif
