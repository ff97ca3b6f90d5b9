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

// Room in front of every message for the header that the server adds; LWS_PRE is 16.
inline constexpr std::size_t kMessagePrefix = 64;
inline constexpr std::size_t kPictureHeaderBytes = 32;
inline constexpr std::uint32_t kPictureMagic = 0x43504C54;  // "TLPC"
// Kinds of binary messages; 2 and 3 are those of the setup program.
inline constexpr std::uint8_t kCameraKind = 1, kClassesKind = 4, kLightKind = 5;

/// Asks the loop for pictures and compresses each at most once per size and quality.
class PictureSource {
 public:
  /// `shortest_period`: between two requests.
  PictureSource(PictureExchange& exchange, Duration shortest_period)
      : exchange_(exchange), shortest_period_(shortest_period) {}

  /// Asks for a picture, unless one is on its way or the last one was asked for too recently. The current picture is
  /// given back. `with_findings`: also asks how the picture was understood.
  void request(Instant now, bool with_findings = false);
  /// Forgets request and picture, as the exchange has done.
  void restart() { is_outstanding_ = is_current_ = false; }
  /// Whether a picture has come since the last call.
  bool poll();
  /// Null: there is no picture at the moment.
  [[nodiscard]] const Frame* frame() const { return is_current_ ? &exchange_.frame() : nullptr; }
  /// Null: they were not asked for, or there are none.
  [[nodiscard]] const PictureFindings* findings() const { return is_current_ ? exchange_.findings() : nullptr; }
  [[nodiscard]] std::uint64_t number() const { return exchange_.number(); }

  /// The current picture as a message: kMessagePrefix bytes of room, kPictureHeaderBytes for the header, and the JPEG,
  /// of which the span has the bytes. Empty: there is none, or it could not be compressed; see error(). Valid until
  /// the fourth other level is asked for.
  std::span<std::byte> jpeg(PictureLevel level);
  /// The first error; "" if there was none.
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
  // Number of levels that are kept, enough for so many different links at a time.
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
