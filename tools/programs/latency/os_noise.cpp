#include "tools/programs/latency/os_noise.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace touchline::latency {
namespace {

using Kind = TraceEvent::Kind;

struct EventName {
  std::string_view marker;
  Kind kind;
};
constexpr std::array kEventNames{
    EventName{": thread_noise: ", Kind::kThread},         EventName{": irq_noise: ", Kind::kInterrupt},
    EventName{": softirq_noise: ", Kind::kSoftInterrupt}, EventName{": nmi_noise: ", Kind::kNonMaskable},
    EventName{": sched_waking: ", Kind::kWaking},         EventName{": sched_switch: ", Kind::kSwitch}};

const char* word_of(Kind kind) {
  switch (kind) {
    case Kind::kInterrupt:
      return "interrupt";
    case Kind::kSoftInterrupt:
      return "softirq";
    case Kind::kNonMaskable:
      return "NMI";
    case Kind::kThread:
    case Kind::kWaking:
    case Kind::kSwitch:
      break;
  }
  return "thread";
}

template <class Number>
std::optional<Number> number_at(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

// The number behind the last `key`: names of programs come first, and may contain anything.
template <class Number>
std::optional<Number> number_after(std::string_view text, std::string_view key) {
  const std::size_t at = text.rfind(key);
  if (at == std::string_view::npos) return std::nullopt;
  return number_at<Number>(text.substr(at + key.size()));
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// "6.437518": seconds of CLOCK_MONOTONIC with six decimals, at the end of `text`.
std::optional<Instant> time_at_end(std::string_view text) {
  text = text.substr(text.rfind(' ') + 1);
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos || text.size() - dot != 7) return std::nullopt;
  const auto seconds = number_at<Duration::rep>(text.substr(0, dot));
  const auto microseconds = number_at<Duration::rep>(text.substr(dot + 1));
  if (!seconds || !microseconds) return std::nullopt;
  return Instant{} + std::chrono::seconds(*seconds) + std::chrono::microseconds(*microseconds);
}

// "   rcuc/1:32 start 9.229984317 duration 220784 ns"; of an NMI without the name.
bool parse_noise(std::string_view text, TraceEvent& event) {
  const auto duration_ns = number_after<Duration::rep>(text, " duration ");
  if (!duration_ns) return false;
  event.duration = Duration(*duration_ns);
  if (event.kind == Kind::kNonMaskable) {
    event.name = "NMI";
    return true;
  }
  const std::string_view source = trimmed(text.substr(0, text.rfind(" start ")));
  const std::size_t colon = source.rfind(':');
  const auto id = colon == std::string_view::npos ? std::nullopt : number_at<int>(source.substr(colon + 1));
  if (!id) return false;
  event.name = source.substr(0, colon);
  event.thread = event.kind == Kind::kThread ? *id : 0;
  return true;
}

bool parse_waking(std::string_view text, TraceEvent& event) {
  const auto id = number_after<int>(text, " pid=");
  event.thread = id.value_or(0);
  return id.has_value();
}

// "prev_comm=a prev_pid=1 prev_prio=120 prev_state=R+ ==> next_comm=b next_pid=2 next_prio=98"
bool parse_switch(std::string_view text, TraceEvent& event) {
  constexpr std::string_view kState = " prev_state=", kArrow = " ==> ";
  const std::size_t arrow = text.find(kArrow, text.find(kState));
  if (arrow == std::string_view::npos) return false;
  const std::string_view former = text.substr(0, arrow);
  const auto from = number_after<int>(former, " prev_pid="), to = number_after<int>(text.substr(arrow), " next_pid=");
  if (!from || !to) return false;
  event.former_thread = *from;
  event.thread = *to;
  event.former_is_ready = former.substr(former.rfind(kState) + kState.size()).starts_with('R');
  return true;
}

}  // namespace

std::optional<TraceEvent> parse_trace_line(std::string_view line) {
  for (const EventName& name : kEventNames) {
    const std::size_t at = line.find(name.marker);
    if (at == std::string_view::npos) continue;
    const std::string_view text = line.substr(at + name.marker.size());
    const auto time = time_at_end(line.substr(0, at));
    if (!time) return std::nullopt;
    TraceEvent event;
    event.kind = name.kind;
    event.time = *time;
    const bool good = name.kind == Kind::kWaking   ? parse_waking(text, event)
                      : name.kind == Kind::kSwitch ? parse_switch(text, event)
                                                   : parse_noise(text, event);
    return good ? std::optional(event) : std::nullopt;
  }
  return std::nullopt;
}

std::uint32_t OsNoise::source_of(const TraceEvent& event) {
  const auto [found, is_new] = source_numbers_.try_emplace(std::pair(std::string(event.name), event.kind),
                                                           static_cast<std::uint32_t>(sources_.size()));
  if (is_new) {
    NoiseSource& source = sources_.emplace_back();
    source.name = event.name;
    source.kind = word_of(event.kind);
  }
  return found->second;
}

void OsNoise::add(std::string_view line) {
  constexpr std::string_view kLost = " [LOST ";
  if (const std::size_t at = line.find(kLost); at != std::string_view::npos && line.starts_with("CPU:")) {
    lost_ += number_at<std::uint64_t>(line.substr(at + kLost.size())).value_or(0);
    return;
  }
  const std::optional<TraceEvent> event = parse_trace_line(line);
  if (!event) return;
  const bool is_noise = event->kind != Kind::kWaking && event->kind != Kind::kSwitch;
  // The thread itself, and the idle thread, take the processor from nobody.
  if (event->kind == Kind::kThread && (event->thread == thread_ || event->thread == 0)) return;
  if (events_.size() >= capacity_) {
    ++lost_;
    return;
  }
  Stored& stored = events_.emplace_back();
  stored.event = *event;
  stored.event.name = {};
  if (is_noise) stored.source = source_of(*event);
}

// How long the thread was awake in [begin, end], until now.
Duration OsNoise::overlap(Instant begin, Instant end, std::optional<Instant> awake_since) const {
  Duration sum{};
  if (awake_since && *awake_since < end) sum += end - std::max(begin, *awake_since);
  for (auto i = awake_.rbegin(); i != awake_.rend() && i->end > begin; ++i) {
    sum += std::max(Duration::zero(), std::min(end, i->end) - std::max(begin, i->begin));
  }
  return sum;
}

void OsNoise::finish() {
  std::stable_sort(events_.begin(), events_.end(),
                   [](const Stored& a, const Stored& b) { return a.event.time < b.event.time; });
  std::optional<Instant> awake_since;
  const Instant first = events_.empty() ? Instant{} : events_.front().event.time;
  for (const auto& [event, source] : events_) {
    if (event.kind == Kind::kWaking || (event.kind == Kind::kSwitch && event.thread == thread_)) {
      if (event.thread == thread_ && !awake_since) awake_since = event.time;
    } else if (event.kind == Kind::kSwitch) {
      if (event.former_thread != thread_) continue;
      // Without a waking before it, the thread was awake when the trace began.
      if (!awake_since && awake_.empty()) awake_since = first;
      if (event.former_is_ready || !awake_since) continue;
      awake_.push_back({*awake_since, event.time});
      awake_since.reset();
    } else {
      // The first event of a thread may have a duration since the start of the system.
      const Instant begin = std::max(first, event.time - event.duration);
      const Duration taken = overlap(begin, event.time, awake_since);
      if (taken > Duration::zero()) thefts_.push_back({event.time, taken, source});
    }
  }
  events_ = {};
}

std::vector<NoiseSource> OsNoise::between(Instant begin, Instant end) const {
  std::vector<NoiseSource> found = sources_;
  const auto later = [](Instant time, const Theft& theft) { return time < theft.end; };
  for (auto i = std::upper_bound(thefts_.begin(), thefts_.end(), begin, later); i != thefts_.end() && i->end <= end;
       ++i) {
    NoiseSource& source = found[i->source];
    ++source.count;
    source.total += i->taken;
    source.longest = std::max(source.longest, i->taken);
  }
  std::erase_if(found, [](const NoiseSource& source) { return source.count == 0; });
  std::stable_sort(found.begin(), found.end(),
                   [](const NoiseSource& a, const NoiseSource& b) { return a.total > b.total; });
  return found;
}

}  // namespace touchline::latency
