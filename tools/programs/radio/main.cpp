#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/wording.h"
#include "hal/linux/standard_descriptors.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/radio/radio_commands.h"

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  using namespace touchline;
  radio::RadioOptions options;
  config::FilePaths& files = options.session.files;
  std::string pattern;
  CLI::App app{
      "Tries the radio with one robot: sends a pattern and shows the bytes, or drives the robot under the camera and\n"
      "measures delay, lag, gains of the wheels, and which wheel is which. Only this robot moves.",
      "touchline-radio"};
  add_examples(
      app,
      {{"touchline-radio --board board.toml --robot 3 --pattern left-wheel",
        "roll one wheel, with the wheels in the air"},
       {"touchline-radio --board board.toml --robot 3 --measure", "measure the drive of robot 3 on the field"},
       {"touchline-radio --board board.toml --robot 3 --measure --write", "offer to write the values into the files"},
       {"touchline-radio --board boards/mock/board.toml --robot 0 --measure --yes", "try it in a simulation"}},
      "The robots get stop packets at the end, also after Ctrl-C and errors. Exit codes: 0 success, 1 a file is wrong "
      "or\n"
      "cannot be written, 2 a device failed or the robot could not be measured, 64 the command line is wrong.");
  app.add_option("--board", files.board, "Board file")->type_name("FILE")->required();
  app.add_option("--venue", files.venue, "Venue file instead of the one that the board file names")->type_name("FILE");
  app.add_option("--team", files.team, "Team file instead of the one that the board file names")->type_name("FILE");
  add_overrides(app, files.overrides, "the three files");
  app.add_option("--robot", options.robot, "Id of the robot")->check(CLI::Range(0, 127))->required();
  const std::vector<std::string_view> views = config::words_of(radio::kPatterns);
  const std::vector<std::string> words{views.begin(), views.end()};
  CLI::Option* sent =
      app.add_option("--pattern", pattern, "Send this pattern and show the bytes that are sent and received")
          ->check(one_of(words))
          ->type_name(choice_name(words));
  bool measures = false;
  CLI::Option* measure = app.add_flag("--measure", measures, "Drive the robot under the camera and measure its drive");
  measure->excludes(sent);
  app.add_option("--duration", options.duration_s, "Seconds of driving (3 for a pattern, 23 to measure)")
      ->check(number_range(0.1, 34.0));
  app.add_option("--speed", options.speed_mps, "Largest speed of a wheel in m/s (0.2 for a pattern, 0.5 to measure)")
      ->check(number_range(0.01, 1.0));
  app.add_option("--radius", options.radius_m, "Radius in m in which the robot drives to be measured (0.15)")
      ->check(number_range(0.1, 1.0))
      ->needs(measure);
  app.add_flag("--all", options.all, "Show every packet, not only those with new speeds")->needs(sent);
  app.add_flag("--json", options.json, "Print the measured values as one JSON object, for programs")->needs(measure);
  app.add_flag("--write", options.write, "Ask for each measured value whether to write it into the files")
      ->needs(measure);
  app.add_flag("--yes", options.yes, "Answer all questions with yes");
  app.add_option("--seed", options.session.seed, "Random seed of the motion and of the mock arena (1)");
  app.final_callback([&] {
    if (sent->count() + measure->count() == 0) throw CLI::RequiredError("--pattern or --measure");
  });
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  if (measures) return radio::measure_drive(options);
  for (const Choice<radio::Pattern>& choice : radio::kPatterns) {
    if (choice.word == pattern) return radio::send_pattern(options, choice.value);
  }
  return kExitBadCommandLine;
}
