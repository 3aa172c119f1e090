// SPDX-License-Identifier: MIT
/* dispatch.h - the public functions: the library is compiled whole for each set of instructions, and a
 * call chooses the set by what the processor has.
 *
 * WHAT IS COMPILED.  The sources of the floors num to system, and check/check.c, are compiled once for
 * each set:
 *
 *     base    what every processor of the architecture has
 *     v3      x86-64: AVX2 and the fused multiply-add
 *     v4      x86-64: AVX-512
 *
 * But not all: what gains nothing by AVX-512 (narrow_files of meson.build: single rays, proofs, boxes;
 * and what SGT_NARROW marks) v4 has from v3, and narrow_names.h says so to both.  Where there is more than
 * one set, base is compiled to be small.  A narrow file may be given a surface with the operations of v4: it
 * compares tables only after in_set, of what the program gave.
 *
 * names.h (names.py) gives each function the name of its set.  check/diagnose.c is compiled once: no set
 * is faster at it.
 *
 * WHAT A PROGRAM LINKS TO is in this folder: the public functions, which jump to those of a set, and the
 * public tables of operations, whose functions do the same.  Inside a set nothing is chosen any more.  A
 * surface that comes in is given the operations of the set (in_set, surface/builtin.h).
 *
 * THE SAME BITS.  The answers are the same in all sets: no operation is fused or reordered but where the
 * source says so (meson.build), and sgt_fma is rounded once everywhere.  So it does not matter which set
 * answers, and the choice needs no lock: threads that choose at the same time choose the same.
 *
 * Nothing runs before main, and the loader relocates nothing for it.  So static programs, sanitizers and C
 * libraries without ifunc need nothing special. */
#ifndef SGT_DISPATCH_H
#define SGT_DISPATCH_H

#include <stddef.h>

enum { SGT_BASE, SGT_V3, SGT_V4 };

#if SGT_SETS > 1
extern int sgt_chosen_set; /* -1: none yet */
int sgt_choose_set(void);

static inline int sgt_set(void)
{
    int set = __atomic_load_n(&sgt_chosen_set, __ATOMIC_RELAXED);
    return set >= 0 ? set : sgt_choose_set();
}

/* The set for n rays.  v4 works on eight at once, and does fewer than eight one by one. */
static inline int sgt_set_for(size_t n)
{
    int set = sgt_set();
    return set == SGT_V4 && n < 8 ? SGT_V3 : set;
}

/* Declares a function of the sets: its type, name and parameters.  NAME_in_set[sgt_set()] is the one to
 * call. */
#define SGT_IN_SETS(TYPE, NAME, PARAMETERS) \
    TYPE NAME##_base PARAMETERS;            \
    TYPE NAME##_v3 PARAMETERS;              \
    TYPE NAME##_v4 PARAMETERS;              \
    static TYPE(*const NAME##_in_set[]) PARAMETERS = {NAME##_base, NAME##_v3, NAME##_v4};
#else
static inline int sgt_set(void) { return SGT_BASE; }
static inline int sgt_set_for(size_t n) { return (void)n, SGT_BASE; }

#define SGT_IN_SETS(TYPE, NAME, PARAMETERS) \
    TYPE NAME##_base PARAMETERS;            \
    static TYPE(*const NAME##_in_set[]) PARAMETERS = {NAME##_base};
#endif

/* Defines a public function that jumps to that of the set.  ARGUMENTS: its parameters without types. */
#define SGT_DISPATCH(TYPE, NAME, PARAMETERS, ARGUMENTS) \
    SGT_IN_SETS(TYPE, NAME, PARAMETERS)                 \
    TYPE NAME PARAMETERS { return NAME##_in_set[sgt_set()] ARGUMENTS; }
/* The same for one that is asked of n rays. */
#define SGT_DISPATCH_RAYS(TYPE, NAME, PARAMETERS, ARGUMENTS) \
    SGT_IN_SETS(TYPE, NAME, PARAMETERS)                      \
    TYPE NAME PARAMETERS { return NAME##_in_set[sgt_set_for(n)] ARGUMENTS; }
#define SGT_DISPATCH_VOID(NAME, PARAMETERS, ARGUMENTS) \
    SGT_IN_SETS(void, NAME, PARAMETERS)                \
    void NAME PARAMETERS { NAME##_in_set[sgt_set()] ARGUMENTS; }

/* Defines a public function that calls `base`, as no set is faster at it. */
#define SGT_EXPORT(TYPE, NAME, PARAMETERS, ARGUMENTS) \
    TYPE NAME##_base PARAMETERS;                      \
    TYPE NAME PARAMETERS { return NAME##_base ARGUMENTS; }

#endif
