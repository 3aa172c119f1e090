// SPDX-License-Identifier: MIT
/* figure.h - figures of a lens, the residuals that they are made of, and their
 * derivatives by any numbers of its file: what an optimiser asks.  Part of sagitta_lens.
 *
 *     const char *path[] = {"surfaces[1].radius", "surfaces[2].thickness"};
 *     sgt_figure *f = sgt_figure_new(lens, NULL, NULL, 2, path, &error);
 *     double x[2], *r = ..., *j = ...;                 sgt_figure_size(f).residuals of r
 *     sgt_figure_start(f, x);
 *     sgt_figure_eval(f, x, &(sgt_figure_out){.residual = r, .jacobian = j}, &error);
 *
 * A FIGURE IS A NORM.  Of a spot or a wavefront the sum of the squares of all residuals
 * is the mean of rms^2 over the fields, weighted as the lens weighs them.  So a solver
 * for least squares, which halves that sum, makes it as small as can be.
 *
 * WHAT IS DIFFERENTIATED is the figure of the lens with that number in its file: the
 * pupil, the fields and the aim are found anew.  A radius that changes the focal length
 * changes the pupil of an f-number; a ray that is aimed at the stop is aimed again.  The
 * points of the pupil and the weights are held fixed, and so are the fate and the root of
 * each ray.  So the derivative by a number that only moves an edge, such as a
 * semi_diameter, is 0, unless that number sets the size of the pupil.
 *
 * METHOD.  Each ray is traced once forward and once backward (sgt_trace_gradient_batch).
 * That gives the derivatives of its end by all numbers of all elements and of the launch
 * ray; those by numbers of phases are asked where one moves (sgt_phase_gradient).  How a
 * number of the file moves these needs no ray: the lens is made anew at x - h and x + h.
 * Where its numbers do not lie on a line, it is also made at x - 2h and x + 2h, for
 * differences of the fourth order (src/lens/figure/motion.c).  What depends on x
 * linearly (a thickness, a coefficient, a decentre; a radius is taken by its reciprocal)
 * is exact to rounding, the rest (angles, glass, pupils) to some 1e-11.
 * Of an aimed ray the point at the stop is held fixed, so it is also traced backward from
 * the stop.
 *
 * NOT DIFFERENTIATED.  An error names the path, and says why:
 *   - whole numbers and words; an infinite radius (vary `curvature` in its place)
 *   - normalisations and steps of surfaces and of phases
 *   - weights of fields and wavelengths; of "opd", a wavelength
 *   - what has no parameters for derivatives (sensitivity.h): julia, heights of a grid
 *   - "opd" of a lens with an ideal lens or facets on it: what their path is depends on
 *     further numbers
 *   - an afocal lens has no figures here; "distortion" needs a plane of symmetry through
 *     the field and the axis
 *
 * ERRORS.  value_err of spots and chief rays follows from the bounds of their rays, as in
 * study.h; of the other figures it estimates the rounding.  gradient_err and what is said
 * of the differences above are estimates, which tests hold to differences of whole
 * figures, in 113 bits as well (tests/sensitivity/test_figures.cpp). */
#ifndef SAGITTA_FIGURE_H
#define SAGITTA_FIGURE_H
#include <sagitta/edit.h>
#include <sagitta/study.h>
#ifdef __cplusplus
extern "C" {
#endif

typedef enum sgt_figure_kind {
    /* Residuals: x and y of each ray at the image, from the reference, in the order of
     * fields, wavelengths, points, x before y.  0 of a ray that is clipped; NaN of one
     * that is lost in another way.  Values: rms of each field, as the row of all
     * wavelengths of "spot" has it, then the root of their mean square. */
    SGT_FIGURE_SPOT,
    /* The same of path differences in waves, less their mean.  Values: rms of each field
     * and wavelength, as "wavefront" has it, then the root of their mean square. */
    SGT_FIGURE_OPD,
    /* x and y of the chief ray of each field and wavelength at the image. */
    SGT_FIGURE_CHIEF,
    /* The focal length (sgt_first_order.efl) at each wavelength. */
    SGT_FIGURE_EFL,
    /* (height - ideal) / ideal of the chief ray of each field and wavelength, with
     * SGT_DISTORTION_TAN.  On the axis the value is NaN and the residual 0. */
    SGT_FIGURE_DISTORTION
} sgt_figure_kind;

/* Zeros are the defaults. */
typedef struct sgt_figure_options {
    sgt_figure_kind kind;
    int  reference;      /* spot: 0 chief: the chief ray of the primary wavelength; 1
                            centroid: the mean of the rays of all wavelengths */
    unsigned long long reserved_[6]; /* leave it zero */
} sgt_figure_options;

typedef struct sgt_figure sgt_figure;

/* A figure of a copy of the lens, by `paths` of its numbers (edit.h).
 *
 *     study  which fields, wavelengths and points of the pupil.  NULL and zeros are the
 *            defaults of the analysis: "spot", "wavefront", of the others "field".  What
 *            it points to has to last.  `run` is not called
 *     opt    which figure
 *     paths  how many paths there are
 *     path   of the numbers that the figure is differentiated by, in their units
 *
 * NULL: `error` (may be NULL) says why: no number stands at a path, or two paths are of
 * the same number. */
SGT_API sgt_figure *sgt_figure_new(const sgt_lens *lens, const sgt_study_options *study,
                                   const sgt_figure_options *opt, size_t paths,
                                   const char *const path[], sgt_error *error);
SGT_API void        sgt_figure_free(sgt_figure *figure); /* NULL: nothing */

typedef struct sgt_figure_count {
    size_t paths, residuals, values;
    unsigned long long reserved_[4];
} sgt_figure_count;

SGT_API sgt_figure_count sgt_figure_size(const sgt_figure *figure);

/* The numbers at the paths, as the figure's lens has them. */
SGT_API void sgt_figure_start(const sgt_figure *figure, double x[]);

/* What is wanted, and what was done.  An array that is NULL is not wanted, and not worked
 * out.  Begin with zeros. */
typedef struct sgt_figure_out {
    double *residual;      /* [residuals] */
    double *jacobian;      /* [residuals * paths], a row for each residual */
    double *value;         /* [values] */
    double *value_err;     /* [values] */
    double *gradient;      /* [values * paths], a row for each value */
    double *gradient_err;  /* [values * paths] */
    size_t  rays;          /* traced, with chief rays */
    size_t  clipped, lost; /* whose residuals are 0, and NaN */
    size_t  backward;      /* how many went back as well */
    unsigned long long reserved_[6]; /* leave it zero */
} sgt_figure_out;

/* Puts the numbers x[paths] into the figure's lens, and computes what `out` asks for.
 * x NULL: the numbers stay as they are.  false: `error` (may be NULL) says why; if the
 * reader refuses the numbers, the lens stays as it was.  Make only one call at a time for
 * one figure. */
SGT_API bool sgt_figure_eval(sgt_figure *figure, const double x[], sgt_figure_out *out,
                             sgt_error *error);

/* The figure's lens, with the numbers of the last call that was not refused: as it may be
 * written by sgt_lens_yaml.  It goes with the figure; do not edit it. */
SGT_API sgt_lens *sgt_figure_lens(sgt_figure *figure);

#ifdef __cplusplus
}
#endif
#endif /* SAGITTA_FIGURE_H */
