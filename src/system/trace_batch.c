/* trace_batch.c - many rays through a row of surfaces. */
#include <sagitta/system.h>

#include <math.h>
#include <string.h>

enum { MOST_TOLD = 64 };

static void write_passage(const sgt_passages *out, size_t i, const sgt_passage *p)
{
    const sgt_hits *h = &out->hits;
    if (h->status) h->status[i] = (signed char)p->hit.status;
    if (h->evals) h->evals[i] = p->hit.evals;
    if (h->t) h->t[i] = p->hit.t;
    if (h->t_err) h->t_err[i] = p->hit.t_err;
    if (h->t_lo) h->t_lo[i] = p->hit.t_lo;
    if (h->p[0]) h->p[0][i] = p->hit.p.x, h->p[1][i] = p->hit.p.y, h->p[2][i] = p->hit.p.z;
    if (h->n[0]) h->n[0][i] = p->hit.n.x, h->n[1][i] = p->hit.n.y, h->n[2][i] = p->hit.n.z;
    if (h->p_err) h->p_err[i] = p->hit.p_err;
    if (out->direction[0]) out->direction[0][i] = p->direction.x, out->direction[1][i] = p->direction.y, out->direction[2][i] = p->direction.z;
    if (out->opl) out->opl[i] = p->opl;
}

size_t sgt_trace_batch(size_t elements, const sgt_element e[], double index_before, size_t n, sgt_rays rays,
                       sgt_traced out, const sgt_passages passages[], const sgt_options *opt)
{
    size_t all = 0;
    const double none = (double)NAN;
    const sgt_passage nothing = {.hit = {.status = SGT_MISS, .t = none, .t_err = none, .t_lo = none, .p = {none, none, none}, .n = {none, none, none}, .p_err = none}, .opl = none};
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {{rays.o[0][i], rays.o[1][i], rays.o[2][i]}, {rays.d[0][i], rays.d[1][i], rays.d[2][i]}, 0, 0};
        sgt_passage p[MOST_TOLD];
        sgt_fate fate = SGT_PASSED;
        size_t passed = sgt_trace(elements < MOST_TOLD ? elements : MOST_TOLD, e, index_before, &ray, p, &fate, opt);
        for (size_t j = 0; passages && j < elements; j++) write_passage(&passages[j], i, j < passed + (fate != SGT_PASSED) ? &p[j] : &nothing);
        if (out.fate) out.fate[i] = (signed char)fate;
        if (out.passed) out.passed[i] = (int)passed;
        if (out.o[0]) out.o[0][i] = ray.o.x, out.o[1][i] = ray.o.y, out.o[2][i] = ray.o.z;
        if (out.d[0]) out.d[0][i] = ray.d.x, out.d[1][i] = ray.d.y, out.d[2][i] = ray.d.z;
        if (out.opl) out.opl[i] = passed ? p[passed - 1].opl : 0;
        all += passed == elements;
    }
    return all;
}
