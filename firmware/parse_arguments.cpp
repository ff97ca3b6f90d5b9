#include "firmware/parse_arguments.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/wording.h"

namespace touchline {
namespace {

// "--bord" of "--bord=x".
std::string option_of(const std::string& argument) { return argument.substr(0, argument.find('=')); }

bool is_option(const std::string& argument) { return argument.size() > 1 && argument[0] == '-'; }

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

// Another command of the program that has this option: "touchline run".
std::string command_with(const CLI::App& program, const std::string& option) {
  for (const CLI::App* command : program.get_subcommands(nullptr)) {
    for (const std::string& name : options_of(*command)) {
      if (name == option) return program.get_name() + " " + command->get_name();
    }
  }
  return {};
}

// What is wrong with the first word that nothing has taken; "" if every word was.
std::string unknown_word(const CLI::App& program) {
  const std::vector<std::string> unknown = program.remaining(true);
  if (unknown.empty()) return {};
  const CLI::App* here = &program;
  while (!here->get_subcommands().empty()) here = here->get_subcommands().front();
  const bool looks_like_option = is_option(unknown.front());
  const std::string word = looks_like_option ? option_of(unknown.front()) : unknown.front();
  const std::vector<std::string> names = looks_like_option ? options_of(*here) : commands_of(*here);
  const std::vector<std::string_view> known(names.begin(), names.end());
  std::string text = here == &program ? "" : here->get_name() + ": ";
  text += "\"" + word + "\" is ";
  if (!looks_like_option && known.empty()) return text + "one word too many";
  text += looks_like_option ? "no option" : "no command";
  if (const std::string other = looks_like_option ? command_with(program, word) : ""; !other.empty()) {
    return text + " here, but one of " + other;
  }
  return text + config::suggestion(word, known, looks_like_option ? "options" : "commands");
}

}  // namespace

std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 reports --help and --version as errors with code 0.
    const bool asks = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
    const std::string unknown = asks ? std::string() : unknown_word(app);
    if (unknown.empty()) return app.exit(error) == 0 ? kExitOk : kExitBadCommandLine;
    std::cerr << app.get_name() << ": " << unknown << "\nRun with --help for more information.\n";
    return kExitBadCommandLine;
  }
  return std::nullopt;
}

}  // namespace touchline
