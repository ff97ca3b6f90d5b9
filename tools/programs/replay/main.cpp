#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <new>

#include "hal/files/interruption.h"
#include "hal/files/text_output.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/replay/recording_replay.h"
#include "tools/programs/replay/replay.h"

namespace {

using namespace touchline::replay;
using touchline::formatted;
using touchline::hal::TextOutput;
using WallClock = std::chrono::steady_clock;

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

double seconds_since(WallClock::time_point begin) {
  return std::chrono::duration<double>(WallClock::now() - begin).count();
}

// Updates the terminal at most ten times per second.
class ProgressBar {
 public:
  ProgressBar(bool shown, TextOutput& output) : output_(output), shown_(shown) {}
  void show(std::uint64_t done, std::uint64_t total) {
    constexpr double kPeriod = 0.1;
    constexpr std::uint64_t kWidth = 40;
    if (!shown_ || (done != total && seconds_since(last_) < kPeriod)) return;
    last_ = WallClock::now();
    drawn_ = true;
    const double rate = static_cast<double>(done) / std::max(1e-9, seconds_since(begin_));
    if (total == 0) {
      output_.print_error(formatted("\r%llu frames, %.0f/s ", static_cast<unsigned long long>(done), rate));
      return;
    }
    const std::uint64_t filled = std::min(kWidth, done * kWidth / total);
    output_.print_error(formatted("\r[%s%s] %llu/%llu, %.0f/s ", std::string(filled, '#').c_str(),
                                  std::string(kWidth - filled, '.').c_str(), static_cast<unsigned long long>(done),
                                  static_cast<unsigned long long>(total), rate));
  }
  void clear() const {
    if (drawn_) output_.print_error("\r\033[K");
  }

