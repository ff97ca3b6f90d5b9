#include "tools/programs/latency/report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <type_traits>

namespace touchline::latency {
namespace {

using nlohmann::ordered_json;

// The keys are declared once, in the describe functions; Writer and Reader visit them.

template <class Array>
struct BySpan {
  Array& values;
  template <class Visitor>
  static void describe(const BySpan& self, Visitor& visit) {
    for (std::size_t i = 0; i < kSpanCount; ++i) visit(latency::describe(static_cast<Span>(i)), self.values[i]);
  }
};

template <class Array>
BySpan(Array&) -> BySpan<Array>;

template <class Array>
struct ByExecutedPart {
  Array& values;
  template <class Visitor>
  static void describe(const ByExecutedPart& self, Visitor& visit) {
    for (std::size_t i = 0; i < kExecutedParts; ++i) {
      visit(latency::describe(static_cast<Span>(kFirstExecuted + i)), self.values[i]);
    }
  }
};

template <class Array>
ByExecutedPart(Array&) -> ByExecutedPart<Array>;

template <class Self, class Visitor>
void describe_frame(Self& frame, Visitor& visit) {
  visit("number", frame.number);
  visit("times_ns", BySpan{frame.times});
  visit("waited_ns", ByExecutedPart{frame.waits.waited});
  visit("ready_before_ns", frame.waits.ready_before);
  visit("ready_during_ns", frame.waits.ready_during);
  visit("usage", frame.waits.usage);
  visit("timer_late_ns", frame.waits.timer_late);
}

template <class Self, class Visitor>
void describe_stall(Self& stall, Visitor& visit) {
  visit("number", stall.number);
  visit("excess_ns", stall.excess);
  visit("part", stall.part);
  visit("delayed", stall.delayed);
  visit("lost", stall.lost);
}

template <class Self, class Visitor>
void describe_report(Self& report, Visitor& visit) {
  visit("source", report.source);
  visit("measured_at", report.measured_at);
  visit("frames", report.frames);
  visit("warm_up", report.warm_up);
  visit("rate_hz", report.rate_hz);
  visit("time", report.time);
  visit("planted", report.planted);
  visit("saved", report.saved);
  visit("deadline_ns", report.deadline);
  visit("deadline_misses", report.deadline_misses);
  visit("period_overruns", report.period_overruns);
  visit("lost", report.lost);
  visit("stall_count", report.stall_count);
  visit("stall_delayed", report.stall_delayed);
  visit("stall_lost", report.stall_lost);
  visit("stalls", report.stalls);
  visit("overloads", report.overloads);
  visit("allocations", report.allocations);
  visit("usage", report.usage);
  visit("reading_cost_ns", report.reading_cost);
  visit("spans_ns", BySpan{report.spans});
  visit("worst_frames", report.worst);
  visit("rare_frames", report.rare_frames);
  visit("noise", report.noise);
  visit("led", report.led);
  visit("console", report.console);
  visit("system", report.system);
  // Stored as pairs of bin and count; bin i begins at 100 ns * 10^(i / 20).
  visit("histograms", BySpan{report.histograms});
}

class Writer {
 public:
  explicit Writer(ordered_json& json) : json_(json) {}

  template <class T>
  void operator()(const char* key, const T& value) {
    write(json_[key], value);
  }

 private:
  static void write(ordered_json& json, const Duration& value) { json = value.count(); }
  static void write(ordered_json& json, const LogHistogram& value) {
    json = ordered_json::array();
    for (std::size_t i = 0; i < LogHistogram::kBins; ++i) {
      if (value.counts[i] > 0) json.push_back({i, value.counts[i]});
    }
  }
  static void write(ordered_json& json, const Span& value) { json = describe(value); }
  static void write(ordered_json& json, const WorstFrame& frame) {
    Writer writer(json);
    describe_frame(frame, writer);
  }
  static void write(ordered_json& json, const Stall& stall) {
    Writer writer(json);
    describe_stall(stall, writer);
  }
  template <class T>
  requires(!std::is_same_v<T, std::string>) static void write(ordered_json& json, const std::vector<T>& values) {
    json = ordered_json::array();
    for (const T& value : values) write(json.emplace_back(), value);
  }
  template <class T>
  static void write(ordered_json& json, const std::optional<T>& value) {
    if (value) write(json, *value);
  }
  template <class T>
  static void write(ordered_json& json, const T& value) {
    if constexpr (requires(Writer & visit) { T::describe(value, visit); }) {
      Writer writer(json);
      T::describe(value, writer);
    } else {
      json = value;
    }
  }

  ordered_json& json_;
};

class Reader {
 public:
  // Keeps the first error and skips all later values.
  Reader(const ordered_json& json, std::string path, Result<void>& result)
      : json_(json), path_(std::move(path)), result_(result) {}

