/* commands.h - the subcommands.  Each takes its own arguments; argv[0] is its name in messages
 * ("sagitta trace").  Each returns the exit status. */
#ifndef TOOL_COMMANDS_H
#define TOOL_COMMANDS_H
#include "../base/fail.h"

exit_status command_intersect(int argc, char *argv[]);
exit_status command_trace(int argc, char *argv[]);
exit_status command_diagnose(int argc, char *argv[]);
exit_status command_trade(int argc, char *argv[]);
exit_status command_info(int argc, char *argv[]);
exit_status command_import(int argc, char *argv[]);
exit_status command_spot(int argc, char *argv[]);
exit_status command_fan(int argc, char *argv[]);
exit_status command_opd(int argc, char *argv[]);
exit_status command_field(int argc, char *argv[]);
exit_status command_map(int argc, char *argv[]);
exit_status command_sweep(int argc, char *argv[]);

#endif
