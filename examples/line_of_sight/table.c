// SPDX-License-Identifier: MIT
/* table.c - the rows. */
#include "table.h"

#include <math.h>

/* 17 significant digits tell every double from every other. */
static void number(FILE *to, double x)
{
    if (isnan(x)) fputs(",nan", to);
    else fprintf(to, ",%.17g", x);
}

void table_csv(FILE *to, const scan *s)
{
    fputs("line,pixel,seconds,status,latitude,longitude,height,incidence,range,range_err,x,y,z,evals\n", to);
    for (size_t i = 0; i < s->rays; i++) {
        int line = (int)(i / (size_t)s->camera.pixels), pixel = (int)(i % (size_t)s->camera.pixels);
        fprintf(to, "%d,%d", line, pixel);
        number(to, line * s->camera.line_time);
        fprintf(to, ",%s", sgt_status_text((sgt_status)s->status[i]));
        const double row[] = {s->latitude[i],  s->longitude[i], s->height[i], s->incidence[i], s->range[i],
                              s->range_err[i], s->p[0][i],      s->p[1][i],   s->p[2][i]};
        for (size_t j = 0; j < sizeof row / sizeof *row; j++) number(to, row[j]);
        fprintf(to, ",%d\n", s->evals[i]);
    }
}

static void cell(FILE *to, int width, int places, double x)
{
    double scale = pow(10, places), near = round(x * scale) / scale + 0.0; /* no "-0" */
    if (isnan(x)) fprintf(to, "  %*s", width, "-");
    else fprintf(to, "  %*.*f", width, places, near);
}

void table_text(FILE *to, const scan *s)
{
    fprintf(to, "%5s  %5s  %-9s  %11s  %12s  %10s  %9s  %12s  %5s\n", "line", "pixel", "status", "latitude",
            "longitude", "height", "incidence", "range", "evals");
    for (size_t i = 0; i < s->rays; i++) {
        fprintf(to, "%5zu  %5zu  %-9s", i / (size_t)s->camera.pixels, i % (size_t)s->camera.pixels,
                sgt_status_text((sgt_status)s->status[i]));
        cell(to, 11, 7, s->latitude[i]);
        cell(to, 12, 7, s->longitude[i]);
        cell(to, 10, 3, s->height[i]);
        cell(to, 9, 3, s->incidence[i]);
        cell(to, 12, 3, s->range[i]);
        fprintf(to, "  %5d\n", s->evals[i]);
    }
}
