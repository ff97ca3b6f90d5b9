#include <unistd.h>
#include <cstdio>
#include <exception>

#include "firmware/command_line.h"
#include "firmware/config/key_reference.h"
#include "firmware/config/packet_text.h"
#include "firmware/config/uncalibrated.h"
#include "firmware/console_command.h"
#include "firmware/fault_reference.h"
#include "firmware/init_command.h"
#include "firmware/layout_drawing.h"
#include "firmware/link_command.h"
#include "firmware/network/connections.h"
#include "firmware/run_command.h"
#include "hal/files/input_file.h"
#include "hal/files/output_file.h"
#include "hal/linux/standard_descriptors.h"

namespace touchline {
namespace {

int fail(const std::string& message) {
  std::fprintf(stderr, "touchline: %s\n", message.c_str());
  return kExitBadFile;
}

int print(const std::string& text) {
  const Result<void> written = hal::write_file("-", text);
  return written.ok() ? kExitOk : fail(written.text());
}

int init_command(const InitOptions& options) {
  const Result<std::string> steps =
      write_initial_files(options, devices::list_devices({.camera = "", .serial = "", .gpio = {}}));
  return steps.ok() ? print(steps.value()) : fail(steps.text());
}

std::string calibration_steps(const config::Configuration& configuration) {
  const std::string venue = configuration.venue_where.file();
  return venue + " is not calibrated yet. Next steps: touchline-calibrate field --venue " + venue +
         " ..., then touchline-calibrate colors --venue " + venue + " --team " + configuration.team_where.file() +
         " ...\n";
}

// Draws the layouts, for which only the team file is needed. The rest of the setup may still be missing.
int draw_command(const CommandLine& command_line) {
  Session session;
  Result<void> loaded = session.load(command_line.session);
  const bool is_calibrated = loaded.ok();
  if (!is_calibrated && config::lacks_calibration(session.configuration())) {
    loaded = session.load_uncalibrated(command_line.session);
  }
  if (!loaded.ok()) return fail("nothing was drawn:\n" + loaded.text());
  const Result<void> drawn = draw_layouts(session.configuration(), command_line.drawing);
  if (!drawn.ok()) return fail(drawn.text());
  return print("the robots' tops of " + session.configuration().team_where.file() + " are drawn in " +
               command_line.drawing + "\n" + (is_calibrated ? "" : calibration_steps(session.configuration())));
}

int check_command(const CommandLine& command_line) {
  if (!command_line.drawing.empty()) {
    if (const int code = draw_command(command_line); code != kExitOk) return code;
  }
  Session session;
  const Result<void> loaded = session.load(command_line.session);
  const config::Configuration& configuration = session.configuration();
  // The other values are useful even if one is wrong.
  int code = kExitOk;
  if (command_line.dump && loaded.code() != ErrorCode::kNotFound) code = print(config::dump(configuration));
  // `touchline init` advises to draw the layouts before the calibration, so the missing calibration is no error here.
  if (!command_line.drawing.empty() && !loaded.ok()) return code;
  const Result<network::NetworkPlan> plan =
      loaded.ok() ? network::plan_network(configuration, command_line.network) : loaded.error();
  if (!plan.ok()) {
    std::fprintf(stderr, "%s\n", plan.error().text.c_str());
    if (!configuration.venue_where.file().empty() && configuration.venue.color.empty()) {
      std::fputs(calibration_steps(configuration).c_str(), stderr);
    }
    return kExitBadFile;
  }
  const Result<console::ConsolePlan> console =
      console::plan_console(configuration.board.console, configuration.board_where, command_line.console);
  if (!console.ok()) return fail(console.text());
  if (command_line.dump) return code;
  return print(configuration.board_where.file() + ", " + configuration.venue_where.file() + " and " +
               configuration.team_where.file() + " are valid\ncolors: " +
               std::string(config::kernel_word(configuration.board)) + " kernel\n" + describe(plan.value()) +
               config::sample_packet_text(configuration.pipeline) + config::radio_warnings(configuration));
}

int link(const LinkOptions& options) {
  LinkOptions with_terminal = options;
  with_terminal.is_terminal = ::isatty(STDOUT_FILENO) != 0;
  const Result<std::string> text = link_command(with_terminal);
  return text.ok() ? print(text.value()) : fail(text.text());
}

/// Writes a reference into a page of the documentation.
int update_page(const std::string& path, Result<std::string> (*update)(std::string page)) {
  Result<std::string> page = hal::read_file(path, hal::kMaxTextFileBytes);
  if (!page.ok()) return fail(page.text());
  const Result<std::string> updated = update(std::move(page).value());
  if (!updated.ok()) return fail(path + ": " + updated.text());
  const Result<void> written = hal::write_file(path, updated.value());
  return written.ok() ? kExitOk : fail(written.text());
}

int keys_command(const CommandLine& command_line) {
  if (!command_line.page_to_update.empty()) {
    return update_page(command_line.page_to_update, config::updated_key_reference);
  }
  const Result<std::string> text = config::key_reference_text(command_line.key_words);
  return text.ok() ? print(text.value()) : fail(text.text());
}

int radio_command(const CommandLine& command_line) {
  const Result<std::string> text = config::radio_formats_text(command_line.radio_format);
  return text.ok() ? print(text.value()) : fail(text.text());
}

int faults_command(const CommandLine& command_line) {
  return command_line.page_to_update.empty() ? print(fault_reference_markdown())
                                             : update_page(command_line.page_to_update, updated_fault_reference);
}

}  // namespace
}  // namespace touchline

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  touchline::CommandLine command_line;
  if (const auto exit_code = touchline::parse_command_line(argc, argv, command_line)) return *exit_code;
  try {
    switch (command_line.command) {
      case touchline::Command::kRun:
        return touchline::run_command(command_line);
      case touchline::Command::kInit:
        return touchline::init_command(command_line.init);
      case touchline::Command::kCheck:
        return touchline::check_command(command_line);
      case touchline::Command::kConsole:
        return touchline::console_command(command_line);
      case touchline::Command::kLink:
        return touchline::link(command_line.link);
      case touchline::Command::kRadio:
        return touchline::radio_command(command_line);
      case touchline::Command::kKeys:
        return touchline::keys_command(command_line);
      case touchline::Command::kFaults:
        return touchline::faults_command(command_line);
    }
  } catch (const std::exception& error) {  // Loop::run() has stopped the robots
    std::fprintf(stderr, "touchline: internal error: %s\n", error.what());
    return touchline::kExitInternalError;
  }
  return touchline::kExitOk;
}
