#include "tools/programs/latency/measure_command.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include "firmware/null_devices.h"
#include "firmware/realtime.h"
#include "firmware/signals.h"
#include "hal/linux/files/output_file.h"
#include "hal/linux/monotonic_clock.h"
#include "tools/programs/latency/background_load.h"
#include "tools/programs/latency/measurement.h"
#include "tools/programs/latency/progress.h"
#include "tools/programs/latency/report_document.h"
#include "tools/programs/latency/report_json.h"
#include "tools/programs/latency/system_facts.h"
#include "tools/programs/latency/worst_frames.h"

namespace touchline::latency {
namespace {

int fail(const std::string& message, int code = kExitBadFile) {
  std::cerr << "touchline-latency: " << message << '\n';
  return code;
}

int refuse(const config::Problems& problems) {
  std::cerr << problems.text();
  return kExitBadFile;
}

// Without making or touching the file: a measurement that fails must not leave empty ones behind.
bool can_be_written(const std::string& path, std::string& error) {
  if (path.empty() || path == "-") return true;
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    error = path + ": is a folder";
  } else if (const bool there = ::access(path.c_str(), F_OK) == 0;
             ::access(there ? path.c_str() : folder.c_str(), there ? W_OK : W_OK | X_OK) != 0) {
    error = path + ": cannot be written: " + std::strerror(errno);
  }
  return error.empty();
}

bool can_be_written(const Outputs& outputs, std::string& error) {
  return can_be_written(outputs.json, error) && can_be_written(outputs.histogram, error) &&
         can_be_written(outputs.html, error);
}

bool write_file(const std::string& path, const std::string& bytes) {
  std::string reason;
  if (hal::write_file(path, bytes, reason).ok()) return true;
  fail(reason);
  return false;
}

std::string utc_now() {
  std::array<char, 32> text{};
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &parts));
  return text.data();
}

// From an open loop to its end.
class Run {
 public:
  Run(const MeasureOptions& options, const config::BoardFile& board, double most_hz)
      : options_(options),
        board_(board),
        warm_up_s_(static_cast<double>(options.warm_up) / most_hz),
        frames_(frames_for(options, most_hz)),
        measurement_(frames_, options.warm_up) {}

  [[nodiscard]] LoopObserver observer() { return measurement_.observer(); }
  [[nodiscard]] std::uint64_t steps() const { return frames_ + options_.warm_up; }
  [[nodiscard]] Duration duration() const {
    return options_.duration_s > 0.0 ? from_seconds(options_.duration_s + warm_up_s_) : Duration::zero();
  }

  // First of all: what may not be possible, and memory, before the camera fills its first buffers.
  bool prepare(std::string& error) {
    if (options_.load && !load_.start(error)) return false;
    tell(lock_memory(board_.realtime));
    return true;
  }

  // Nobody prints the loop's reports: what does not fit into their ring is left out.
  int measure(Loop& loop, const std::string& source, double rate_hz) {
    LoopEnd end = LoopEnd::kRequested;
    SystemFacts facts;
    {
      // Begins before this thread becomes privileged, and inherits nothing of it.
      const Progress progress(measurement_, options_.duration_s > 0.0 ? 0 : steps());
      const CpuLatencyRequest cpu_latency_request(board_.realtime);
      tell(cpu_latency_request.refused());
      tell(become_realtime(board_.realtime));
      tell(realtime_hints(board_.realtime, is_realtime()));
      facts = read_system_facts();
      measurement_.begin();
      end = loop.run(handle_stop_signals());
      measurement_.end();
      read_final_facts(facts);
    }
    const Expected expected{rate_hz, from_seconds(options_.deadline_ms * 1e-3), options_.listed};
    LatencyReport report = measurement_.report(source, expected);
    report.measured_at = utc_now();
    if (options_.load) facts.load = BackgroundLoad::description();
    if (!load_.stop()) facts.load += " (it ended before the measurement)";
    facts.refused = std::move(told_);
    report.system = std::move(facts);
    const int code = output(report);
    if (end != LoopEnd::kFault && end != LoopEnd::kDeviceLost) return code;
    return fail(std::string("the loop ended by a fault: ") + loop.last_fault().reason.data(), kExitDeviceFailure);
  }

 private:
  static std::size_t frames_for(const MeasureOptions& options, double most_hz) {
    if (options.duration_s <= 0.0) return options.frames;
    // A tenth more than expected; never more than a gigabyte of samples.
    return static_cast<std::size_t>(std::min(1e7, 100.0 + 1.1 * most_hz * options.duration_s));
  }

