// SPDX-License-Identifier: MIT
/* lens.h - a lens as a command uses it: that of a file, at one wavelength. */
#ifndef TOOL_LENS_H
#define TOOL_LENS_H
#include "../base/fail.h"

#include <sagitta/edit.h>
#include <stdbool.h>

typedef struct lens {
    sgt_lens *of;             /* as the file gives it */
    const char *name, *units; /* "" where not given */
    size_t chosen;            /* which of its wavelengths, from 1; 0: none, `wavelength` is another */
    double wavelength;        /* the chosen one, in micrometres; NaN: the file gives none */
    double index_before;
    size_t count;
    const sgt_element *element; /* [count], at the chosen wavelength */
    double *index;            /* [count]: behind each, positive, after a mirror too */
    const sgt_lens_surface *surface; /* [count] */
    size_t configuration;     /* of --configuration all, from 1; else 0 */
    const char *configuration_name; /* then; "" where not given */
} lens;

/* Which wavelength: place counts from 1; 0: `um`, or (NaN) the primary one of the file. */
typedef struct lens_wavelength { size_t place; double um; } lens_wavelength;

/* --glass: a catalogue, or a folder of them, whose glasses go before those that ship. */
void lens_glass_folder(const char *path);

/* --configuration: a number from 1, a name, or all. */
void lens_configuration(const char *which);

/* Those of --configuration all, each with the edits that are asked for.  Of anything else count is 0, and
 * lens_open opens the one. */
typedef struct lens_each { size_t count; sgt_lens **at; const char **name; } lens_each;
lens_each lens_open_each(const char *path);

/* "Configurations: 1 wide, 2 middle, 3 tele." */
const char *lens_each_line(const lens_each *all);

/* --strict: what a reader leaves out, and a wavelength outside the range of a glass, are errors. */
void lens_be_strict(void);

/* Edits, one after another; all are made together of each lens that is opened. */
void lens_edit(sgt_edit one);

/* The same of PATH=VALUE, as --set and --insert have it. */
void lens_edit_value(sgt_edit_kind kind, const char *option, const char *text);

/* From now on what a reader remarks of a lens is not printed.  Errors, and what --strict refuses, are. */
void lens_be_quiet(void);
bool lens_quiet(void);

/* Any error ends the command, with file, line and key in the message.  What a user should know of the lens is
 * noted on standard error. */
sgt_lens *lens_open(const char *path);

/* For who writes the file: with --configuration all the lens of its own values, and all of them beside it. */
sgt_lens *lens_open_whole(const char *path);

/* The lens at a wavelength.  Notes glasses that are used outside their ranges. */
lens lens_at(sgt_lens *of, lens_wavelength at);
void lens_note_no_ranges(void); /* from now on */

/* Notes, once, that the last surface bends light: what is said of the image is then said of it. */
void lens_note_image(const sgt_lens *of);

/* Writes it as a lens file (NULL: to standard output). */
void lens_write(sgt_lens *of, const char *path);

/* Before anything is read: refuses a name that is one of other programs' files.  path may be NULL. */
void lens_write_check(const char *option, const char *path);

/* The same of text; nothing is noted. */
lens lens_of_text(const char *name, const char *text);

/* Ends the command by what is wrong with a file: "FILE:LINE: KEY: words". */
_Noreturn void lens_refuse(const sgt_error *e);

/* The same of a lens that was read, where the line is that of its beginning. */
_Noreturn void lens_fail(const lens *l, const char *key, const char *format, ...) LIKE_PRINTF(3, 4);

/* The text of a surface that is a formula, and its parameters: of any lens that lens_keep has.  false: it is
 * none. */
bool lens_formula_of(sgt_surface s, const char **text, const sgt_named **parameter, size_t *count);

/* Frees it when the command ends. */
sgt_lens *lens_keep(sgt_lens *l);

/* Files through base/input.h, and the types about the Earth where they are built in. */
sgt_lens_options lens_options(void);

/* Which wavelength is the primary one, for the text under a table; NULL: the lens has one or none. */
const char *lens_primary(const sgt_lens *of);

#endif
