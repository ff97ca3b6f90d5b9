#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/parse_arguments.h"

// Options and messages that the command lines of all tools have in common.
namespace touchline {

/// Prints "PROGRAM: MESSAGE" to standard error and returns `exit_code`.
int fail(std::string_view program, std::string_view message, int exit_code = kExitBadFile);

/// Adds the repeatable option --set KEY=VALUE. `files` names the files whose keys the option overrides, for example
/// "the board file".
CLI::Option* add_overrides(CLI::App& app, std::vector<std::string>& overrides, const std::string& files);

/// Returns what is wrong if options of the program stand before `command`, which does not use them; "" if none do.
std::string ignored_option(const CLI::App& app, const CLI::App& command);

/// Accepts a number from `low` to `high`. Unlike CLI::Range it rejects "nan", which is not below or above any limit.
CLI::Validator number_range(double low, double high);

/// Accepts the name of a file with one of these endings, for example ".svg".
CLI::Validator name_ending(std::vector<std::string> endings);

}  // namespace touchline
