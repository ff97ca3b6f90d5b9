#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/time.h"
#include "tools/programs/latency/latency_samples.h"

namespace touchline::latency {

/// Disc of the picture in which the LED is seen.
struct LedPlace {
  double u_px = 0.0, v_px = 0.0, radius_px = 3.0;
};

/// Reads "600,30" or "600,30,5" (pixels). Returns the error; "" if there is none.
std::string parse_led_place(const std::string& text, LedPlace& place);

/// A change of the LED's line. Here and below, times are on the loop's clock.
struct LedEdge {
  Instant time{};
  bool on = false;
  Duration uncertainty{};  // largest possible error of `time`, in both directions
};

/// Data of one frame.
struct LedFrame {
  Instant captured{}, sent{};  // the driver's time stamp; time at which the radio accepted the frame's packet
  double level = 0.0;          // brightness, 0 to 255
};

/// Comparison of the LED in the picture with the edges of its line.
struct LedReport {
  std::string refusal;          // reason why there is no result; empty: there is one
  std::uint64_t edges = 0;      // edges that were seen
  std::uint64_t uncertain = 0;  // edges not used, because their time is uncertain by more than kLargestUncertainty
  double off_level = 0.0, on_level = 0.0;
  // From the edge until the packet of the first frame that shows at least half of the change.
  LatencySummary light_to_packet;
  LatencySummary capture_to_packet;     // for the same frames
  std::uint64_t partial = 0;            // edges that fell into an exposure
  std::optional<Duration> stamp_error;  // the driver's time stamp minus the middle of the exposure
  Duration stamp_resolution{};          // approximate error of stamp_error

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit("refusal", self.refusal);
    visit("edges", self.edges);
    visit("uncertain", self.uncertain);
    visit("off_level", self.off_level);
    visit("on_level", self.on_level);
    visit("light_to_packet_ns", self.light_to_packet);
    visit("capture_to_packet_ns", self.capture_to_packet);
    visit("partial", self.partial);
    visit("stamp_error_ns", self.stamp_error);
    visit("stamp_resolution_ns", self.stamp_resolution);
  }
};

inline constexpr Duration kLargestUncertainty = std::chrono::microseconds(300);

/// `frames` and `edges` must be in the order of time. The error of the stamps follows from the time at which the
/// brightness crosses the middle between off and on. It is the mean of rising and falling edges, so that the camera's
/// tone curve has no effect.
LedReport analyze_led(std::span<const LedFrame> frames, std::span<const LedEdge> edges, Duration period);

}  // namespace touchline::latency
