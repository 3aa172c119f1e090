// SPDX-License-Identifier: MIT
/* edit.h - a lens that was read is a value that can be edited: copied, asked for any
 * number of its file, and changed.
 *
 * PATHS.  A path is a place in the lens file (docs/lens_file.md): keys with a point
 * between, and in brackets the place in a list, counted from 1.
 *
 *     surfaces[3].thickness      surfaces["front"].radius    surfaces[2].coefficients[1]
 *     pupil.f_number             object.distance             fields[2]    wavelengths[1]
 *     surfaces[4].apertures[1].radius        breaks[1].tilt[1]        fields[2][1]
 *
 * Surfaces are counted as everywhere, without breaks; breaks[1] is the first break.  A
 * surface can also be given by its name, in "double" or 'single' quotes or in none.  A
 * file of one surface (sgt_lens_read_surface) has paths such as radius.
 *
 * AN EDIT changes the tree that the file was read into, and then makes the lens anew from
 * it, by the reader of files.  So every check of the reader holds.  The lens is that of
 * its written file (sgt_lens_yaml) read anew, to the bit; only lines differ.  If the
 * reader refuses the new tree, the lens stays as it was in every bit; error->key is then
 * the path, and error->words says what is wrong.
 *
 * An edit reads with the sgt_lens_options with which the lens was read.  So what these
 * point to (types, glasses, context) must last as long as the lens is edited.  A glass
 * that was found by its name is looked up again only if `makers` changes.
 *
 * POINTERS to what a lens has (elements, texts, sgt_lens_yaml) are good until an edit of
 * it succeeds; the lens itself stays where it is.
 *
 * THREADS.  Functions that take a const lens may run in any number of threads at once.
 * An edit needs the lens for itself.  A lens and its copy share nothing but the options.
 *
 *     sgt_error error;
 *     double t;
 *     if (sgt_lens_get(lens, "surfaces[6].thickness", &t, &error) &&
 *         sgt_lens_set(lens, "surfaces[6].thickness", t + 0.1, &error)) ...
 *     else printf("%s: %s\n", error.key, error.words); */
