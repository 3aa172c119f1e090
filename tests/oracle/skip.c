// SPDX-License-Identifier: MIT
/* Stands for a test that cannot be built here, and says why. */
#include <stdio.h>

int main(int argc, char **argv)
{
    printf("skipped: %s\n", argc > 1 ? argv[1] : "no reason given");
    return 77;
}
