#include "firmware/console_command.h"

#include <cstdio>
#include <memory>

#include "firmware/console/access.h"

namespace touchline {

int console_command(const CommandLine& command_line) {
  const auto configuration = std::make_unique<config::Configuration>();
  const config::FilePaths& files = command_line.session.files;
  Result<void> loaded = config::load_board(files.board, files.overrides, *configuration);
  const Result<std::string> token = loaded.ok() ? console::make_token(configuration->board.console.token_file)
                                                : Result<std::string>(std::move(loaded).error());
  if (!token.ok()) {
    std::fprintf(stderr, "%s\n", token.error().text.c_str());
    return kExitBadFile;
  }
  std::printf("%s\n", token.value().c_str());
  return kExitOk;
}

}  // namespace touchline