  template <class T>
  void operator()(const char* key, T&& value) {
    if (!result_.ok()) return;
    const std::string path = path_ + key;
    if (json_.is_object() && !json_.contains(key) && is_optional(value)) {
      // The report was written by a version that did not measure this value.
    } else if (!json_.is_object() || !json_.contains(key)) {
      result_ = failure(ErrorCode::kInconsistent, "%s: is missing", path.c_str());
    } else {
      read(json_[key], path, value);
    }
  }

 private:
  template <class T>
  static constexpr bool is_optional(const std::optional<T>&) {
    return true;
  }
  template <class T>
  static constexpr bool is_optional(const T&) {
    return false;
  }
  void refuse(const std::string& path, const char* expected) {
    result_ = failure(ErrorCode::kInconsistent, "%s: must be %s", path.c_str(), expected);
  }

  void read(const ordered_json& json, const std::string& path, std::uint64_t& value) {
    json.is_number_unsigned() ? static_cast<void>(value = json.get<std::uint64_t>()) : refuse(path, "a count");
  }
  void read(const ordered_json& json, const std::string& path, std::int64_t& value) {
    json.is_number_integer() ? static_cast<void>(value = json.get<std::int64_t>()) : refuse(path, "an integer");
  }
  void read(const ordered_json& json, const std::string& path, double& value) {
    json.is_number() ? static_cast<void>(value = json.get<double>()) : refuse(path, "a number");
  }
  void read(const ordered_json& json, const std::string& path, std::string& value) {
    json.is_string() ? static_cast<void>(value = json.get<std::string>()) : refuse(path, "a text");
  }
  void read(const ordered_json& json, const std::string& path, Duration& value) {
    std::int64_t count = 0;
    read(json, path, count);
    value = Duration(count);
  }
  template <class T>
  void read(const ordered_json& json, const std::string& path, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) read(json, path, value.emplace());
  }
  void read(const ordered_json& json, const std::string& path, LogHistogram& value) {
    if (!json.is_array()) return refuse(path, "a list");
    for (const ordered_json& pair : json) {
      const bool good = pair.is_array() && pair.size() == 2 && pair[0].is_number_unsigned() &&
                        pair[1].is_number_unsigned() && pair[0].get<std::size_t>() < LogHistogram::kBins;
      if (!good) return refuse(path, "a list of bins and counts");
      value.counts[pair[0].get<std::size_t>()] = pair[1].get<std::uint64_t>();
    }
  }
  template <class T>
  void read(const ordered_json& json, const std::string& path, std::vector<T>& values) {
    if (!json.is_array()) return refuse(path, "a list");
    for (std::size_t i = 0; i < json.size() && result_.ok(); ++i) {
      read(json[i], path + "[" + std::to_string(i) + "]", values.emplace_back());
    }
  }
  void read(const ordered_json& json, const std::string& path, Span& span) {
    for (std::size_t i = 0; i < kSpanCount; ++i) {
      if (json != describe(static_cast<Span>(i))) continue;
      span = static_cast<Span>(i);
      return;
    }
    refuse(path, "the name of a span");
  }
  void read(const ordered_json& json, const std::string& path, WorstFrame& frame) {
    Reader reader(json, path + ".", result_);
    describe_frame(frame, reader);
  }
  void read(const ordered_json& json, const std::string& path, Stall& stall) {
    Reader reader(json, path + ".", result_);
    describe_stall(stall, reader);
  }
  template <class T>
  requires requires(T& value, Reader& visit) { T::describe(value, visit); }
  void read(const ordered_json& json, const std::string& path, T& value) {
    Reader reader(json, path + ".", result_);
    T::describe(value, reader);
  }

  const ordered_json& json_;
  const std::string path_;
  Result<void>& result_;
};

// `before`: the text before the first wrong character.
Error not_json_after(std::string_view before) {
  const auto line = static_cast<long>(1 + std::count(before.begin(), before.end(), '\n'));
  const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;
  return failure(ErrorCode::kInconsistent, "line %ld, column %zu: is not JSON", line, column);
}

}  // namespace

std::string to_json(const LatencyReport& report) {
  ordered_json json;
  Writer writer(json);
  writer("format", LatencyReport::kFormat);
  describe_report(report, writer);
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<LatencyReport> from_json(const std::string& text) {
  ordered_json json;
  try {
    json = ordered_json::parse(text);
  } catch (const ordered_json::parse_error& fault) {
    return not_json_after(std::string_view(text).substr(0, fault.byte - 1));
  } catch (const ordered_json::out_of_range&) {
    return failure(ErrorCode::kOutOfRange, "contains a number that is too large");
  }
  Result<void> result;
  Reader reader(json, "", result);
  std::int64_t format = 0;
  reader("format", format);
  if (result.ok() && format != LatencyReport::kFormat) {
    return failure(ErrorCode::kInconsistent, "format: %lld is not supported; this program reads format %lld",
                   static_cast<long long>(format), static_cast<long long>(LatencyReport::kFormat));
  }
  LatencyReport report;
  describe_report(report, reader);
  TOUCHLINE_TRY(result);
  return report;
}

}  // namespace touchline::latency
