/* dispatch.h - one library, compiled whole for each set of instructions; a call chooses by what the
 * processor has.
 *
 * WHAT IS CHOSEN.  The sources below this folder are compiled once for each set: `base`, which every
 * processor of the architecture has, and on x86-64 `v3` (AVX2 and the fused multiply-add) and `v4`
 * (AVX-512).  names.h gives each function its set's name.  What a program links to is here: the public
 * functions, which jump to those of a set, and the public tables of operations, whose functions do.  Inside
 * a set nothing is chosen any more: a surface that comes in is given the operations of the set (in_set,
 * surface/own.h).
 *
 * The answers are the same bits in all of them: no operation is fused or reordered but where the source
 * says so (meson.build), and sgt_fma is rounded once everywhere.  So it is no matter which set answers, and
 * no lock is needed about the choice: threads that choose at the same time choose the same.
 *
 * Nothing runs before main, and nothing is relocated by the loader for it: static programs, sanitizers and
 * C libraries that know no ifunc are all the same. */
#ifndef SGT_DISPATCH_H
#define SGT_DISPATCH_H

enum { SGT_BASE, SGT_V3, SGT_V4 };

#if SGT_SETS > 1
extern int sgt_chosen_set; /* -1: none yet */
int sgt_choose_set(void);

static inline int sgt_set(void)
{
    int set = __atomic_load_n(&sgt_chosen_set, __ATOMIC_RELAXED);
    return set >= 0 ? set : sgt_choose_set();
}

/* A function of the sets: its type and name, and its parameters; NAME_in_set[sgt_set()] is then the one to
 * call. */
#define SGT_IN_SETS(TYPE, NAME, PARAMETERS) \
    TYPE NAME##_base PARAMETERS;            \
    TYPE NAME##_v3 PARAMETERS;              \
    TYPE NAME##_v4 PARAMETERS;              \
    static TYPE(*const NAME##_in_set[]) PARAMETERS = {NAME##_base, NAME##_v3, NAME##_v4};
#else
static inline int sgt_set(void) { return SGT_BASE; }

#define SGT_IN_SETS(TYPE, NAME, PARAMETERS) \
    TYPE NAME##_base PARAMETERS;            \
    static TYPE(*const NAME##_in_set[]) PARAMETERS = {NAME##_base};
#endif

/* A public function: the same, and its parameters without types. */
#define SGT_DISPATCH(TYPE, NAME, PARAMETERS, ARGUMENTS) \
    SGT_IN_SETS(TYPE, NAME, PARAMETERS)                 \
    TYPE NAME PARAMETERS { return NAME##_in_set[sgt_set()] ARGUMENTS; }
#define SGT_DISPATCH_VOID(NAME, PARAMETERS, ARGUMENTS) \
    SGT_IN_SETS(void, NAME, PARAMETERS)                \
    void NAME PARAMETERS { NAME##_in_set[sgt_set()] ARGUMENTS; }

/* One that no set is faster at. */
#define SGT_EXPORT(TYPE, NAME, PARAMETERS, ARGUMENTS) \
    TYPE NAME##_base PARAMETERS;                      \
    TYPE NAME PARAMETERS { return NAME##_base ARGUMENTS; }

#endif
