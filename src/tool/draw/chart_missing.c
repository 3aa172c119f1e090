/* chart_missing.c - in the place of chart.c where there is no cairo. */
#include "chart.h"

#include "../base/fail.h"

void chart_check(const char *option, const char *path)
{
    (void)path;
    fail_usage("--%s needs cairo, which this command was built without", option);
}

void chart_write(const char *path, const chart *c)
{
    (void)path, (void)c;
}
