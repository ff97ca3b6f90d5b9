#include "firmware/console_command.h"

#include <cstdio>
#include <memory>

#include "firmware/console/access.h"
#include "firmware/console/login_link.h"

namespace touchline {
namespace {

Result<std::string> text_of(const CommandLine& command_line, const config::Configuration& configuration) {
  const config::ConsoleSettings& settings = configuration.board.console;
  TOUCHLINE_TRY_ASSIGN(const std::string token, console::make_token(console::usable_token_file(settings)));
  if (!command_line.prints_login_link) return token + "\n";
  TOUCHLINE_TRY_ASSIGN(const console::ConsolePlan plan, console::plan_console(settings, configuration.board_where, {}));
  // The login text shows the address of the board file; if that is a loopback address, --lan replaces it.
  return console::login_text(console::is_loopback(plan.address) ? "0.0.0.0" : plan.address, plan.port, token);
}

}  // namespace

int console_command(const CommandLine& command_line) {
  const auto configuration = std::make_unique<config::Configuration>();
  const config::FilePaths& files = command_line.session.files;
  // Without a board file, the token of the user is shown.
  Result<void> loaded;
  if (!files.board.empty()) loaded = config::load_board(files.board, files.overrides, *configuration);
  const Result<std::string> text =
      loaded.ok() ? text_of(command_line, *configuration) : Result<std::string>(std::move(loaded).error());
  if (!text.ok()) {
    std::fprintf(stderr, "%s\n", text.error().text.c_str());
    return kExitBadFile;
  }
  std::fputs(text.value().c_str(), stdout);
  return kExitOk;
}

}  // namespace touchline
