#include "tools/programs/latency/execution_meter.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <utility>

#include "hal/linux/monotonic_clock.h"
#include "tools/programs/statistics/statistics.h"

namespace touchline::latency {
namespace {

// The stage clock is a plain function, so it finds the meter through this variable.
constinit thread_local ExecutionMeter* current = nullptr;

// The pipeline reads the clock at the beginning and at the end of each stage.
constexpr std::size_t kBorders = 2 * kStageCount;
constexpr std::size_t kMarkerBegin = 2 * static_cast<std::size_t>(Stage::kMarker);

}  // namespace

ExecutionMeter::~ExecutionMeter() {
  if (current == this) current = nullptr;
  if (schedule_file_ >= 0) ::close(schedule_file_);
}

Duration ExecutionMeter::processor_time() {
  std::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);  // this call cannot fail
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

Instant ExecutionMeter::read() {
  ExecutionMeter* const meter = current;
  if (meter == nullptr || meter->borders_ >= kBorders) return hal::MonotonicClock::read();
  const std::size_t border = meter->borders_++;
  if (border % 2 == 0) {
    // The processor time at the end of the previous stage is also the time at the beginning of this stage.
    const Instant now = hal::MonotonicClock::read();
    if (border == 0) meter->last_ = processor_time();
    if (border == kMarkerBegin && meter->intrusion_) meter->intrusion_(meter->frames_);
    return now;
  }
  const Duration spent = processor_time();
  meter->frame_.stages[border / 2] = spent - std::exchange(meter->last_, spent);
  return hal::MonotonicClock::read();
}

void ExecutionMeter::begin_frame() {
  // The kernel counts this per thread, and the loop may run on another thread than the constructor.
  if (current != this) {
    if (schedule_file_ >= 0) ::close(schedule_file_);
    schedule_file_ = ::open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC);
    ready_end_ = ready_time();
    current = this;
  }
  frame_ = {};
  usage_begin_ = ThreadUsage::of_this_thread();
  ready_begin_ = ready_time();
  frame_.ready_before = ready_begin_ - ready_end_;
  borders_ = 0;
  begin_ = processor_time();
}

void ExecutionMeter::end_frame() {
  const Duration spent = processor_time() - begin_;
  borders_ = kBorders;  // later readings of the stage clock belong to no frame
  frame_.others = spent;
  for (const Duration stage : frame_.stages) frame_.others -= stage;
  frame_.usage = ThreadUsage::of_this_thread().since(usage_begin_);
  ready_end_ = ready_time();
  frame_.ready_during = ready_end_ - ready_begin_;
  ++frames_;
}

// Returns the second number of schedstat: nanoseconds on a run queue.
Duration ExecutionMeter::ready_time() const {
  std::array<char, 96> text{};
  const ssize_t size = schedule_file_ >= 0 ? ::pread(schedule_file_, text.data(), text.size(), 0) : -1;
  if (size <= 0) return {};
  const char* const end = text.data() + size;
  const char* const gap = std::find<const char*>(text.data(), end, ' ');
  Duration::rep ready = 0;
  if (gap != end) std::from_chars(gap + 1, end, ready);
  return Duration(ready);
}

Duration ExecutionMeter::reading_cost() {
  constexpr std::size_t kTimes = 1001;
  std::array<Duration, kTimes> costs{};
  for (Duration& cost : costs) {
    const Instant begin = hal::MonotonicClock::read();
    static_cast<void>(processor_time());
    cost = hal::MonotonicClock::read() - begin;
  }
  return statistics::median(costs);
}

}  // namespace touchline::latency
