#include <cstdio>

#include "firmware/command_line.h"
#include "firmware/config/key_list.h"
#include "firmware/run_command.h"

namespace touchline {
namespace {

int check_command(const CommandLine& command_line) {
  config::Problems problems;
  Session session;
  const Status status = session.load(command_line.session, problems);
  // Values that were read are shown even when others are wrong: that is when one wants to look.
  if (command_line.dump && status.code() != ErrorCode::kNotFound) {
    std::fputs(config::dump(session.configuration()).c_str(), stdout);
  }
  std::fputs(problems.text().c_str(), stderr);
  if (!status.ok()) return kExitBadFile;
  const config::Configuration& configuration = session.configuration();
  if (!command_line.dump) {
    std::printf("%s, %s and %s are sound\n", configuration.board_where.file().c_str(),
                configuration.venue_where.file().c_str(), configuration.team_where.file().c_str());
    std::printf("colors: %s kernel\n", std::string(config::kernel_word(configuration.board)).c_str());
  }
  return kExitOk;
}

template <class File>
void print_keys(const char* title) {
  std::printf("%s\n", title);
  for (const config::KeyInfo& key : config::KeyLister::keys_of<File>()) {
    std::printf("  %s: %s", key.path.c_str(), key.type.c_str());
    if (!key.limits.empty()) std::printf(", %s", key.limits.c_str());
    if (!key.initial.empty()) std::printf(", default %s", key.initial.c_str());
    std::printf("\n      %s\n", key.help.c_str());
  }
}

int keys_command() {
  print_keys<config::BoardFile>("board file");
  print_keys<config::VenueFile>("venue file");
  print_keys<config::TeamFile>("team file");
  return kExitOk;
}

}  // namespace
}  // namespace touchline

int main(int argc, char** argv) {
  touchline::CommandLine command_line;
  int exit_code = 0;
  if (!touchline::parse_command_line(argc, argv, command_line, exit_code)) return exit_code;
  switch (command_line.command) {
    case touchline::Command::kRun:
      return touchline::run_command(command_line);
    case touchline::Command::kCheck:
      return touchline::check_command(command_line);
    case touchline::Command::kKeys:
      return touchline::keys_command();
  }
  return exit_code;
}
