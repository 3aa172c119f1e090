// SPDX-License-Identifier: MIT
/* commands.h - the commands, each with its options and what runs it. */
#ifndef TOOL_COMMANDS_H
#define TOOL_COMMANDS_H
#include "../job/parse.h"

extern const command command_intersect, command_trace, command_diagnose, command_trade, command_info,
    command_import, command_edit, command_join, command_spot, command_fan, command_opd, command_field,
    command_map, command_sweep, command_tolerance, command_prove;

/* (main.c) Is there a command of that name? */
bool command_named(const char *name, command *c);

#endif
