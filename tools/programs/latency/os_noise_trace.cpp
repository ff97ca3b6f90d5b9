#include "tools/programs/latency/os_noise_trace.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace touchline::latency {
namespace {

constexpr const char* kTracer = "osnoise";
constexpr const char* kInstancePrefix = "touchline-latency-";

Error system_failure(const std::string& path) {
  const int reason = errno;
  const bool refused = reason == EACCES || reason == EPERM;
  return failure(refused            ? ErrorCode::kPermission
                 : reason == ENOENT ? ErrorCode::kNotFound
                                    : ErrorCode::kIo,
                 "%s: %s%s", path.c_str(), std::strerror(reason), refused ? "; run as root" : "");
}

// Without the line's end.
Result<std::string> read_text(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream all;
  if (!file) return system_failure(path);
  all << file.rdbuf();
  std::string text = all.str();
  while (text.ends_with('\n') || text.ends_with(' ')) text.pop_back();
  return text;
}

Result<void> write_text(const std::string& path, const std::string& text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (file < 0) return system_failure(path);
  const bool written = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const Error error = written ? Error{} : system_failure(path);
  ::close(file);
  if (!written) return error;
  return {};
}

bool has_word(const std::string& text, const std::string& word) {
  std::istringstream words(text);
  for (std::string each; words >> each;) {
    if (each == word) return true;
  }
  return false;
}

// Whether the process that made this instance, whose name ends with its number, has ended.
bool is_left_over(const std::string& name) {
  if (!name.starts_with(kInstancePrefix)) return false;
  int process = 0;
  const char* const end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + std::strlen(kInstancePrefix), end, process);
  return parsed.ptr == end && process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
}

void remove_instance(const std::string& instance) {
  static_cast<void>(write_text(instance + "/tracing_on", "0"));
  static_cast<void>(write_text(instance + "/current_tracer", "nop"));
  ::rmdir(instance.c_str());
}

// The tracers share their settings, so only one program can use them. Removes what a killed run left behind, and
// returns whether there was something.
Result<bool> check_unused(const std::string& folder) {
  std::vector<std::string> instances{folder};
  std::error_code ignored;
  bool was_left_over = false;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/instances", ignored)) {
    if (is_left_over(entry.path().filename())) {
      remove_instance(entry.path());
      was_left_over = true;
    } else {
      instances.push_back(entry.path());
    }
  }
  for (const std::string& instance : instances) {
    const Result<std::string> tracer = read_text(instance + "/current_tracer");
    if (tracer.ok() && (tracer.value() == kTracer || tracer.value() == "timerlat")) {
      return failure(ErrorCode::kBusy, "%s: another program uses the tracer %s; end it first", instance.c_str(),
                     tracer.value().c_str());
    }
  }
  return was_left_over;
}

// The loop keeps its processor to itself as far as possible.
void leave_processor(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return;
  CPU_CLR(static_cast<std::size_t>(processor), &set);
  static_cast<void>(sched_setaffinity(0, sizeof set, &set));  // refused if there is no other processor
}

}  // namespace

OsNoiseTrace::OsNoiseTrace(std::string folder, int thread)
    : folder_(std::move(folder)),
      instance_(folder_ + "/instances/" + kInstancePrefix + std::to_string(::getpid())),
      noise_(thread) {}

OsNoiseTrace::~OsNoiseTrace() {
  if (reader_.joinable()) reader_.request_stop();
  if (reader_.joinable()) reader_.join();
  restore();
}

void OsNoiseTrace::restore() {
  if (pipe_ >= 0) ::close(pipe_);
  pipe_ = -1;
  if (!instance_.empty()) remove_instance(instance_);
  instance_.clear();
  for (; !restored_.empty(); restored_.pop_back()) {
    static_cast<void>(write_text(restored_.back().first, restored_.back().second));
  }
}

