#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>

#include "hal/files/interruption.h"
#include "hal/files/text_output.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"
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
  if (s.damaged > 0) text += formatted("; %llu damaged pictures skipped", static_cast<unsigned long long>(s.damaged));
  return text + "\n";
}

}  // namespace

int main(int argc, char** argv) {
  ReplayOptions options;
  bool quiet = false;
  CLI::App app{"Runs the vision pipeline on pictures or a video and writes the results, one JSON object per frame.",
               "touchline-replay"};
  app.add_option("input", options.input, "A folder of pictures (png, ppm, jpg), one picture, or a video")
      ->required()
      ->type_name("PATH");
  app.add_option("--venue", options.venue, "Venue file")->required()->type_name("FILE");
  app.add_option("--team", options.team, "Team file")->required()->type_name("FILE");
  app.add_option("--out", options.out, "Result file, JSON lines; -: standard output")->required()->type_name("FILE");
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
  app.add_flag("--skip-damaged", options.skip_damaged, "Skip pictures that cannot be decoded instead of stopping");
  app.add_flag("--quiet", quiet, "Print neither progress nor summary");
  touchline::add_examples(
      app, {{"touchline-replay game.mp4 --venue venue.toml --team team.toml --out game.jsonl", "write the results"},
            {"touchline-replay pictures --venue venue.toml --team team.toml --out - --annotate seen",
             "print the results, and draw them into copies of the pictures"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;

  const auto request_stop = [](int) { stop_requested = true; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, request_stop);
  touchline::hal::set_interruption(&stop_requested);

  TextOutput output;
  ProgressBar bar(!quiet && isatty(STDERR_FILENO) == 1, output);
  const WallClock::time_point begin = WallClock::now();
  const touchline::Result<ReplaySummary> summary = replay(
      options, [&bar](std::uint64_t done, std::uint64_t total) { bar.show(done, total); }, stop_requested);
  bar.clear();
  if (!summary.ok()) {
    output.print_error("touchline-replay: " + summary.text() + "\n");
    return touchline::kExitBadFile;
  }
  const std::string text = text_of(summary.value(), seconds_since(begin));
  // With --out -, standard output carries only the result.
  if (!quiet && options.out == "-") output.print_error(text);
  if (!quiet && options.out != "-") output.print(text);
  return touchline::kExitOk;
}
