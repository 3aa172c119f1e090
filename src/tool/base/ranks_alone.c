// SPDX-License-Identifier: MIT
/* ranks_alone.c - a command that works by itself, as `sagitta` does (ranks.h). */
#include "ranks.h"

void ranks_begin(int *argc, char **argv[]) { (void)argc, (void)argv; }
bool ranks_are(void) { return false; }
int ranks_here(void) { return 0; }
int ranks_all(void) { return 1; }
void ranks_alone(void) {}
void ranks_meet(uint64_t digest) { (void)digest; }
void ranks_tell(void *bytes, size_t size) { (void)bytes, (void)size; }
size_t ranks_next(void) { return 0; }
void ranks_wait(void) {}