  void tell(const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) std::cerr << "real time: " << sentence << '\n';
    told_.insert(told_.end(), sentences.begin(), sentences.end());
  }

  [[nodiscard]] int output(const LatencyReport& report) const {
    if (report.frames == 0) return fail("ended before the warm-up was over");
    const Document document = document_of(report);
    const Outputs& outputs = options_.outputs;
    // With "-" as a file's name, standard output holds that file and nothing else.
    const bool taken = outputs.json == "-" || outputs.histogram == "-" || outputs.html == "-";
    (taken ? std::cerr : std::cout) << to_text(document) << std::flush;
    const NamedReport named{report.source, report};
    const auto svg = [&] { return histogram_svg({&named, 1}); };
    bool good = outputs.json.empty() || write_file(outputs.json, to_json(report));
    if (!outputs.histogram.empty()) {
      const bool png = outputs.histogram.ends_with(".png");
      good = write_file(outputs.histogram, png ? histogram_png({&named, 1}) : svg()) && good;
    }
    if (!outputs.html.empty()) good = write_file(outputs.html, to_html(document, svg())) && good;
    return good ? kExitOk : kExitBadFile;
  }

  const MeasureOptions& options_;
  const config::BoardFile& board_;
  double warm_up_s_;
  std::size_t frames_;
  Measurement measurement_;
  BackgroundLoad load_;
  std::vector<std::string> told_;
};

std::string picture_text(const hal::CameraInfo& info) {
  std::string text = std::to_string(info.width_px) + " x " + std::to_string(info.height_px);
  for (const auto& format : hal::kPixelFormats) {
    if (format.value == info.format) text += " " + std::string(format.word);
  }
  return text;
}

int measure_board(const MeasureOptions& options) {
  Session session;
  config::Problems problems;
  if (!session.load(options.session, problems).ok()) return refuse(problems);
  const config::BoardFile& board = session.configuration().board;
  // A video's own rate is known later.
  Run run(options, board, board.camera.rate_hz > 0.0 ? board.camera.rate_hz : 240.0);
  std::string reason;
  if (!run.prepare(reason)) return fail(reason);
  session.limit(run.steps(), run.duration());
  if (!session.open(run.observer(), reason).ok()) return fail(reason, kExitDeviceFailure);
  const hal::CameraInfo& info = session.devices().loop_devices().camera.info();
  const double rate_hz = info.rate_hz > 0.0 ? info.rate_hz : board.camera.rate_hz;
  return run.measure(session.loop(), "board " + board.name + ", " + picture_text(info), rate_hz);
}

// Without the board's radio: nonsense in the picture must not drive anybody's robots.
int measure_worst_frames(const MeasureOptions& options) {
  const auto configuration = std::make_unique<config::Configuration>();
  config::Problems problems;
  if (!config::load(options.session.files, *configuration, problems).ok()) return refuse(problems);
  const auto pipeline = std::make_unique<Pipeline>();
  const Status status = pipeline->configure(configuration->pipeline, hal::MonotonicClock::read);
  if (!status.ok()) return fail(std::string("the pipeline refuses these files: ") + describe(status.code()));
  hal::MonotonicClock clock;
  NullRadio radio;
  NullGpio gpio;
  WorstFrames camera(configuration->pipeline, clock);
  const config::BoardFile& board = configuration->board;
  Run run(options, board, 5000.0);  // one after the other, without a pause
  LoopSettings settings;
  settings.faults = board.faults;
  settings.frames = run.steps();
  settings.duration = run.duration();
  const auto reports = std::make_unique<ReportRing>();
  const auto loop =
      std::make_unique<Loop>(LoopDevices{camera, radio, gpio, clock}, *pipeline, settings, *reports, run.observer());
  std::string reason;
  if (!run.prepare(reason)) return fail(reason);
  if (!loop->open(reason).ok()) return fail(reason);
  return run.measure(*loop, "worst frames, " + picture_text(camera.info()), board.camera.rate_hz);
}

bool read_report(const std::string& path, LatencyReport& report) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  std::string error = "cannot be read: " + std::string(std::strerror(errno));
  if (file && from_json(text.str(), report, error) && report.frames > 0) return true;
  fail(path + ": " + (error.empty() ? "holds no frames" : error));
  return false;
}

}  // namespace

int measure(const MeasureOptions& options) {
  std::string error;
  if (!can_be_written(options.outputs, error)) return fail(error);
  handle_stop_signals();  // from here on: devices are opened soon
  return options.worst_frames ? measure_worst_frames(options) : measure_board(options);
}

int compare(const std::string& path_a, const std::string& path_b, const std::string& html) {
  LatencyReport a, b;
  std::string error;
  if (!read_report(path_a, a) || !read_report(path_b, b)) return kExitBadFile;
  if (!can_be_written(html, error)) return fail(error);
  const auto name = [](const std::string& path) { return std::filesystem::path(path).stem().string(); };
  const std::array<NamedReport, 2> reports{NamedReport{name(path_a), a}, NamedReport{name(path_b), b}};
  const Document document = comparison_of(reports[0], reports[1]);
  (html == "-" ? std::cerr : std::cout) << to_text(document) << std::flush;
  return html.empty() || write_file(html, to_html(document, histogram_svg(reports))) ? kExitOk : kExitBadFile;
}

}  // namespace touchline::latency
