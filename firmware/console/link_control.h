#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"

namespace touchline::console {

/// Size and quality of a picture.
struct PictureLevel {
  int divisor = 1;  // of width and height
  int quality = 80;

  friend bool operator==(const PictureLevel&, const PictureLevel&) = default;
};

/// Decides how large a client's pictures are, by the time that its acknowledgments take. At most two pictures are on
/// their way: what waits in the buffers of a slow link would delay everything after it. No clock.
class LinkControl {
 public:
  static constexpr std::size_t kMaxUnacknowledged = 2;

  /// `divisor`: of the largest picture that the client wants; `period`: between its pictures.
  void set(int divisor, Duration period);
  [[nodiscard]] bool may_send() const { return waiting_ < kMaxUnacknowledged; }
  void sent(std::uint64_t number, std::size_t bytes, Instant now);
  /// The client has received this picture, and with it all earlier ones. `round_trip`: time that the smallest message
  /// and its answer take.
  void seen(std::uint64_t number, Instant now, Duration round_trip);
  [[nodiscard]] PictureLevel level() const;
  /// Bytes per second of the last pictures; 0: not known.
  [[nodiscard]] double throughput() const { return throughput_; }
  /// Time between a picture's sending and its acknowledgment, of the last one.
  [[nodiscard]] Duration delay() const { return delay_; }
  [[nodiscard]] std::size_t unacknowledged() const { return waiting_; }

 private:
  struct SentPicture {
    std::uint64_t number = 0;
    std::size_t bytes = 0;
    Instant time{};
  };
  void measure(const SentPicture& picture, Duration delay, Duration round_trip);

  std::array<SentPicture, kMaxUnacknowledged> pictures_{};  // oldest first
  std::size_t waiting_ = 0;
  int divisor_ = 1;
  Duration period_ = std::chrono::milliseconds(67);
  std::size_t step_ = 0;      // of the ladder
  int good_in_sequence_ = 0;  // pictures that arrived early
  Duration delay_{};
  double throughput_ = 0.0;
};

}  // namespace touchline::console
