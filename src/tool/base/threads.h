// SPDX-License-Identifier: MIT
/* threads.h - OpenMP, where the command is built with it. */
#ifndef TOOL_THREADS_H
#define TOOL_THREADS_H

/* THREADS(omp ...) is `#pragma omp ...`, or nothing without OpenMP. */
#ifdef _OPENMP
#define THREADS(words) _Pragma(#words)
#else
#define THREADS(words)
#endif

#endif
