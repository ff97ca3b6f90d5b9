#pragma once

#include <optional>

#include "core/time.h"

namespace touchline::hal {

/// Converts the times of a sender to our clock. The clocks differ by an unknown, slowly changing time, and each packet
/// is on its way for an unknown time. The packet that was fastest tells the difference best, so the difference is the
/// smallest of arrival minus time of sending over the last 5 to 10 s: clocks of computers drift by less than 0.1 ms per
/// second, and a frame is then stamped at most one shortest way (0.1 ms in a local network) too late.
class CaptureEstimate {
 public:
  /// Returns the time of capture on our clock, at most `arrival`. `captured_s`, `sent_s`: on the sender's clock.
  /// Without `sent_s`, the sender's processing time is part of the way, and only its variation is removed. Without
  /// `captured_s`, the time of capture is that of the arrival.
  Instant capture_time(std::optional<double> captured_s, std::optional<double> sent_s, Instant arrival);

 private:
  bool has_difference_ = false;
  Duration recent_{}, former_{};  // smallest difference of the present period, and of the one before
  Instant begin_{};               // of the present period
};

}  // namespace touchline::hal
