#include "tools/programs/latency/measure_command.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <utility>

#include "firmware/crash_stop.h"
#include "firmware/network/connections.h"
#include "firmware/null_devices.h"
#include "firmware/realtime.h"
#include "firmware/signals.h"
#include "hal/files/input_file.h"
#include "hal/files/output_file.h"
#include "hal/linux/monotonic_clock.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/latency/background_load.h"
#include "tools/programs/latency/console_clients.h"
#include "tools/programs/latency/measurement.h"
#include "tools/programs/latency/output_checks.h"
#include "tools/programs/latency/progress.h"
#include "tools/programs/latency/report_content.h"
#include "tools/programs/latency/report_json.h"
#include "tools/programs/latency/stress_pattern_camera.h"
#include "tools/programs/latency/system_facts.h"

namespace touchline::latency {
namespace {

int fail(const std::string& message, int exit_code = kExitBadFile) {
  return touchline::fail("touchline-latency", message, exit_code);
}

int refuse(const Error& error) {
  std::cerr << error.text << '\n';
  return kExitBadFile;
}

// Returns the word for a POSIX shell, in quotes if it needs them.
std::string shell_word(const std::string& word) {
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("_-+=./,:@%", c) != nullptr; };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

bool write_file(const std::string& path, const std::string& bytes) {
  const Result<void> written = hal::write_file(path, bytes);
  if (!written.ok()) fail(written.text());
  return written.ok();
}

std::string utc_now() {
  std::array<char, 32> text{};
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &parts));
  return text.data();
}

report::TraceNames names_of(const config::Configuration& configuration) {
  report::TraceNames names{{"background"}, {configuration.team.own.color, configuration.team.opponent.color}};
  for (const config::ColorEntry& color : configuration.venue.color) names.colors.push_back(color.name);
  return names;
}

// One measurement: runs an open loop, and writes the report.
class Run {
 public:
  Run(MeasureOptions& options, const config::Configuration& configuration, double max_rate_hz)
      : options_(options),
        configuration_(configuration),
        board_(configuration.board),
        warm_up_s_(static_cast<double>(options.warm_up) / max_rate_hz),
        frames_(frames_for(options, max_rate_hz)),
        measurement_(frames_, options.warm_up),
        recorder_(options.outputs.worst_folder, options.listed) {
    if (recorder_.is_on()) measurement_.set_recorder(recorder_);
  }

  [[nodiscard]] LoopObserver observer() { return measurement_.observer(); }
  [[nodiscard]] std::uint64_t steps() const { return frames_ + options_.warm_up; }
  [[nodiscard]] Duration duration() const {
    return options_.duration_s > 0.0 ? from_seconds(options_.duration_s + warm_up_s_) : Duration::zero();
  }

  // Starts the load, which can fail, and locks the memory. Call it before the camera fills its first buffers.
  Result<void> prepare() {
    // Start it first, because starting a process is easier before there are threads.
    TOUCHLINE_TRY(options_.planted.prepare(options_.warm_up + frames_ / 2));
    measurement_.meter().set_intrusion(options_.planted.intrusion());
    if (options_.stop_trace_ms > 0.0) {
      TOUCHLINE_TRY(trace_.open(from_seconds(options_.stop_trace_ms * 1e-3)));
      measurement_.set_trace(trace_);
    }
    if (options_.load) TOUCHLINE_TRY(load_.start());
    report_refused(lock_memory(board_.realtime));
    return {};
  }

  // Lets the LED blink while the loop runs.
  void watch_led(const LedPlace& place, LedBlinker& blinker) {
    blinker_ = &blinker;
    watch_.emplace(place, frames_ + options_.warm_up);
    measurement_.set_led(*watch_);
  }

  // Lets clients read the console while the loop runs.
  void read_console(ConsoleClients& clients) { console_clients_ = &clients; }