 private:
  TextOutput& output_;
  bool shown_, drawn_ = false;
  WallClock::time_point begin_ = WallClock::now(), last_{};
};

std::string text_of(const ReplaySummary& s, double elapsed_s) {
  const double frames = s.frames == 0 ? 1.0 : static_cast<double>(s.frames);
  std::string text = formatted(
      "%llu frames in %.2f s (%.0f/s): %.2f robots per frame, %.2f with id; ball in %.1f %%; overload in %llu",
      static_cast<unsigned long long>(s.frames), elapsed_s, static_cast<double>(s.frames) / std::max(1e-9, elapsed_s),
      static_cast<double>(s.robots) / frames, static_cast<double>(s.robots_with_id) / frames,
      100.0 * static_cast<double>(s.frames_with_ball) / frames, static_cast<unsigned long long>(s.frames_overloaded));
  if (s.damaged > 0)
    text += formatted("; %llu damaged pictures or packets skipped", static_cast<unsigned long long>(s.damaged));
  return text + "\n";
}

// Returns what is wrong with the combination of options; empty: nothing.
std::string wrong_use(const ReplayOptions& options) {
  if (is_recording(options.input)) {
    const bool has_files = !options.venue.empty() || !options.team.empty() || !options.overrides.empty();
    if (has_files) return "a recording has its own files; --what-if KEY=VALUE changes a key of them";
    if (options.rate_hz > 0.0) return "--rate: a recording has its own time stamps";
    return options.skip_damaged ? "--skip-damaged: a recording is repeated with all of its pictures" : "";
  }
  if (!options.what_if.empty()) return "--what-if needs a recording (NAME.mcap); for pictures there is --set";
  if (is_game_log(options.input)) {
    if (options.rate_hz > 0.0) return "--rate: a game log has its own time stamps";
    if (!options.annotate.empty()) return "--annotate: a game log has no pictures";
  }
  const char* const missing = options.venue.empty()  ? "--venue"
                              : options.team.empty() ? "--team"
                              : options.out.empty()  ? "--out"
                                                     : nullptr;
  return missing != nullptr ? std::string(missing) + " is required" : "";
}

int run_recording(ReplayOptions options, bool quiet, ProgressBar& bar, TextOutput& output) {
  options.overrides = options.what_if;
  // With --out -, standard output carries only the result.
  const auto print = [&](const std::string& text) {
    return options.out == "-" ? output.print_error(text) : output.print(text);
  };
  const auto note = [&](const std::string& line) {
    bar.clear();
    if (!quiet) print(line + "\n");
  };
  const touchline::Result<RecordingSummary> summary = replay_recording(
      options, [&bar](std::uint64_t done, std::uint64_t total) { bar.show(done, total); }, note, stop_requested);
  bar.clear();
  if (!summary.ok()) {
    output.print_error("touchline-replay: " + summary.text() + "\n");
    return touchline::kExitBadFile;
  }
  print(text_of(summary.value(), !options.what_if.empty()));
  const bool is_reproduced = summary.value().different == 0;
  return is_reproduced || !options.what_if.empty() ? touchline::kExitOk : touchline::kExitBadFile;
}

int run_pictures(const ReplayOptions& options, bool quiet, ProgressBar& bar, TextOutput& output) {
  const WallClock::time_point begin = WallClock::now();
  const touchline::Result<ReplaySummary> summary = replay(
      options, [&bar](std::uint64_t done, std::uint64_t total) { bar.show(done, total); }, stop_requested);
  bar.clear();
  if (!summary.ok()) {
    output.print_error("touchline-replay: " + summary.text() + "\n");
    return touchline::kExitBadFile;
  }
  for (const std::string& note : summary.value().notes) output.print_error("touchline-replay: " + note + "\n");
  const std::string text = text_of(summary.value(), seconds_since(begin));
  // With --out -, standard output carries only the result.
  if (!quiet && options.out == "-") output.print_error(text);
  if (!quiet && options.out != "-") output.print(text);
  return touchline::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  ReplayOptions options;
  bool quiet = false;
  CLI::App app{"Runs the vision pipeline on pictures or a video and writes the results, one JSON object per frame.",
               "touchline-replay"};
  app.add_option(
         "input", options.input,
         "A recording NAME.mcap (touchline run --record), which is repeated and compared bit for bit, after missing "
         "steps "
         "from the next recorded state on; a folder of pictures (png, ppm, jpg), one picture, a video, or a game log "
         "NAME.log or NAME.log.gz of the Small Size League")
      ->required()
      ->type_name("PATH");
  app.add_option("--venue", options.venue, "Venue file, for pictures and game logs; a recording has its own")
      ->type_name("FILE");
  app.add_option("--team", options.team, "Team file, for pictures and game logs; a recording has its own")
      ->type_name("FILE");
  app.add_option("--out", options.out, "Result file, JSON lines; -: standard output. Only a recording needs none")
      ->type_name("FILE");
  app.add_option("--annotate", options.annotate,
                 "Draw the results into pictures in this folder, or into a video NAME.mp4")
      ->type_name("PATH");
  CLI::Option* plot =
      app.add_option("--plot", options.plot,
                     "Draw path, velocities and innovations of a robot and of the ball into this SVG file")
          ->check(touchline::name_ending({".svg"}))
          ->type_name("FILE");
  app.add_option("--plot-robot", options.plot_robot,
                 "TEAM:ID, the robot of --plot, with the team's color: blue:3 (default: the one that drives farthest)")
      ->needs(plot);
  app.add_option("--rate", options.rate_hz, "Frames per second (default: a video's own time stamps, pictures 30)")
      ->check(touchline::number_range(0.001, 10000.0));
  touchline::add_overrides(app, options.overrides, "the venue or team file");
  app.add_option("--what-if", options.what_if,
                 "Replay a recording with another value of a key of its files, and list what differs")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  app.add_flag("--skip-damaged", options.skip_damaged,
               "Skip pictures or packets that cannot be decoded instead of stopping");
  app.add_flag("--quiet", quiet, "Print neither progress nor summary; for a recording only the summary");
  touchline::add_examples(
      app, {{"touchline-replay touchline-0042.mcap", "repeat a recorded game, and compare all results"},
            {"touchline-replay touchline-0042.mcap --what-if control.drive.max_speed_mps=0.5", "what would differ"},
            {"touchline-replay game.mp4 --venue venue.toml --team team.toml --out game.jsonl", "write the results"},
            {"touchline-replay game.log.gz --venue venue.toml --team team.toml --out game.jsonl",
             "track the poses of a game log"},
            {"touchline-replay pictures --venue venue.toml --team team.toml --out - --annotate seen",
             "print the results, and draw them into copies of the pictures"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;

  const auto request_stop = [](int) { stop_requested = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, request_stop);
  touchline::hal::set_interruption(&stop_requested);

  TextOutput output;
  if (const std::string error = wrong_use(options); !error.empty()) {
    output.print_error("touchline-replay: " + error + "\nRun with --help for more information.\n");
    return touchline::kExitBadCommandLine;
  }
  ProgressBar bar(!quiet && isatty(STDERR_FILENO) == 1, output);
  try {
    return is_recording(options.input) ? run_recording(options, quiet, bar, output)
                                       : run_pictures(options, quiet, bar, output);
  } catch (const std::bad_alloc&) {
    output.print_error("touchline-replay: " + options.input + ": not enough memory\n");
    return touchline::kExitInternalError;
  }
}
