// The program touchline-latency: exit codes, files, output.
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program_folder.h"
#include "tools/programs/latency/report_json.h"

namespace touchline::testing {
namespace {

class LatencyProgram : public ProgramFolder {
 protected:
  // Returns the exit code. The output is in the file "out".
  [[nodiscard]] int latency(const std::string& arguments, const std::string& before = "") const {
    const std::string command =
        before + kKeepsFonts + "'" TOUCHLINE_LATENCY "' " + arguments + " >" + path("out") + " 2>&1";
    const int status = std::system(command.c_str());  // NOLINT(cert-env33-c,concurrency-mt-unsafe): under test
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] int measure(const std::string& arguments) const {
    return latency("--board '" TOUCHLINE_MOCK_BOARD "' --warm-up 3 " + arguments);
  }
  [[nodiscard]] bool output_contains(const std::string& words) const {
    return read("out").find(words) != std::string::npos;
  }
};

TEST_F(LatencyProgram, MeasuresWritesAndCompares) {
  ASSERT_EQ(measure("--frames 12 --list 2 --deadline-ms 500 --out " + path("a.json") + " --csv " + path("a.csv") +
                    " --histogram " + path("a.svg") + " --html " + path("a.html")),
            0)
      << read("out");
  EXPECT_TRUE(output_contains("the deadline of 0.5 s was missed by 0 of 12 frames.") ||
              output_contains("the deadline of 500 ms was missed by 0 of 12 frames."))
      << read("out");
  EXPECT_NE(read("a.json").find("\"frames\": 12"), std::string::npos);
  const std::string csv = read("a.csv");
  EXPECT_TRUE(csv.starts_with("capture to frame,color and region,")) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13) << "a head and 12 frames";
  EXPECT_NE(read("a.svg").find("</svg>"), std::string::npos);
  EXPECT_NE(read("a.html").find("</html>"), std::string::npos);
  ASSERT_EQ(latency("--compare " + path("a.json") + " " + path("a.json") + " --html " + path("c.html")), 0);
  EXPECT_TRUE(output_contains("Too few frames to judge times; at least 200 are needed.")) << read("out");
  EXPECT_NE(read("c.html").find("a against a"), std::string::npos);
}

TEST_F(LatencyProgram, MeasuresForADurationAndTheWorstFrames) {
  ASSERT_EQ(measure("--duration 0.2"), 0) << read("out");
  EXPECT_TRUE(output_contains("Milliseconds, 12 frames") || output_contains("Milliseconds, 13 frames")) << read("out");
  ASSERT_EQ(measure("--frames 6 --worst-frames"), 0) << read("out");
  EXPECT_TRUE(output_contains("Frame latency: worst frames, 640 x 480 rgb24")) << read("out");
}

// 24 frames are captured during the stall; the camera has four buffers.
TEST_F(LatencyProgram, AStallIsReportedWithTheFramesThatItDelayedAndLost) {
  ASSERT_EQ(measure("--pace --frames 40 --list 20 --plant stall=400 --out " + path("a.json")), 0) << read("out");
  const Result<latency::LatencyReport> read_back = latency::from_json(read("a.json"));
  ASSERT_TRUE(read_back.ok()) << read_back.text();
  const latency::LatencyReport& report = read_back.value();
  EXPECT_TRUE(output_contains("planted on purpose")) << read("out");
  EXPECT_GE(report.lost, 15u);
  EXPECT_GE(report.deadline_misses, 17u);
  bool is_found = false;
  for (const latency::Stall& stall : report.stalls) {
    // On a busy machine, an earlier stall may still last.
    const bool contains_it = stall.number <= 21 && stall.number + stall.delayed >= 21;
    is_found = is_found || (contains_it && stall.delayed >= 2 && stall.lost >= 15);
  }
  EXPECT_TRUE(is_found) << read("out");
  const latency::WorstFrame* planted = nullptr;
  for (const latency::WorstFrame& frame : report.worst) planted = frame.number == 21 ? &frame : planted;
  ASSERT_NE(planted, nullptr) << read("out");
  EXPECT_EQ(most_delayed_span(report, planted->times), latency::Span::kWaiting);
  EXPECT_EQ(longest_wait(planted->waits), latency::Span::kMarker);
}

TEST_F(LatencyProgram, ClientsReadTheConsoleDuringTheMeasurement) {
  std::optional<latency::ConsoleTraffic> console;
  // On a busy machine, clients may get nothing for a second, because the loop has precedence.
  for (int frames = 60; frames <= 960; frames *= 2) {
    ASSERT_EQ(measure("--pace --frames " + std::to_string(frames) + " --console-clients 2 --out " + path("a.json")), 0)
        << read("out");
    const Result<latency::LatencyReport> read_back = latency::from_json(read("a.json"));
    ASSERT_TRUE(read_back.ok()) << read_back.text();
    console = read_back.value().console;
    ASSERT_TRUE(console.has_value());
    if (console->states > 1 && console->pictures >= 2) break;
  }
  EXPECT_EQ(console->clients, 2U);
  EXPECT_GT(console->elapsed_s, 0.0);
  EXPECT_GT(console->states, 1U);
  EXPECT_GE(console->pictures, 2U) << "each gets at least the first one";
  EXPECT_GT(console->bytes, 10000U);
  EXPECT_TRUE(output_contains("each received ")) << read("out");
  ASSERT_EQ(measure("--frames 12 --out " + path("b.json")), 0) << read("out");
  EXPECT_FALSE(latency::from_json(read("b.json")).value().console.has_value());
  ASSERT_EQ(latency("--compare " + path("b.json") + " " + path("a.json")), 0);
  EXPECT_TRUE(output_contains("A unknown; B 2 clients")) << read("out");
}

TEST_F(LatencyProgram, ClientsOfAConsoleThatIsNotThereFail) {
  // No console listens at this port, which needs root.
  EXPECT_EQ(latency("--read-console 1 --console-clients 2"), 2) << read("out");
}

// No stage is blamed for the delay, whatever else the machine does.
TEST_F(LatencyProgram, PreemptionBlamesNoStage) {
  const int code = measure("--frames 40 --list 20 --plant preemption=300 --out " + path("a.json"));
  if (output_contains("this system forbids")) GTEST_SKIP() << read("out");
  ASSERT_EQ(code, 0) << read("out");
  const Result<latency::LatencyReport> report = latency::from_json(read("a.json"));
  ASSERT_TRUE(report.ok()) << report.text();
  const latency::WorstFrame* planted = nullptr;
  for (const latency::WorstFrame& frame : report.value().worst) planted = frame.number == 21 ? &frame : planted;
  ASSERT_NE(planted, nullptr) << read("out");
  EXPECT_EQ(most_delayed_span(report.value(), planted->times), latency::Span::kWaiting);
  EXPECT_GE(planted->waits.waited[static_cast<std::size_t>(Stage::kMarker)], std::chrono::milliseconds(270));
}

TEST_F(LatencyProgram, WorkIsChargedToItsStage) {
  ASSERT_EQ(measure("--frames 40 --list 20 --plant work=100 --out " + path("a.json")), 0) << read("out");
  const Result<latency::LatencyReport> report = latency::from_json(read("a.json"));
  ASSERT_TRUE(report.ok()) << report.text();
  const latency::SpanTimes& times = report.value().worst.at(0).times;
  EXPECT_GE(times[static_cast<std::size_t>(latency::Span::kMarker)], std::chrono::milliseconds(100)) << read("out");
}

// A replay of the saved pictures sees the same robots. Their ids may follow from earlier frames.
TEST_F(LatencyProgram, SavedWorstFramesCanBeReplayed) {
  const std::string overrides = "--set radio.baud=115200 --set 'ball.color=\"orange\"' ";
  const std::string folder = "--save-worst \"" + path("the day's worst") + "\"";
  ASSERT_EQ(measure("--frames 40 --list 3 --plant work=50 " + overrides + folder), 0) << read("out");
  const std::string replayed = read("out");
  const std::size_t command = replayed.find("touchline-replay '" + path("the day'\\''s worst") + "' ");
  ASSERT_NE(command, std::string::npos) << replayed;
  EXPECT_TRUE(output_contains(" --set 'ball.color=\"orange\"' --out -\n")) << "not radio.baud:\n" << replayed;
  EXPECT_TRUE(std::filesystem::exists(path("the day's worst/frame-000021.png")));
  const std::string arguments = replayed.substr(command, replayed.find("--out -", command) - command)
                                    .substr(std::string("touchline-replay ").size());
  ASSERT_TRUE(run_program("'" TOUCHLINE_REPLAY "'", arguments + "--quiet --out " + path("again.jsonl"))) << read("out");
  std::istringstream saved(read("the day's worst/trace.jsonl")), again(read("again.jsonl"));
  int lines = 0;
  const auto robots = [](const std::string& line) {
    const nlohmann::json parsed = nlohmann::json::parse(line);
    std::vector<std::pair<double, double>> found;
    for (const auto& robot : parsed["sightings"]["robots"]) found.emplace_back(robot["x"], robot["y"]);
    std::sort(found.begin(), found.end());
    return found;
  };
  for (std::string a, b; std::getline(saved, a); ++lines) {
    ASSERT_TRUE(std::getline(again, b));
    const auto in_a = robots(a), in_b = robots(b);
    ASSERT_EQ(in_a.size(), in_b.size()) << a << "\n" << b;
    EXPECT_EQ(in_a.size(), 10u);
    for (std::size_t i = 0; i < in_a.size(); ++i) {
      EXPECT_NEAR(in_a[i].first, in_b[i].first, 1e-3);
      EXPECT_NEAR(in_a[i].second, in_b[i].second, 1e-3);
    }
  }
  EXPECT_EQ(lines, 3);
  EXPECT_EQ(measure("--frames 5 " + folder), 1);
  EXPECT_TRUE(output_contains("must be a new or empty folder")) << read("out");
}

// In the arena, the status light's line drives an LED in the picture.
TEST_F(LatencyProgram, ComparesAnLedWithItsLine) {
  // On a busy machine, the times of some edges are uncertain.
  latency::LedReport led;
  for (int attempt = 0; attempt < 4 && led.edges < 5; ++attempt) {
    ASSERT_EQ(measure("--frames 240 --led 600,30,6 --out " + path("a.json")), 0) << read("out");
    const Result<latency::LatencyReport> report = latency::from_json(read("a.json"));
    ASSERT_TRUE(report.ok()) << report.text();
    ASSERT_TRUE(report.value().led.has_value());
    led = *report.value().led;
  }
  EXPECT_EQ(led.refusal, "") << read("out");
  EXPECT_GE(led.on_level - led.off_level, 50.0);
  EXPECT_GE(led.edges, 5u) << read("out");
  EXPECT_GE(led.light_to_packet.p50, std::chrono::milliseconds(8)) << "half of the exposure, and transfer";
  EXPECT_TRUE(output_contains("than the middle of the exposure, +- ")) << read("out");
  EXPECT_EQ(measure("--led 600"), 64);
  EXPECT_EQ(measure("--frames 5 --led 600,30 --set gpio.backend=none"), 1);
  EXPECT_TRUE(output_contains("--led needs gpio.status_led_line")) << read("out");
}

TEST_F(LatencyProgram, AnLedThatNoPictureCanShowIsRefused) {
  EXPECT_EQ(measure("--frames 5 --led 640,30"), 1);
  EXPECT_EQ(read("out"), "touchline-latency: --led 640,30: is outside of the picture, which has 640 x 480 pixels\n");
  EXPECT_EQ(measure("--frames 5 --led 60,480"), 1);
  EXPECT_EQ(measure("--frames 5 --led 60,30 --set camera.backend=replay --set camera.device=" + path("none.mp4")), 1);
  EXPECT_TRUE(output_contains("--led needs a camera: a recording ")) << read("out");
}

TEST_F(LatencyProgram, AWrongCommandLineGivesExitCode64) {
  EXPECT_EQ(latency("--help"), 0);
  EXPECT_EQ(latency(""), 64);
  EXPECT_TRUE(output_contains("--board or --compare")) << read("out");
  EXPECT_EQ(measure("--frames 0"), 64);
  EXPECT_EQ(measure("--frames 5 --duration 1"), 64);
  EXPECT_EQ(measure("--duration nan"), 64);
  EXPECT_EQ(measure("--histogram a.jpg"), 64);
  EXPECT_TRUE(output_contains("a.jpg: the name must end in .svg or .png")) << read("out");
  EXPECT_EQ(latency("--compare one.json"), 64);
  for (const char* unused : {"--out x.json", "--frames 10", "--set camera.gain=1", "--board x.toml"}) {
    EXPECT_EQ(latency(std::string("--compare one.json two.json ") + unused), 64);
    EXPECT_TRUE(output_contains("--compare excludes " + std::string(unused).substr(0, 5))) << read("out");
  }
  for (const char* unused : {"--led 60,30", "--pace", "--seed 2", "--publish json", "--console-clients 0"}) {
    EXPECT_EQ(measure(std::string("--worst-frames ") + unused), 64) << unused;
  }
  for (const char* planted : {"stall", "stall=", "stall=x", "nap=5", "work=0", "work=5ms"}) {
    EXPECT_EQ(measure(std::string("--plant ") + planted), 64) << planted;
  }
  EXPECT_TRUE(output_contains("work=5ms: must be stall=MS, preemption=MS or work=MS")) << read("out");
}

TEST_F(LatencyProgram, UnwritableFilesAreRejectedBeforeTheStart) {
  // The invalid board file would be the next error.
  for (const char* option : {"--out", "--csv", "--histogram", "--html"}) {
    const std::string file = path("none/a.svg");
    EXPECT_EQ(latency(std::string("--board none.toml ") + option + " " + file), 1);
    EXPECT_EQ(read("out"), "touchline-latency: " + file + ": cannot be written: No such file or directory\n");
  }
  EXPECT_EQ(latency("--board none.toml --out " + path("")), 1);
  EXPECT_TRUE(output_contains("is a folder")) << read("out");
}

TEST_F(LatencyProgram, OutputsReplaceNeitherInputsNorEachOther) {
  std::filesystem::copy(std::filesystem::path(TOUCHLINE_MOCK_BOARD).parent_path(), path("mock"));
  const std::string board = "--frames 5 --board " + path("mock/board.toml ");
  for (const char* name : {"mock/board.toml", "mock/venue.toml", "mock/team.toml"}) {
    const std::string before = read(name), same = path("./") + name;
    for (const char* kind : {"", "--worst-frames "}) {
      EXPECT_EQ(latency(board + kind + "--csv " + same), 1) << name;
      EXPECT_EQ(read("out"), "touchline-latency: --csv " + same + ": would overwrite, or be added to, the input " +
                                 path(name) + "\n");
    }
    EXPECT_EQ(read(name), before);
  }
  write("a.json", "x");
  EXPECT_EQ(latency("--compare " + path("b.json") + " " + path("a.json") + " --html " + path("a.json")), 1);
  EXPECT_TRUE(output_contains("--html " + path("a.json") + ": would overwrite")) << read("out");
  EXPECT_EQ(read("a.json"), "x");
  EXPECT_EQ(measure("--frames 5 --out /dev/null --csv /dev/null"), 0) << read("out");
  EXPECT_EQ(measure("--frames 5 --out " + path("x") + " --html " + path("x")), 1);
  EXPECT_TRUE(output_contains("--out " + path("x") + ": would overwrite, or be added to, the output of --html"))
      << read("out");
}

TEST_F(LatencyProgram, InvalidFilesGiveExitCode1AndLostDevices2) {
  EXPECT_EQ(latency("--board " + path("none.toml")), 1);
  EXPECT_EQ(measure("--venue " + path("none.toml")), 1);
  EXPECT_TRUE(output_contains("none.toml: no such file")) << read("out");
  EXPECT_EQ(measure("--set camera.backend=replay --set camera.device=" + path("none.mp4")), 2);
  EXPECT_TRUE(output_contains("none.mp4: No such file or directory")) << read("out");
  write("broken.json", "{\"format\": 2, \"source\": 5}");
  EXPECT_EQ(latency("--compare " + path("broken.json") + " " + path("none.json")), 1);
  EXPECT_EQ(read("out"), "touchline-latency: " + path("broken.json") + ": source: must be a text\n");
}

TEST_F(LatencyProgram, WritesAReportAfterASignal) {
  // On a busy machine the first frame can take long.
  int code = -1;
  for (const char* after : {"1", "4", "16"}) {
    code = latency("--board '" TOUCHLINE_MOCK_BOARD "' --warm-up 0 --frames 100000",
                   std::string("timeout --preserve-status -s INT ") + after + " env ");
    if (code == 0) break;
  }
  EXPECT_EQ(code, 0);
  EXPECT_TRUE(output_contains("Worst frame: number ")) << read("out");
}

}  // namespace
}  // namespace touchline::testing
