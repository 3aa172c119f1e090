// SPDX-License-Identifier: MIT
/* The header, meson.build and the library are of one version. */
#include <sagitta/sagitta.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    char header[40];
    snprintf(header, sizeof header, "%d.%d.%d", SGT_VERSION_MAJOR, SGT_VERSION_MINOR, SGT_VERSION_PATCH);
    int faults = strcmp(header, PROJECT_VERSION) != 0;
    faults += strcmp(sgt_version(), PROJECT_VERSION) != 0;
    faults += sgt_version_number() != SGT_VERSION;
#if SGT_VERSION < 200
    faults++; /* it can be read by the preprocessor */
#endif
    printf("header %s, meson.build %s, library %s and %d: %d faults\n", header, PROJECT_VERSION,
           sgt_version(), sgt_version_number(), faults);
    return faults;
}
