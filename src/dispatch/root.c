// SPDX-License-Identifier: MIT
/* root.c - the solver as a program drives it, and words for what it says: sagitta.h. */
#include "dispatch.h"

#include <sagitta/sagitta.h>

SGT_EXPORT(sgt_root, sgt_root_begin, (sgt_span span, const sgt_options *opt), (span, opt))
SGT_EXPORT(bool, sgt_root_next, (sgt_root * r, double g, double slope), (r, g, slope))
SGT_EXPORT(const char *, sgt_status_text, (sgt_status status), (status))
SGT_EXPORT(const char *, sgt_move_text, (sgt_move move), (move))
