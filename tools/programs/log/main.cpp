#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "firmware/recording/recording_files.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/log/convert.h"
#include "tools/programs/log/cut.h"
#include "tools/programs/log/join.h"
#include "tools/programs/log/listing.h"

namespace {

using namespace touchline;

// 30 years, for a stretch without an end.
constexpr double kLongest_s = 1e9;

struct Options {
  std::vector<std::string> inputs;
  std::string input, output;
  log::Stretch stretch{0.0, kLongest_s};
};

Result<void> list_one(const std::string& input) {
  TOUCHLINE_TRY_ASSIGN(const std::string text, log::list(input));
  std::fputs(text.c_str(), stdout);
  return {};
}

Result<void> list_all(const Options& options) {
  for (const std::string& input : options.inputs) {
    if (!std::filesystem::is_directory(input)) {
      TOUCHLINE_TRY(list_one(input));
      continue;
    }
    const std::vector<std::string> names = recording::names_in(input);
    if (names.empty()) return failure(ErrorCode::kNotFound, "%s: has no recordings", input.c_str());
    for (const std::string& name : names) TOUCHLINE_TRY(list_one(std::filesystem::path(input) / name));
  }
  return {};
}

Result<void> convert_file(const Options& options) {
  TOUCHLINE_TRY_ASSIGN(const log::Conversion done, log::convert(options.input, options.output));
  for (const std::string& note : done.notes) std::fprintf(stderr, "touchline-log: %s\n", note.c_str());
  std::printf("%s: %llu %s\n", options.output.c_str(), static_cast<unsigned long long>(done.written),
              options.output.ends_with(".csv") ? "rows" : "messages");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Shows, cuts, joins and converts recordings of Touchline and game logs of the Small Size League",
               "touchline-log");
  app.require_subcommand(1);
  CLI::App* list = app.add_subcommand("list", "Show what files hold: times, sessions, gaps, halts, goals, channels");
  list->add_option("files", options.inputs,
                   "Recordings (NAME.mcap), folders of them, or game logs (NAME.log, NAME.log.gz)")
      ->required()
      ->type_name("FILE");
  add_examples(*list, {{"touchline-log list touchline-0042.mcap", "show what a recording holds"},
                       {"touchline-log list recordings", "show what all recordings in a folder hold, newest first"}});

  CLI::App* cut = app.add_subcommand("cut", "Copy a stretch of a recording or game log into a new file");
  cut->add_option("file", options.input, "Recording or game log")->required()->type_name("FILE");
  cut->add_option("--from", options.stretch.from_s, "Beginning of the stretch in s from the first step (0)")
      ->check(number_range(0.0, kLongest_s));
  cut->add_option("--to", options.stretch.to_s, "End of the stretch in s (default: the file's end)")
      ->check(number_range(0.0, kLongest_s));
  cut->add_option("--out", options.output, "New file of the same format")->required()->type_name("FILE");
  add_examples(*cut, {{"touchline-log cut touchline-0042.mcap --from 60 --to 75 --out goal.mcap",
                       "keep the quarter of a minute around a goal"}});

  CLI::App* join = app.add_subcommand("join", "Write recordings, or game logs, one after the other into a new file");
  join->add_option("files", options.inputs, "Files of one format")->required()->type_name("FILE");
  join->add_option("--out", options.output, "New file of this format")->required()->type_name("FILE");
  add_examples(*join, {{"touchline-log join touchline-0042.mcap touchline-0043.mcap --out game.mcap",
                        "put both halves into one file"}});

  CLI::App* convert = app.add_subcommand("convert", "Convert between recordings, game logs and CSV");
  convert->add_option("file", options.input, "Recording or game log")->required()->type_name("FILE");
  convert->add_option("--out", options.output, "New file: NAME.log, NAME.log.gz, NAME.csv, or NAME.mcap of a game log")
      ->required()
      ->type_name("FILE");
  add_examples(*convert,
               {{"touchline-log convert touchline-0042.mcap --out game.log.gz", "for the tools of the league"},
                {"touchline-log convert game.log.gz --out game.csv", "for a spreadsheet"}});
  add_examples(app, {{"touchline-log list touchline-0042.mcap", "show what a recording holds"},
                     {"touchline-log cut touchline-0042.mcap --from 60 --to 75 --out goal.mcap", "keep a part of it"},
                     {"touchline-log convert touchline-0042.mcap --out game.log.gz", "for the tools of the league"}});
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  if (cut->parsed() && options.stretch.to_s <= options.stretch.from_s) {
    return fail("touchline-log", "--to has to be larger than --from", kExitBadCommandLine);
  }
  try {
    const Result<void> done = list->parsed()   ? list_all(options)
                              : cut->parsed()  ? log::cut(options.input, options.stretch, options.output)
                              : join->parsed() ? log::join(options.inputs, options.output)
                                               : convert_file(options);
    return done.ok() ? kExitOk : fail("touchline-log", done.text());
  } catch (const std::bad_alloc&) {
    return fail("touchline-log", "not enough memory", kExitInternalError);
  }
}