#ifndef SAGITTA_EDIT_H
#define SAGITTA_EDIT_H
#include <sagitta/lens.h>
#ifdef __cplusplus
extern "C" {
#endif

/* The same lens once more, by the same allocator.  NULL: no memory; `error` (may be NULL,
 * here and below) says so. */
SGT_API sgt_lens *sgt_lens_copy(const sgt_lens *lens, sgt_error *error);

/* The number at a path, as the file has it.  A wavelength that is given by the name of a
 * spectral line has its number.  The radius where a curvature is given is 1 / curvature,
 * and the other way round.  false: there is none; *x is then NaN. */
SGT_API bool sgt_lens_get(const sgt_lens *lens, const char *path, double *x,
                          sgt_error *error);

/* What stands at a path, as YAML in one line.  Returns the length of the whole text,
 * without its zero byte.
 *
 *     room  how many bytes `text` has, the zero byte included; 0: nothing is written
 *     text  written: as much as fits, with a zero byte at its end
 *
 * SIZE_MAX: nothing stands there, or memory ran out. */
SGT_API size_t sgt_lens_get_text(const sgt_lens *lens, const char *path, size_t room,
                                 char text[], sgt_error *error);

/* Sets the number at a path.  If the file does not have the key, it is added, with the
 * maps on the way to it.  If another key says the same in another way, that key is
 * removed: radius or curvature, index or glass, one of the sizes of the pupil.
 * false: refused. */
SGT_API bool sgt_lens_set(sgt_lens *lens, const char *path, double x, sgt_error *error);

/* The same of a value in YAML: "12.5", "N-BK7", "true", "[0, 5, 7]",
 * "{type: sphere, radius: 20, thickness: 3, glass: air}". */
SGT_API bool sgt_lens_set_text(sgt_lens *lens, const char *path, const char *yaml,
                               sgt_error *error);

/* Inserts a value in YAML into a list, in front of the entry that is at the path.  To
 * append it, give the place behind the last entry.  Pickups and tolerances that name
 * surfaces by number are renumbered, so that they refer to the same surfaces as before;
 * so they are by the edits below.  Those within the new value count the new surface. */
SGT_API bool sgt_lens_insert(sgt_lens *lens, const char *path, const char *yaml,
                             sgt_error *error);

/* Removes an entry of a list, or a key.  It is refused as well (false) if a pickup or a
 * tolerance refers to it. */
SGT_API bool sgt_lens_remove(sgt_lens *lens, const char *path, sgt_error *error);

/* Turns the surfaces `first` to `last` ("surfaces[2]", or by name) front to back: their
 * order, the thicknesses and media between them, their shapes, tilts and decentres.  It
 * mirrors the group in a plane z = const; for surfaces that are symmetric in x that is to
 * turn it.  What stands in front of the group and behind it stays, and so do the last
 * thickness and the last medium.  It is refused as well (false) if the group has a break,
 * a mirror, an `origin`, a surface that is not a sag, a sag from a file, or a surface
 * that a tolerance refers to. */
SGT_API bool sgt_lens_reverse(sgt_lens *lens, const char *first, const char *last,
                              sgt_error *error);

/* Makes the whole lens larger by a positive factor: every length of it, and every number
 * whose unit has a power of length.  Wavelengths stay.  It is refused as well (false) if
 * the lens has a formula, a level set, or numbers in another file. */
SGT_API bool sgt_lens_scale(sgt_lens *lens, double factor, sgt_error *error);

typedef enum sgt_edit_kind {
    SGT_EDIT_SET,      /* number is the new value */
    SGT_EDIT_SET_TEXT, /* text is, in YAML */
    SGT_EDIT_INSERT,   /* text is the value, in YAML */
    SGT_EDIT_REMOVE,
    SGT_EDIT_REVERSE,  /* path is the first surface, text the last */
    SGT_EDIT_SCALE     /* number is the factor; no path */
} sgt_edit_kind;

/* One of several edits, as the functions above make them.  Begin with zeros. */
typedef struct sgt_edit {
    sgt_edit_kind kind;
    const char   *path;
    double        number;
    const char   *text;
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_edit;

/* Makes several edits one after the other, and then the lens once: between them the tree
 * need not be that of a lens, but in front of SGT_EDIT_SCALE.  If one edit is refused,
 * none is made.  The fastest way to set many numbers. */
SGT_API bool sgt_lens_edit(sgt_lens *lens, size_t count, const sgt_edit edit[],
                           sgt_error *error);

/* A number of a lens and its path. */
enum { SGT_PATH_SIZE = 128 };
typedef struct sgt_lens_path {
    char   path[SGT_PATH_SIZE];
    double value;
    unsigned long long reserved_[4];
} sgt_lens_path;

/* Sets at[0 ... most - 1] to the first numbers of a lens that its file gives, in the
 * order of the file, and returns how many there are.  Those are the numbers that the
 * reader has read: not what a name or a label looks like, not what is left to its
 * default, not what stands in another file.  (A number whose path is longer is left out:
 * the name of a parameter of a formula can be of any length.) */
SGT_API size_t sgt_lens_paths(const sgt_lens *lens, size_t most, sgt_lens_path at[]);

/* ---------------------------------------------------------------- configurations
 *
 * A lens file can have `configurations`: positions of a zoom, say.  Each is a list of
 * edits of the values that the file has besides: paths, and the values that are put
 * there.
 *
 *     configurations:
 *       - name: wide
 *         surfaces[4].thickness: 2.5
 *       - name: tele
 *         surfaces[4].thickness: 11
 *
 * sgt_lens_read gives the lens of the file's own values, with all configurations beside
 * it. (sgt_lens_options.configuration asks for one of them instead.)  Each was made once
 * when the lens was read, so that all of them are lenses; after an edit they are again.
 *
 * An edit that moves surfaces writes the numbers in the paths anew, as it does those of
 * pickups.  It is refused if a configuration sets what it removes, sets a place of
 * another list that it moves, or a surface that it turns; sgt_lens_scale is refused if
 * there are configurations. */

/* How many there are; 0: the file has none. */
SGT_API size_t sgt_lens_configurations(const sgt_lens *lens);

/* The name of configuration `number`, from 1; "" where not given, or there is none.  It
 * is good until an edit succeeds. */
SGT_API const char *sgt_lens_configuration_name(const sgt_lens *lens, size_t number);

/* The number of the configuration with this name; or that number itself in digits, if
 * there is such a configuration.  0: there is none, and `error` (may be NULL) says which
 * are. */
SGT_API size_t sgt_lens_configuration_named(const sgt_lens *lens, const char *name,
                                            sgt_error *error);

/* The lens of a configuration, from 1, by the same allocator.  In every bit it is the
 * lens of a file that has these values and no configurations.  NULL: there is none of
 * that number, or no memory; `error` (may be NULL) says which. */
SGT_API sgt_lens *sgt_lens_configured(const sgt_lens *lens, size_t number,
                                      sgt_error *error);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_EDIT_H */
