#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.h"

namespace touchline::console {

/// Size and quality of a picture.
struct PictureLevel {
  int divisor = 1;  // divisor of width and height
  int quality = 80;

  friend bool operator==(const PictureLevel&, const PictureLevel&) = default;
};

/// Decides how large a client's pictures are and when the next one may be sent. At most two pictures are in flight,
/// because pictures in the buffers of a slow link would delay everything after them. A client that shows pictures
/// slowly gets fewer; a link that carries them slowly gets smaller ones. The class uses no clock.
class LinkControl {
 public:
  static constexpr std::size_t kMaxUnacknowledged = 2;

  /// `divisor`: divisor for the largest picture that the client wants; `period`: time between its pictures.
  void set(int divisor, Duration period);
  [[nodiscard]] bool may_send() const { return waiting_ < kMaxUnacknowledged; }
  /// Records a picture that was sent. `end`: position of its last byte among all bytes sent to the client.
  void sent(std::uint64_t number, std::size_t bytes, std::uint64_t end, Instant now);
  /// Records that the client has received this picture, and so all earlier ones.
  void seen(std::uint64_t number);
  /// Returns whether pictures are in flight whose arrival was not yet reported with delivered().
  [[nodiscard]] bool is_measuring() const { return on_the_way() > 0; }
  /// Records that the other computer has received everything up to this position. `round_trip`: time that a small
  /// message and its answer take.
  void delivered(std::uint64_t position, Instant now, Duration round_trip);
  /// Returns the number of pictures whose arrival was not reported with delivered().
  [[nodiscard]] std::size_t on_the_way() const { return measured_; }
  [[nodiscard]] PictureLevel level() const;
  /// Returns the bytes per second of the last pictures; 0 if unknown.
  [[nodiscard]] double throughput() const { return throughput_; }
  [[nodiscard]] std::size_t unacknowledged() const { return waiting_; }

 private:
  void judge(Duration transfer, std::size_t bytes);

  std::array<std::uint64_t, kMaxUnacknowledged> numbers_{};  // numbers of unacknowledged pictures, oldest first
  std::size_t waiting_ = 0;
  int divisor_ = 1;
  Duration period_ = std::chrono::milliseconds(67);
  std::size_t step_ = 0;      // index in the ladder of sizes and qualities
  int good_in_sequence_ = 0;  // number of consecutive fast deliveries
  // Pictures in flight, oldest first. The client may say that it has seen them before their arrival is reported.
  struct OnTheWay {
    std::size_t bytes = 0;
    std::uint64_t end = 0;
    Instant sent{};
  };
  std::array<OnTheWay, 2 * kMaxUnacknowledged> on_the_way_{};
  std::size_t measured_ = 0;
  Instant last_delivered_{};
  double throughput_ = 0.0;
};

}  // namespace touchline::console
