#include "firmware/console_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "firmware/console/access.h"
#include "firmware/console/listening_file.h"
#include "firmware/console/login_link.h"

namespace touchline {
namespace {

struct Printed {
  std::string text;   // the token or the links
  std::string notes;  // what a person has to know beside them
};

Result<Printed> print_of(const CommandLine& command_line, const config::Configuration& configuration) {
  const config::ConsoleSettings& settings = configuration.board.console;
  const std::string token_file = console::usable_token_file(settings);
  TOUCHLINE_TRY_ASSIGN(const std::string token, console::make_token(token_file));
  Printed printed;
  std::error_code unknown;
  const bool has_service =
      std::filesystem::is_directory(std::filesystem::path(settings.token_file).parent_path(), unknown);
  if (token_file != settings.token_file && has_service) {
    printed.notes = "This is the token of programs that you start yourself (" + token_file +
                    ").\nThe installed service has another one: sudo -u touchline touchline console " +
                    (command_line.prints_login_link ? "--link\n" : "--token\n");
  }
  if (!command_line.prints_login_link) {
    printed.text = token + "\n";
    return printed;
  }
  for (const console::ListeningAddress& running : console::running_consoles(token_file)) {
    printed.text += console::login_text(running.address, running.port, token);
  }
  if (!printed.text.empty()) return printed;
  TOUCHLINE_TRY_ASSIGN(const console::ConsolePlan plan, console::plan_console(settings, configuration.board_where, {}));
  // The login text shows the address of the board file; if that is a loopback address, --lan replaces it.
  printed.text = console::login_text(console::is_loopback(plan.address) ? "0.0.0.0" : plan.address, plan.port, token);
  printed.notes +=
      "No program with this token serves other computers now: these links are valid as soon as `touchline run --lan`\n"
      "or, for the installed service, `sudo touchline link` opens port " +
      std::to_string(plan.port) + ".\n";
  return printed;
}

}  // namespace

int console_command(const CommandLine& command_line) {
  const auto configuration = std::make_unique<config::Configuration>();
  const config::FilePaths& files = command_line.session.files;
  // Without a board file, the token of the user is shown.
  Result<void> loaded;
  if (!files.board.empty()) loaded = config::load_board(files.board, files.overrides, *configuration);
  const Result<Printed> printed =
      loaded.ok() ? print_of(command_line, *configuration) : Result<Printed>(std::move(loaded).error());
  if (!printed.ok()) {
    std::fprintf(stderr, "%s\n", printed.error().text.c_str());
    return kExitBadFile;
  }
  std::fputs(printed.value().text.c_str(), stdout);
  std::fputs(printed.value().notes.c_str(), stderr);
  return kExitOk;
}

}  // namespace touchline
