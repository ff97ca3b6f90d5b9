#pragma once

#include <CLI/App.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "firmware/exit_codes.h"

// Parses the command lines of all programs in the same way. A program declares its commands and options as a CLI::App;
// usage, --help, --version, --completion and errors follow from this declaration. The type name of an option tells the
// reader of --help and the completion what the value is: FILE, PATH (file or folder), DIR, DEVICE, or a choice of words
// as choice_name() writes it, {a,b}. A text after the brace, as in {a,b}=MS, is part of the value.
namespace touchline {

struct Example {
  std::string command;  // command line as a person types it
  std::string meaning;  // first word in lower case, no period
};

/// Ends the help of a program or command with a section of examples and with `notes`, such as exit codes.
void add_examples(CLI::App& app, std::initializer_list<Example> examples, const std::string& notes = {});

/// Accepts only these words. The error for another word suggests the nearest one.
CLI::Validator one_of(std::vector<std::string> words);

/// Returns "{a,b}", the type name of an option whose value begins with one of these words.
std::string choice_name(const std::vector<std::string>& words);

/// Adds --version and --completion, and parses the command line of a program into the variables that are bound to
/// `app`. An empty result means: continue. Otherwise the help, the version, a completion script or an error has been
/// printed, and the value is the exit code: kExitOk, kExitBadFile if standard output cannot be written, or
/// kExitBadCommandLine. An unknown word is reported first, with the nearest known one, because options may be missing
/// only because of it.
std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv);

}  // namespace touchline