  int measure(Loop& loop, const std::string& source, double rate_hz, const std::string& time) {
    LoopEnd end = LoopEnd::kRequested;
    SystemFacts facts;
    {
      // Its thread starts before this thread gets real-time priority, which it would inherit.
      const Progress progress(measurement_, options_.duration_s > 0.0 ? 0 : steps());
      start_noise();
      if (blinker_ != nullptr) blinker_->start(rate_hz);
      const CpuLatencyRequest cpu_latency_request(board_.realtime);
      report_refused(cpu_latency_request.refused());
      report_refused(become_realtime(board_.realtime));
      report_refused(realtime_hints(board_.realtime, is_realtime()));
      facts = read_system_facts();
      const std::optional<ProcessorTimes> begin = read_processor_times();
      const InterruptCounts interrupts_begin = read_interrupts();
      measurement_.begin();
      end = loop.run(handle_stop_signals());
      measurement_.end();
      if (blinker_ != nullptr) blinker_->stop();
      if (console_clients_ != nullptr) traffic_ = console_clients_->stop();
      const std::optional<ProcessorTimes> finish = read_processor_times();
      if (begin && finish) add_load(facts, *begin, *finish);
      add_interrupts(facts, interrupts_begin, read_interrupts());
      read_final_facts(facts);
    }
    const ReportSettings expected{rate_hz, from_seconds(options_.deadline_ms * 1e-3), options_.listed};
    LatencyReport report = measurement_.report(source, expected);
    report.measured_at = utc_now();
    report.time = time;
    if (blinker_ != nullptr) {
      report.led = analyze_led(watch_->frames(), blinker_->edges(), from_seconds(1.0 / rate_hz));
      if (!blinker_->error().empty()) report.led->refusal = blinker_->error();
    }
    if (noise_) {
      noise_->stop();
      report.noise = noise_->report();
    }
    if (trace_.stopped_at() > 0) facts.trace = "stopped at frame " + std::to_string(trace_.stopped_at());
    report.planted = options_.planted.description();
    report.reading_cost = ExecutionMeter::reading_cost();
    if (options_.load) facts.load = BackgroundLoad::description();
    if (!load_.stop()) facts.load += " (ended before the measurement did)";
    facts.refused = std::move(refused_);
    report.system = std::move(facts);
    report.console = traffic_;
    report.saved = recorder_.is_on() ? replay_command() : "";
    int code = output(report);
    if (const Result<void> saved = recorder_.write(names_of(configuration_)); !saved.ok()) code = fail(saved.text());
    if (traffic_ && traffic_->clients > 0 && traffic_->elapsed_s <= 0.0) {
      return fail("a client of the console was disconnected during the measurement", kExitDeviceFailure);
    }
    if (end != LoopEnd::kFault && end != LoopEnd::kDeviceLost) return code;
    return fail(std::string("the loop ended because of a fault: ") + loop.last_fault().reason.c_str(),
                kExitDeviceFailure);
  }

 private:
  static std::size_t frames_for(const MeasureOptions& options, double max_rate_hz) {
    if (options.duration_s <= 0.0) return options.frames;
    // Samples for a tenth more than expected, and at most a gigabyte.
    return static_cast<std::size_t>(std::min(1e7, 100.0 + 1.1 * max_rate_hz * options.duration_s));
  }

  // The thread has a higher priority than the loop, so that the loop does not delay it. Call this before this thread
  // gets its own priority.
  void start_noise() {
    if (!options_.noise) return;
    const config::RealtimeSettings& realtime = board_.realtime;
    noise_.emplace(realtime.cpu, realtime.priority > 0 ? realtime.priority + 1 : 0);
    measurement_.set_noise(*noise_);
  }

  static void add_interrupts(SystemFacts& facts, const InterruptCounts& begin, const InterruptCounts& end) {
    const auto since = [](const std::optional<std::uint64_t>& a, const std::optional<std::uint64_t>& b) {
      return a && b ? std::optional(*b - *a) : std::nullopt;
    };
    facts.interrupts = interrupts_between(begin, end);
    facts.non_maskable = since(begin.non_maskable, end.non_maskable);
    facts.system_management = since(begin.system_management, end.system_management);
  }

  void report_refused(const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) std::cerr << "real time: " << sentence << '\n';
    refused_.insert(refused_.end(), sentences.begin(), sentences.end());
  }

  // Returns the command that replays the frames that --save-worst saved.
  [[nodiscard]] std::string replay_command() const {
    std::string command = "touchline-replay " + shell_word(options_.outputs.worst_folder) + " --venue " +
                          shell_word(configuration_.venue_where.file()) + " --team " +
                          shell_word(configuration_.team_where.file());
    for (const std::string& override : config::venue_and_team_overrides(options_.session.files.overrides)) {
      command += " --set " + shell_word(override);
    }
    return command + " --out -";
  }

  [[nodiscard]] int output(const LatencyReport& report) const {
    if (report.frames == 0) return fail("the measurement ended during the warm-up");
    const Document document = document_of(report);
    const Outputs& outputs = options_.outputs;
    // With "-" as file name, only that file is written to standard output.
    const bool taken = outputs.json == "-" || outputs.csv == "-" || outputs.histogram == "-" || outputs.html == "-";
    (taken ? std::cerr : std::cout) << to_text(document) << std::flush;
    const NamedReport named{report.source, report};
    const auto svg = [&] { return histogram_svg({&named, 1}); };
    bool good = outputs.json.empty() || write_file(outputs.json, to_json(report));
    if (!outputs.csv.empty()) good = write_file(outputs.csv, measurement_.to_csv()) && good;
    if (!outputs.histogram.empty()) {
      const bool png = outputs.histogram.ends_with(".png");
      good = write_file(outputs.histogram, png ? histogram_png({&named, 1}) : svg()) && good;
    }
    if (!outputs.html.empty()) good = write_file(outputs.html, to_html(document, svg())) && good;
    return good ? kExitOk : kExitBadFile;
  }

  MeasureOptions& options_;
  const config::Configuration& configuration_;
  const config::BoardFile& board_;
  double warm_up_s_;
  std::size_t frames_;
  Measurement measurement_;
  WorstFrameRecorder recorder_;
  std::optional<TimerNoise> noise_;
  KernelTrace trace_;
  LedBlinker* blinker_ = nullptr;
  ConsoleClients* console_clients_ = nullptr;
  std::optional<ConsoleTraffic> traffic_;
  std::optional<LedWatch> watch_;
  BackgroundLoad load_;
  std::vector<std::string> refused_;
};

