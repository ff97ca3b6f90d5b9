#include "tools/programs/latency/led_analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "tools/programs/statistics/statistics.h"

namespace touchline::latency {
namespace {

// A frame near an edge: its time stamp relative to the edge, and the share of the change that it shows (0 to 1).
struct Transition {
  double after_s = 0.0, share = 0.0;
};

// Time at which the share crosses one half. Because of noise, late frames that show less and early frames that show
// more overlap; the crossing is placed where the fewest frames are on the wrong side.
struct Crossing {
  double after_s = 0.0, half_width_s = 0.0;
};
std::optional<Crossing> crossing(std::vector<Transition> frames) {
  std::sort(frames.begin(), frames.end(),
            [](const Transition& a, const Transition& b) { return a.after_s < b.after_s; });
  const auto is_changed = [](const Transition& frame) { return frame.share >= 0.5; };
  // Begin with a crossing before all frames: then the unchanged frames are on the wrong side.
  auto wrong = std::count_if(frames.begin(), frames.end(), [&](const Transition& frame) { return !is_changed(frame); });
  auto best = wrong;
  double first = 0.0, last = 0.0;
  bool is_found = false;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    wrong += is_changed(frames[i]) ? 1 : -1;
    if (is_found && wrong == best) last = frames[i + 1].after_s;
    if (wrong >= best) continue;
    best = wrong;
    is_found = true;
    first = frames[i].after_s;
    last = frames[i + 1].after_s;
  }
  if (!is_found) return std::nullopt;
  return Crossing{0.5 * (first + last), 0.5 * (last - first)};
}

// Returns the median brightness of the frames that are two periods away from all edges and whose last edge was of this
// kind.
std::optional<double> level_after(bool on, std::span<const LedFrame> frames, std::span<const LedEdge> edges,
                                  Duration period) {
  std::vector<double> levels;
  for (const LedFrame& frame : frames) {
    const auto next = std::upper_bound(edges.begin(), edges.end(), frame.captured,
                                       [](Instant time, const LedEdge& edge) { return time < edge.time; });
    if (next == edges.begin() || std::prev(next)->on != on) continue;
    const bool is_near = frame.captured - std::prev(next)->time < 2 * period ||
                         (next != edges.end() && next->time - frame.captured < 2 * period);
    if (!is_near) levels.push_back(frame.level);
  }
  constexpr std::size_t kMin = 5;
  if (levels.size() < kMin) return std::nullopt;
  return statistics::median(levels);
}

}  // namespace

std::string parse_led_place(const std::string& text, LedPlace& place) {
  char extra = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &place.u_px, &place.v_px, &place.radius_px, &extra);
  const bool separated = std::count(text.begin(), text.end(), ',') == read - 1;
  const bool good = (read == 2 || read == 3) && separated && place.u_px >= 0.0 && place.v_px >= 0.0 &&
                    place.radius_px >= 0.5 && place.radius_px <= 200.0;
  return good ? "" : text + ": must be U,V or U,V,RADIUS in pixels, with a radius of 0.5 to 200";
}

LedReport analyze_led(std::span<const LedFrame> frames, std::span<const LedEdge> edges, Duration period) {
  LedReport report;
  const std::optional<double> on = level_after(true, frames, edges, period);
  const std::optional<double> off = level_after(false, frames, edges, period);
  if (!on || !off) {
    report.refusal = "too few edges; measure longer";
    return report;
  }
  report.on_level = *on;
  report.off_level = *off;
  constexpr double kMinContrast = 10.0;
  if (*on - *off < kMinContrast) {
    char reason[120];
    std::snprintf(reason, sizeof reason, "the LED is not visible there: brightness %.0f when on, %.0f when off", *on,
                  *off);
    report.refusal = reason;
    return report;
  }
  LatencySamples light_to_packet(edges.size()), capture_to_packet(edges.size());
  std::array<std::vector<Transition>, 2> transitions;
  for (const LedEdge& edge : edges) {
    if (edge.uncertainty > kLargestUncertainty) {
      ++report.uncertain;
      continue;
    }
    const auto begin = std::partition_point(
        frames.begin(), frames.end(), [&](const LedFrame& frame) { return frame.captured < edge.time - 2 * period; });
    bool is_seen = false, is_partial = false;
    for (auto frame = begin; frame != frames.end() && frame->captured < edge.time + 4 * period; ++frame) {
      const double share_on = (frame->level - *off) / (*on - *off);
      const double share = edge.on ? share_on : 1.0 - share_on;
      transitions[edge.on ? 1 : 0].push_back({seconds(frame->captured - edge.time), share});
      is_partial = is_partial || (share > 0.1 && share < 0.9);
      if (is_seen || share < 0.5 || frame->sent < edge.time) continue;
      is_seen = true;
      light_to_packet.add(frame->sent - edge.time);
      capture_to_packet.add(frame->sent - frame->captured);
    }
    report.edges += is_seen ? 1 : 0;
    report.partial += is_partial ? 1 : 0;
  }
  report.light_to_packet = light_to_packet.summarize();
  report.capture_to_packet = capture_to_packet.summarize();
  const std::optional<Crossing> rising = crossing(transitions[1]), falling = crossing(transitions[0]);
  if (rising && falling) {
    report.stamp_error = from_seconds(0.5 * (rising->after_s + falling->after_s));
    report.stamp_resolution = from_seconds(0.5 * (rising->half_width_s + falling->half_width_s));
  }
  if (report.edges == 0) report.refusal = "no edge was seen";
  return report;
}

}  // namespace touchline::latency
