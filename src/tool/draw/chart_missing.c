// SPDX-License-Identifier: MIT
/* chart_missing.c - replaces the files of a chart if there is no cairo. */
#include "../base/fail.h"
#include "chart.h"

void chart_check(const char *option, const char *path)
{
    fail_usage("--%s %s: not available; this command was built without cairo", option, path);
}

void chart_write(const char *path, const chart *c)
{
    (void)c;
    chart_check("picture", path);
}