std::string picture_text(const hal::CameraInfo& info) {
  return std::to_string(info.width_px) + " x " + std::to_string(info.height_px) + " " +
         std::string(info_of(info.format).word);
}

std::string time_text(Session& session) {
  if (session.configuration().board.camera.backend != hal::CameraBackend::kMock) return "";
  return session.devices().simulated_time()
             ? "simulated; it stands still during a frame, so stalls delay no later frame "
               "(--pace)"
             : "the machine's time, without the time for rendering; stalls delay later frames";
}

Result<void> check_led(const LedPlace& place, const config::BoardFile& board) {
  const hal::CameraSettings& camera = board.camera;
  if (camera.backend == hal::CameraBackend::kReplay) {
    return failure(ErrorCode::kUnsupported, "--led needs a camera: a recording does not show when the LED is switched");
  }
  // The center of the last pixel is at width_px - 1.
  if (place.u_px >= camera.width_px - 0.5 || place.v_px >= camera.height_px - 0.5) {
    return failure(ErrorCode::kOutOfRange, "--led %g,%g: is outside of the picture, which has %d x %d pixels",
                   place.u_px, place.v_px, camera.width_px, camera.height_px);
  }
  const bool is_wired = board.gpio.backend == hal::GpioBackend::kMock ||
                        (board.gpio.backend == hal::GpioBackend::kGpiod && board.gpio.status_led_line != hal::kNoLine);
  if (!is_wired) return failure(ErrorCode::kUnsupported, "--led needs gpio.status_led_line in the board file");
  return {};
}

// Ends the console before the session and its ring are destroyed, because the console's thread reads them.
class EndOfConsole {
 public:
  explicit EndOfConsole(ConsoleClients& clients) : clients_(clients) {}
  ~EndOfConsole() { clients_.end(); }
  EndOfConsole(const EndOfConsole&) = delete;
  EndOfConsole& operator=(const EndOfConsole&) = delete;

 private:
  ConsoleClients& clients_;
};

int measure_board(MeasureOptions& options) {
  LedBlinker blinker;  // declared before the session, which uses both until its end
  ConsoleClients console_clients(options.console_clients.value_or(0));
  Session session;
  session.set_stage_clock(ExecutionMeter::read);
  if (options.pace || options.led) options.session.arena_time = ArenaTime::kMachine;
  if (options.led) session.set_gpio_proxy(blinker);
  if (const Result<void> loaded = session.load(options.session); !loaded.ok()) return refuse(loaded.error());
  const config::Configuration& configuration = session.configuration();
  const config::BoardFile& board = configuration.board;
  if (const Result<void> kept = check_inputs_remain(options.outputs, configuration); !kept.ok()) {
    return fail(kept.text());
  }
  if (options.led) {
    if (const Result<void> wired = check_led(*options.led, board); !wired.ok()) return fail(wired.text());
    session.set_arena_led({options.led->u_px, options.led->v_px, options.led->radius_px});
  }
  Result<network::NetworkPlan> plan = network::plan_network(configuration, options.network);
  if (!plan.ok()) return refuse(plan.error());
  network::Connections connections(std::move(plan).value());
  if (options.console_clients) {
    const Result<void> attached = console_clients.attach(session, connections.snapshots());
    if (!attached.ok()) return refuse(attached.error());
  }
  connections.attach(session);
  // The rate of a video is unknown until it is opened.
  Run run(options, configuration, board.camera.rate_hz > 0.0 ? board.camera.rate_hz : 240.0);
  if (options.led) run.watch_led(*options.led, blinker);
  if (const Result<void> prepared = run.prepare(); !prepared.ok()) return fail(prepared.text());
  session.limit(run.steps(), run.duration());
  if (const Result<void> opened = session.open(run.observer()); !opened.ok()) {
    return fail(opened.text(), kExitDeviceFailure);
  }
  // These threads start before this thread gets its real-time priority, which they would inherit.
  const network::ConnectionThreads threads(connections, configuration,
                                           [](const std::string& line) { std::cerr << line + "\n"; });
  const EndOfConsole end_of_console(console_clients);
  if (options.console_clients) {
    const Result<void> served = console_clients.start(session);
    if (!served.ok()) return fail(served.text());
    run.read_console(console_clients);
  }
  const hal::CameraInfo& info = session.devices().hal_devices().camera.info();
  const double rate_hz = info.rate_hz > 0.0 ? info.rate_hz : board.camera.rate_hz;
  const int code =
      run.measure(session.loop(), "board " + board.name + ", " + picture_text(info), rate_hz, time_text(session));
  connections.stop();
  std::cerr << connections.summary();
  return code;
}

