// SPDX-License-Identifier: MIT
/* sagitta_batch.c - many rays on a conic or through a row of conics, for Octave and MATLAB: a MEX file.
 *
 *     mkoctfile --mex sagitta_batch.c $(pkg-config --cflags --libs sagitta)
 *
 *     [status, t, t_err, p] = sagitta_batch(o, d, conic)
 *     [fate, o, d, opl] = sagitta_batch(o, d, lens, index_before)
 *
 * o and d have a row for each ray.  A conic is a row [c, k, semi_diameter].  A lens has a row for each
 * surface, [c, k, semi_diameter, z, index].  Columns of a matrix are contiguous, so no number is copied. */
#include <mex.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>

static sgt_rays rays_of(const mxArray *o, const mxArray *d, size_t n)
{
    sgt_rays rays = {.o = {0}};
    for (size_t j = 0; j < 3; j++) {
        rays.o[j] = mxGetPr(o) + j * n;
        rays.d[j] = mxGetPr(d) + j * n;
    }
    return rays;
}

static void columns(mxArray *of, size_t n, double *to[3])
{
    for (size_t j = 0; j < 3; j++) to[j] = mxGetPr(of) + j * n;
}

static mxArray *numbers(size_t rows, size_t columns_count)
{
    return mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns_count, mxREAL);
}

/* Bytes: sgt_status or sgt_fate. */
static mxArray *codes(size_t n)
{
    return mxCreateNumericMatrix((mwSize)n, 1, mxINT8_CLASS, mxREAL);
}

static void intersect(mxArray *out[], sgt_rays rays, size_t n, const double row[3])
{
    sgt_conic shape = {.c = row[0], .k = row[1], .semi_diameter = row[2]};
    sgt_hits hits = {.status = NULL};
    out[0] = codes(n), hits.status = mxGetData(out[0]);
    out[1] = numbers(n, 1), hits.t = mxGetPr(out[1]);
    out[2] = numbers(n, 1), hits.t_err = mxGetPr(out[2]);
    out[3] = numbers(n, 3), columns(out[3], n, hits.p);
    sgt_intersect_batch((sgt_surface){&sgt_conic_ops, &shape}, n, rays, hits, NULL);
}

static void trace(mxArray *out[], sgt_rays rays, size_t n, const mxArray *table, double index_before)
{
    size_t count = mxGetM(table);
    const double *at = mxGetPr(table);
    /* From mxCalloc: given back by itself, also after an error. */
    sgt_conic *shapes = mxCalloc(count, sizeof *shapes);
    sgt_element *lens = mxCalloc(count, sizeof *lens);
    for (size_t i = 0; i < count; i++) {
        shapes[i] = (sgt_conic){.c = at[i], .k = at[count + i]};
        lens[i] = (sgt_element){.surface = {&sgt_conic_ops, &shapes[i]},
                                .pose = {.origin = {0, 0, at[3 * count + i]}},
                                .index = at[4 * count + i],
                                .semi_diameter = at[2 * count + i]};
    }
    sgt_traced ends = {.fate = NULL};
    out[0] = codes(n), ends.fate = mxGetData(out[0]);
    out[1] = numbers(n, 3), columns(out[1], n, ends.o);
    out[2] = numbers(n, 3), columns(out[2], n, ends.d);
    out[3] = numbers(n, 1), ends.opl = mxGetPr(out[3]);
    sgt_trace_batch(count, lens, index_before, n, rays, ends, NULL, NULL);
    mxFree(lens);
    mxFree(shapes);
}

static bool is_table(const mxArray *a, size_t columns_count)
{
    return mxIsDouble(a) && !mxIsComplex(a) && mxGetNumberOfDimensions(a) == 2 && mxGetN(a) == columns_count;
}

void mexFunction(int outputs, mxArray *out[], int inputs, const mxArray *in[])
{
    if (inputs < 3 || inputs > 4 || outputs > 4 || !is_table(in[0], 3) || !is_table(in[1], 3) ||
        mxGetM(in[0]) != mxGetM(in[1]))
        mexErrMsgTxt("sagitta_batch(o, d, conic) or sagitta_batch(o, d, lens, index_before): o and d have a "
                     "row of three for each ray");
    size_t n = mxGetM(in[0]);
    mxArray *all[4];
    sgt_rays rays = rays_of(in[0], in[1], n);
    if (inputs == 3) {
        if (!is_table(in[2], 3) || mxGetM(in[2]) != 1) mexErrMsgTxt("a conic is [c, k, semi_diameter]");
        intersect(all, rays, n, mxGetPr(in[2]));
    } else {
        if (!is_table(in[2], 5) || !is_table(in[3], 1) || mxGetM(in[3]) != 1)
            mexErrMsgTxt("a lens has rows [c, k, semi_diameter, z, index]; index_before is one number");
        trace(all, rays, n, in[2], mxGetScalar(in[3]));
    }
    for (int i = 0; i < 4; i++) {
        if (i < outputs || i == 0)
            out[i] = all[i];
        else
            mxDestroyArray(all[i]);
    }
}
