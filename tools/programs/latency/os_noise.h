#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"

namespace touchline::latency {

/// A line of the kernel's trace (events osnoise:*_noise, sched:sched_waking and sched:sched_switch).
struct TraceEvent {
  enum class Kind : std::uint8_t { kThread, kInterrupt, kSoftInterrupt, kNonMaskable, kWaking, kSwitch };
  Kind kind = Kind::kThread;
  Instant time;                  // CLOCK_MONOTONIC; of the end if the event lasted
  Duration duration{};           // without the interrupts within it; zero for kWaking and kSwitch
  std::string_view name;         // of the thread or interrupt; part of the line
  int thread = 0;                // id: of kThread, of the one that wakes up, or of the one that gets the processor
  int former_thread = 0;         // id, kSwitch: of the one that had the processor
  bool former_is_ready = false;  // kSwitch: it was preempted; else it waits for something
};

/// Parses a line of trace_pipe whose clock is "mono". Empty: another event, or no event.
std::optional<TraceEvent> parse_trace_line(std::string_view line);

/// A program, kernel thread or interrupt that executed while the loop could have.
struct NoiseSource {
  std::string name;  // programs by their names, so that ten processes of one program are one source
  std::string kind;  // "thread", "interrupt", "softirq" or "NMI"
  std::uint64_t count = 0;
  Duration total{}, longest{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("kind", self.kind);
    visit("count", self.count);
    visit("total_ns", self.total);
    visit("longest_ns", self.longest);
  }
};

/// What took the processor from one thread, by the kernel's own account (osnoise: "operating system noise"). Only the
/// time counts in which that thread was awake: from its waking to its next wait. What ran while it slept did no harm.
class OsNoise {
 public:
  // Some minutes under a load that changes threads 2000 times a second; about 100 MB.
  static constexpr std::size_t kCapacity = 2'000'000;

  /// `thread`: id of the thread that others disturb.
  explicit OsNoise(int thread, std::size_t capacity = kCapacity) : thread_(thread), capacity_(capacity) {}
  /// Adds a line of the trace. Lines of different processors may come in any order.
  void add(std::string_view line);
  /// Orders the events. Call it once, after the last add().
  void finish();

  /// Sources whose execution ended in (begin, end], the longest first. After finish().
  [[nodiscard]] std::vector<NoiseSource> between(Instant begin, Instant end) const;
  /// Events that the kernel or this object had no room for.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  struct Stored {
    TraceEvent event;  // its name is not valid any more
    std::uint32_t source = 0;
  };
  struct Interval {
    Instant begin, end;
  };
  struct Theft {
    Instant end;
    Duration taken{};
    std::uint32_t source = 0;
  };
  [[nodiscard]] std::uint32_t source_of(const TraceEvent& event);
  [[nodiscard]] Duration overlap(Instant begin, Instant end, std::optional<Instant> awake_since) const;

  int thread_;
  std::size_t capacity_;
  std::uint64_t lost_ = 0;
  std::vector<Stored> events_;
  std::map<std::pair<std::string, TraceEvent::Kind>, std::uint32_t> source_numbers_;
  std::vector<NoiseSource> sources_;  // names and kinds
  std::vector<Interval> awake_;       // in which the thread was awake, without the last one if it lasts
  std::vector<Theft> thefts_;         // by time
};

}  // namespace touchline::latency
