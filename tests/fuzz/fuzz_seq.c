// SPDX-License-Identifier: MIT
/* fuzz_seq.c - bytes as a sequence file of CODE V (imported.h).  A prefix of the text, up to the byte that
 * the first byte of the input says in 256ths of its length, is read too: it is a lens or refused, as the
 * whole. */
#include "imported.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    read_imported("a.seq", data + 1, size - 1);
    read_imported("a.seq", data + 1, (size - 1) * data[0] / 256);
    return 0;
}
