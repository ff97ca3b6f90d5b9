#include "firmware/parse_arguments.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/completion.h"
#include "firmware/config/wording.h"

namespace touchline {
namespace {

// Returns the name of an option: "--bord" of "--bord=x".
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

// Returns another command of the program that has this option, such as "touchline run".
std::string command_with(const CLI::App& program, const std::string& option) {
  for (const CLI::App* command : program.get_subcommands(nullptr)) {
    for (const std::string& name : options_of(*command)) {
      if (name == option) return program.get_name() + " " + command->get_name();
    }
  }
  return {};
}

// Says what is wrong with the first word that no option or command has taken; "" if all words were taken.
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

void add_examples(CLI::App& app, std::initializer_list<Example> examples, const std::string& notes) {
  std::string text = "Examples:\n";
  for (const Example& example : examples) text += "  " + example.command + "\n      " + example.meaning + "\n";
  app.footer(notes.empty() ? text : text + "\n" + notes);
}

std::string choice_name(const std::vector<std::string>& words) {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "{" : ",") + word;
  return name + "}";
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string name = choice_name(words);
  return {[words = std::move(words)](const std::string& text) {
            const std::vector<std::string_view> known(words.begin(), words.end());
            for (const std::string_view word : known) {
              if (word == text) return std::string();
            }
            return "\"" + text + "\" is no choice" + config::suggestion(text, known, "choices");
          },
          name};
}

std::optional<int> parse_arguments(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", app.get_name() + " " TOUCHLINE_VERSION, "Print the version and exit");
  app.add_option_function<std::string>(
         "--completion",
         [&app](const std::string& shell) {
           std::cout << (shell == "zsh" ? zsh_completion(app) : bash_completion(app));
           throw CLI::Success();
         },
         "Print a script for this shell that completes the words of the command line, and exit")
      ->check(one_of({"bash", "zsh"}))
      ->type_name("SHELL");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 reports --help and --version as errors with code 0.
    const bool asks = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
    const std::string unknown = asks ? std::string() : unknown_word(app);
    if (unknown.empty()) {
      const int code = app.exit(error) == 0 ? kExitOk : kExitBadCommandLine;
      if (std::cout.flush()) return code;
      std::cerr << app.get_name() << ": standard output: cannot be written\n";
      return kExitBadFile;
    }
    std::cerr << app.get_name() << ": " << unknown << "\nRun with --help for more information.\n";
    return kExitBadCommandLine;
  }
  return std::nullopt;
}

}  // namespace touchline
