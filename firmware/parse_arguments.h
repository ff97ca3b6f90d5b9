#pragma once

#include <CLI/App.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "firmware/exit_codes.h"

// What the command lines of all programs have in common. A program declares its commands and options as a CLI::App;
// usage, --help, --version, --completion and errors follow from this declaration. The type name of an option says what
// its value is, for the reader of --help and for completion: FILE, PATH (file or folder), DIR, DEVICE, or words as
// one_of() shows them, {a,b}; a text after the brace, as in {a,b}=MS, belongs to the value.
namespace touchline {

struct Example {
  std::string command;  // as it is typed
  std::string meaning;  // first word in lower case, no period
};

/// Ends the help of a program or command with a section of examples and with `notes`, such as exit codes.
void add_examples(CLI::App& app, std::initializer_list<Example> examples, const std::string& notes = {});

/// Accepts one of these words, and names the nearest one otherwise.
CLI::Validator one_of(std::vector<std::string> words);

/// "{a,b}", the type name of an option whose value begins with one of these words.
std::string choice_name(const std::vector<std::string>& words);

/// Adds --version and --completion, and parses the command line of a program into the variables that are bound to
/// `app`. Empty: continue. Otherwise the help, the version, a completion script or an error has been printed, and the
/// value is the exit code: kExitOk, kExitBadFile if standard output cannot be written, or kExitBadCommandLine. A word
/// that the program does not know is named, with the nearest one that it knows, before anything that is missing because
/// of it.
std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv);

}  // namespace touchline
