#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/wording.h"
#include "firmware/network/network_plan.h"
#include "hal/linux/standard_descriptors.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/latency/console_reader.h"
#include "tools/programs/latency/measure_command.h"

namespace {

// Returns "{a,b}", the type of an option in the help text.
template <class Choices>
std::string protocols(const Choices& choices) {
  const std::vector<std::string_view> words = touchline::config::words_of(choices);
  return touchline::choice_name({words.begin(), words.end()});
}

}  // namespace

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  using namespace touchline;
  latency::MeasureOptions options;
  latency::Outputs& outputs = options.outputs;
  std::vector<std::string> compared;
  config::FilePaths& files = options.session.files;
  CLI::App app{
      "Measures the time of each frame from capture to packet, stage by stage, and reports the worst frames.\n"
      "With a real radio, robots are driven during the measurement.",
      "touchline-latency"};
  add_examples(
      app,
      {{"touchline-latency --board board.toml", "measure 10000 frames"},
       {"touchline-latency --board board.toml --load --html report.html",
        "with a loaded machine, with a report to read"},
       {"touchline-latency --compare before.json after.json", "compare two measurements of --out"}},
      "Ctrl-C ends the measurement with a report of the frames so far. Exit codes: 0 success, 1 a file is invalid or\n"
      "cannot be written, 2 a device failed, 64 the command line is wrong. docs/latency.md explains the report.");
  app.add_option("--board", files.board, "Board file")->type_name("FILE");
  app.add_option("--venue", files.venue, "Venue file instead of the one that the board file names")->type_name("FILE");
  app.add_option("--team", files.team, "Team file instead of the one that the board file names")->type_name("FILE");
  add_overrides(app, files.overrides, "the three files");
  CLI::Option* worst_frames =
      app.add_flag("--worst-frames", options.worst_frames,
                   "Measure synthetic pictures that are most expensive to process, instead of the camera; no radio");
  app.add_option("--seed", options.session.seed, "Random seed of the mock arena (1)")->excludes(worst_frames);
  CLI::Option* frames =
      app.add_option("--frames", options.frames, "Number of frames to measure (10000)")->check(CLI::Range(1, 10000000));
  app.add_option("--duration", options.duration_s, "Seconds to measure instead (simulated seconds in the mock arena)")
      ->check(number_range(0.1, 1e6))
      ->excludes(frames);
  app.add_option("--warm-up", options.warm_up, "Number of frames before the measurement (200)")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--deadline-ms", options.deadline_ms, "Deadline from capture to packet (the frame period)")
      ->check(number_range(0.001, 1e6));
  app.add_option("--list", options.listed, "Number of worst frames in the report (5)")->check(CLI::Range(1, 20));
  app.add_flag("--load", options.load, "Run stress-ng at the same time: processors, caches, memory, files");
  app.add_option_function<std::string>(
         "--led",
         [&](const std::string& text) {
           if (const std::string wrong = latency::parse_led_place(text, options.led.emplace()); !wrong.empty()) {
             throw CLI::ValidationError("--led", wrong);
           }
         },
         "Blink the status light, whose LED is seen at this pixel, and measure from its light to the packet;\n"
         "in the mock arena with --pace")
      ->type_name("U,V[,RADIUS]")
      ->excludes(worst_frames);
  app.add_flag("--noise", options.noise,
               "Measure how late the timers of a thread beside the loop are: the machine's share of the delays");
  app.add_option("--stop-trace-ms", options.stop_trace_ms,
                 "Stop the kernel's tracing when a frame takes longer than this from capture to packet")
      ->check(number_range(0.001, 1e6));
  app.add_option_function<std::string>(
         "--plant",
         [&](const std::string& text) {
           if (const std::string wrong = options.planted.parse(text); !wrong.empty()) {
             throw CLI::ValidationError("--plant", wrong);
           }
         },
         "Delay a frame in the middle on purpose, to see it in the report: stall=MS (the loop sleeps),\n"
         "preemption=MS (the loop's thread is stopped from outside) or work=MS (the loop computes)")
      ->type_name("{stall,preemption,work}=MS");
  app.add_option("--publish", options.network.publish,
                 "Publish during the measurement, as touchline run does: NAME[=ADDRESS], several times if needed")
      ->type_name(protocols(config::kOutputProtocols) + "[=ADDRESS]")
      ->expected(1)
      ->take_all()
      ->excludes(worst_frames);
  app.add_option("--accept", options.network.accept,
                 "Let programs on this computer drive robots, as touchline run does, several times if needed")
      ->type_name(protocols(network::kCommandWords) + "[=ADDRESS]")
      ->expected(1)
      ->take_all()
      ->excludes(worst_frames);
  app.add_option("--console-clients", options.console_clients,
                 "Serve the console during the measurement, and read it with this number of clients at full rate")
      ->check(CLI::Range(0, 16))
      ->excludes(worst_frames);
  // Internal options, for the process that runs the console's clients.
  std::uint16_t console_port = 0;
  app.add_option("--read-console", console_port)->group("");
  app.add_flag("--pace", options.pace,
               "The mock arena's time is the machine's: after a stall, frames are late or lost as with a real camera")
      ->excludes(worst_frames);
  app.add_option("--out", outputs.json, "Write all numbers into this JSON file")->type_name("FILE");
  app.add_option("--csv", outputs.csv, "Write the times of every frame in nanoseconds into this CSV file")
      ->type_name("FILE");
  app.add_option("--histogram", outputs.histogram, "Write the histogram into this file, .svg or .png")
      ->check(name_ending({".svg", ".png"}))
      ->type_name("FILE");
  app.add_option("--save-worst", outputs.worst_folder,
                 "Save pictures and results of the worst frames into this folder, for touchline-replay")
      ->type_name("DIR");
  const CLI::Option* html =
      app.add_option("--html", outputs.html, "Write the whole report into this HTML file")->type_name("FILE");
  const CLI::Option* compare =
      app.add_option("--compare", compared, "Compare the second JSON file with the first, without measuring")
          ->expected(2)
          ->type_name("FILE FILE");
  app.final_callback([&] {
    if (console_port == 0 && compared.empty() && files.board.empty()) throw CLI::RequiredError("--board or --compare");
    if (compared.empty()) return;
    for (const CLI::Option* option : app.get_options()) {
      if (option->count() > 0 && option != compare && option != html) {
        throw CLI::ExcludesError(compare->get_name(), option->get_name());
      }
    }
  });
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  if (console_port != 0) return latency::read_console(console_port, options.console_clients.value_or(1));
  return compared.empty() ? latency::measure(options) : latency::compare(compared[0], compared[1], outputs.html);
}