Result<void> OsNoiseTrace::configure(int processor, int thread) {
  if (processor < 0) {
    return failure(ErrorCode::kUnsupported, "the loop has no processor of its own; set realtime.cpu");
  }
  TOUCHLINE_TRY_ASSIGN(const std::string tracers, read_text(folder_ + "/available_tracers"));
  if (!has_word(tracers, kTracer)) {
    return failure(ErrorCode::kUnsupported, "this kernel has no tracer osnoise (CONFIG_OSNOISE_TRACER)");
  }
  const std::string options_file = folder_ + "/osnoise/options";
  const Result<std::string> options = read_text(options_file);
  const std::string on = "OSNOISE_WORKLOAD", off = "NO_OSNOISE_WORKLOAD";
  if (!options.ok() || !(has_word(options.value(), on) || has_word(options.value(), off))) {
    return failure(ErrorCode::kUnsupported, "%s: the tracer's own thread cannot be switched off; Linux 6.2 can",
                   options_file.c_str());
  }
  TOUCHLINE_TRY_ASSIGN(const bool was_left_over, check_unused(folder_));
  const bool is_on = has_word(options.value(), on);
  if (is_on) TOUCHLINE_TRY(write_text(options_file, off));
  if (is_on || was_left_over) restored_.emplace_back(options_file, on);
  if (::mkdir(instance_.c_str(), 0700) != 0 && errno != EEXIST) return system_failure(instance_);
  const std::string here = "CPU == " + std::to_string(processor), id = std::to_string(thread);
  for (const char* event : {"thread_noise", "irq_noise", "softirq_noise", "nmi_noise"}) {
    const std::string path = instance_ + "/events/osnoise/" + event;
    TOUCHLINE_TRY(write_text(path + "/filter", here));
    TOUCHLINE_TRY(write_text(path + "/enable", "1"));
  }
  const std::string scheduler = instance_ + "/events/sched/";
  TOUCHLINE_TRY(write_text(scheduler + "sched_waking/filter", "pid == " + id));
  TOUCHLINE_TRY(write_text(scheduler + "sched_waking/enable", "1"));
  TOUCHLINE_TRY(write_text(scheduler + "sched_switch/filter", "prev_pid == " + id + " || next_pid == " + id));
  TOUCHLINE_TRY(write_text(scheduler + "sched_switch/enable", "1"));
  TOUCHLINE_TRY(write_text(instance_ + "/trace_clock", "mono"));
  // Of each processor: half a second of 20,000 events a second, until the reader comes.
  TOUCHLINE_TRY(write_text(instance_ + "/buffer_size_kb", "1024"));
  TOUCHLINE_TRY(write_text(instance_ + "/current_tracer", kTracer));
  TOUCHLINE_TRY(write_text(instance_ + "/tracing_on", "1"));
  const std::string pipe = instance_ + "/trace_pipe";
  pipe_ = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (pipe_ < 0) return system_failure(pipe);
  return {};
}

Result<std::unique_ptr<OsNoiseTrace>> OsNoiseTrace::start(int processor, int thread, const std::string& folder) {
  std::unique_ptr<OsNoiseTrace> trace(new OsNoiseTrace(folder, thread));
  TOUCHLINE_TRY(trace->configure(processor, thread));
  trace->reader_ = std::jthread([self = trace.get(), processor](const std::stop_token& stop) {
    prctl(PR_SET_NAME, "trace-reader");
    leave_processor(processor);
    self->read(stop);
  });
  return trace;
}

// Returns whether there was something to read. `rest`: the beginning of a line whose end was not read yet.
bool OsNoiseTrace::read_once(std::string& rest) {
  std::array<char, 32768> bytes;  // NOLINT(cppcoreguidelines-pro-type-member-init): read() fills it
  const ssize_t size = ::read(pipe_, bytes.data(), bytes.size());
  if (size <= 0) return false;
  rest.append(bytes.data(), static_cast<std::size_t>(size));
  std::size_t begin = 0;
  for (std::size_t end = rest.find('\n'); end != std::string::npos; end = rest.find('\n', begin)) {
    noise_.add(std::string_view(rest).substr(begin, end - begin));
    begin = end + 1;
  }
  rest.erase(0, begin);
  return true;
}

void OsNoiseTrace::read(const std::stop_token& stop) {
  std::string rest;
  while (!stop.stop_requested()) {
    if (!read_once(rest)) ::usleep(20'000);
  }
  static_cast<void>(write_text(instance_ + "/tracing_on", "0"));
  while (read_once(rest)) {
  }
}

OsNoise OsNoiseTrace::stop() {
  reader_.request_stop();
  reader_.join();
  restore();
  noise_.finish();
  return std::move(noise_);
}

}  // namespace touchline::latency
