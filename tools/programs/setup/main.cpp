#include <signal.h>
#include <sys/signalfd.h>
#include <CLI/CLI.hpp>

#include "hal/linux/standard_descriptors.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/setup/setup_program.h"

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  CLI::App app(
      "Serves the guided setup of the console: keeps a draft of board, venue and team file, calibrates it with "
      "pictures\n"
      "of the running firmware, and saves it. The firmware connects to its socket (docs/console.md)",
      "touchline-setup");
  touchline::setup::SetupOptions options{"/etc/touchline/board.toml", "/var/lib/touchline-setup",
                                         "/run/touchline-setup/setup.sock"};
  app.add_option("--board", options.board, "Board file to set up; venue and team file lie beside it")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_option("--state", options.folder, "Folder for the draft")->type_name("DIR")->capture_default_str();
  app.add_option("--socket", options.socket, "Unix socket for the firmware")
      ->type_name("PATH")
      ->capture_default_str()
      ->check(CLI::Validator([](std::string& path) { return path.size() < 108 ? "" : "has more than 107 bytes"; }, ""));
  touchline::add_examples(app,
                          {{"touchline-setup", "serve as the installed service does"},
                           {"touchline-setup --board hall/board.toml --state draft --socket setup.sock",
                            "serve `touchline run --board hall/board.toml --set console.setup_socket=setup.sock`"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;

  // Writing to a terminal or a firmware that no longer exists must not end the program.
  ::signal(SIGPIPE, SIG_IGN);
  sigset_t ends;
  ::sigemptyset(&ends);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) ::sigaddset(&ends, signal);
  ::sigprocmask(SIG_BLOCK, &ends, nullptr);
  const touchline::hal::Descriptor signals(::signalfd(-1, &ends, SFD_CLOEXEC | SFD_NONBLOCK));

  // Created after the signal mask is set, because its thread inherits the mask.
  touchline::hal::TextOutput output;
  touchline::setup::SetupProgram program(options, output);
  if (const touchline::Result<void> opened = program.open(); !opened.ok()) {
    output.print_error("touchline-setup: " + opened.text() + "\n");
    return touchline::kExitBadFile;
  }
  output.print("touchline-setup: serves " + options.socket + "\n");
  program.run(signals.get());
  return touchline::kExitOk;
}
