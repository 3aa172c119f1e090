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
void ranks_tell_text(char **text, size_t *length) { (void)text, (void)length; }
ranks_file *ranks_open(const char *path, const char *name) { return (void)path, (void)name, NULL; }
void ranks_write(ranks_file *f, size_t at, const void *bytes, size_t size)
{
    (void)f, (void)at, (void)bytes, (void)size;
}
void ranks_close(ranks_file *f) { (void)f; }
size_t ranks_next(void) { return 0; }
void ranks_serve(void) {}
void ranks_wait(void) {}
