#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/console/jpeg_encoder.h"
#include "firmware/console/link_control.h"
#include "firmware/picture_exchange.h"

namespace touchline::console {

// Free bytes in front of every message, for the header that the server adds; LWS_PRE is 16.
inline constexpr std::size_t kMessagePrefix = 64;
inline constexpr std::size_t kPictureHeaderBytes = 32;
inline constexpr std::uint32_t kPictureMagic = 0x43504C54;  // the bytes "TLPC"
// Kinds of binary messages; kinds 2 and 3 belong to the setup program.
inline constexpr std::uint8_t kCameraKind = 1, kClassesKind = 4, kLightKind = 5;

/// Requests pictures from the loop and compresses each at most once per size and quality.
class PictureSource {
 public:
  /// `shortest_period`: shortest time between two requests.
  PictureSource(PictureExchange& exchange, Duration shortest_period)
      : exchange_(exchange), shortest_period_(shortest_period) {}

  /// Requests a picture, unless one was requested and has not arrived, or the last request is too recent. The current
  /// picture is returned to the loop. `with_findings`: also requests how the picture was understood.
  void request(Instant now, bool with_findings = false);
  /// Forgets request and picture, because the exchange has been restarted.
  void restart() { is_outstanding_ = is_current_ = false; }
  /// Returns whether a picture has arrived since the last call.
  bool poll();
  /// Returns null if there is no picture at the moment.
  [[nodiscard]] const Frame* frame() const { return is_current_ ? &exchange_.frame() : nullptr; }
  /// Returns null if findings were not requested, or there are none.
  [[nodiscard]] const PictureFindings* findings() const { return is_current_ ? exchange_.findings() : nullptr; }
  [[nodiscard]] std::uint64_t number() const { return exchange_.number(); }

  /// Returns the JPEG of the current picture; in memory, kMessagePrefix free bytes and kPictureHeaderBytes for the
  /// header precede it. Empty if there is no picture, or it could not be compressed; see error(). Valid until four
  /// other levels have been requested.
  std::span<std::byte> jpeg(PictureLevel level);
  /// Returns the first error; "" if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] std::uint64_t compressed() const { return compressed_; }

 private:
  struct Encoded {
    bool is_valid = false;
    std::uint64_t number = 0;
    PictureLevel level;
    std::size_t bytes = 0;
    std::vector<std::byte> memory;
  };
  // Number of levels that are kept, enough for as many links of different speed.
  static constexpr std::size_t kEncoded = 4;

  PictureExchange& exchange_;
  const Duration shortest_period_;
  JpegEncoder encoder_;
  std::array<Encoded, kEncoded> encoded_;
  std::size_t next_ = 0;
  bool is_outstanding_ = false, is_current_ = false;
  Instant requested_{};
  std::string error_;
  std::uint64_t compressed_ = 0;
};

}  // namespace touchline::console
