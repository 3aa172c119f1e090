// SPDX-License-Identifier: MIT
/* version.c - which version of the library this is: sagitta.h. */
#include <sagitta/sagitta.h>

#define TEXT(x) #x
#define TEXT_OF(x) TEXT(x)

const char *sgt_version(void)
{
    return TEXT_OF(SGT_VERSION_MAJOR) "." TEXT_OF(SGT_VERSION_MINOR) "." TEXT_OF(SGT_VERSION_PATCH);
}

int sgt_version_number(void) { return SGT_VERSION; }
