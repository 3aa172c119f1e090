// SPDX-License-Identifier: MIT
// cliff_search.h - the search for input that costs many times the usual (its head: cliff_search.cpp).
#ifndef CLIFF_SEARCH_H
#define CLIFF_SEARCH_H
#include <cstdint>
#include <string>

// Prints the worst fifty cases that `seconds` of search find.  brief: only the row of docs/data/ordinary.md.
int search_for_cliffs(double seconds, uint64_t seed, const std::string &only_type, bool brief);

// Runs the one case that such a line tells again.
int run_case(const std::string &line);

#endif