// The board's radio is not used, because random pictures must not drive robots.
int measure_worst_frames(MeasureOptions& options) {
  const auto configuration = std::make_unique<config::Configuration>();
  const Result<void> loaded = config::load(options.session.files, *configuration);
  if (!loaded.ok()) return refuse(loaded.error());
  if (const Result<void> kept = check_inputs_remain(options.outputs, *configuration); !kept.ok()) {
    return fail(kept.text());
  }
  const auto pipeline = std::make_unique<Pipeline>();
  const Status status = pipeline->configure(configuration->pipeline, ExecutionMeter::read);
  if (!status.ok()) return fail(std::string("venue and team file cannot be used together: ") + describe(status.code()));
  hal::MonotonicClock clock;
  NullRadio radio;
  NullGpio gpio;
  StressPatternCamera camera(configuration->pipeline, clock);
  const config::BoardFile& board = configuration->board;
  Run run(options, *configuration, 5000.0);  // frames follow each other without a pause
  LoopSettings settings;
  settings.faults = board.faults;
  settings.frames = run.steps();
  settings.duration = run.duration();
  const auto reports = std::make_unique<ReportRing>();
  const auto loop =
      std::make_unique<Loop>(HalDevices{camera, radio, gpio, clock}, *pipeline, settings, *reports, run.observer());
  if (const Result<void> prepared = run.prepare(); !prepared.ok()) return fail(prepared.text());
  if (const Result<void> opened = loop->open(); !opened.ok()) return fail(opened.text());
  return run.measure(*loop, "worst frames, " + picture_text(camera.info()), board.camera.rate_hz, "");
}

Result<LatencyReport> read_report(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(const std::string text, hal::read_file(path, hal::kMaxDataFileBytes));
  Result<LatencyReport> report = from_json(text);
  if (!report.ok()) return prefixed(path, std::move(report).error());
  if (report.value().frames == 0) return failure(ErrorCode::kInconsistent, "%s: contains no frames", path.c_str());
  return report;
}

}  // namespace

int measure(MeasureOptions& options) {
  const Outputs& outputs = options.outputs;
  if (const Result<void> usable = check_outputs(outputs); !usable.ok()) return fail(usable.text());
  const WorstFrameRecorder recorder(outputs.worst_folder, options.listed);
  if (const Result<void> writable = recorder.check(); !writable.ok()) return fail(writable.text());
  crash_stop::install_handlers();
  handle_stop_signals();  // installed before devices are opened
  return options.worst_frames ? measure_worst_frames(options) : measure_board(options);
}

int compare(const std::string& path_a, const std::string& path_b, const std::string& html) {
  Outputs outputs;
  outputs.html = html;
  if (const Result<void> kept = check_inputs_remain(outputs, {path_a, path_b}); !kept.ok()) return fail(kept.text());
  const Result<LatencyReport> a = read_report(path_a), b = read_report(path_b);
  for (const Result<LatencyReport>* report : {&a, &b}) {
    if (!report->ok()) return fail(report->text());
  }
  if (const Result<void> usable = check_outputs(outputs); !usable.ok()) return fail(usable.text());
  const auto name = [](const std::string& path) { return std::filesystem::path(path).stem().string(); };
  const std::array<NamedReport, 2> reports{NamedReport{name(path_a), a.value()}, NamedReport{name(path_b), b.value()}};
  const Document document = comparison_of(reports[0], reports[1]);
  (html == "-" ? std::cerr : std::cout) << to_text(document) << std::flush;
  return html.empty() || write_file(html, to_html(document, histogram_svg(reports))) ? kExitOk : kExitBadFile;
}

}  // namespace touchline::latency
