#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/result.h"
#include "hal/true_places.h"

// Pictures over TCP, for a camera that is another program (docs/hil.md). The sender listens. On each connection it
// sends one StreamHello and then pictures, each after its PictureHeader. In lock-step, the receiver sends one byte
// kNextPicture for each picture. Numbers are little-endian.
namespace touchline::hal {

/// What a connection carries.
struct StreamHello {
  CameraFormat format = CameraFormat::kYuyv;  // kMjpg: JPEG files; else pictures without padding (picture_layout())
  std::uint16_t width_px = 0, height_px = 0;
  std::uint32_t rate_mhz = 0;  // thousandths of a hertz
  bool lockstep = false;
};
constexpr std::size_t kStreamHelloBytes = 40;
using StreamHelloBytes = std::array<std::byte, kStreamHelloBytes>;

/// Comes before the bytes of each picture. Times are on the sender's clock. Its bytes are: "TLFR", `bytes` and
/// `sequence` with 4 bytes each, the three times with 8, 1 or 0 for a known truth, the number of its robots, the ball's
/// x and y, and 22 places for robots: 1 byte for the team, 1 for the id, x, y and heading. Unused ones are 0. Places
/// are 32-bit floating point numbers in meters and radians.
struct PictureHeader {
  std::uint32_t bytes = 0;     // of the picture that follows
  std::uint32_t sequence = 0;  // counts pictures taken: a gap is a picture that was not sent
  std::int64_t captured_ns = 0, ready_ns = 0, sent_ns = 0;
  TruePlaces truth{};
};
constexpr std::size_t kPictureHeaderBytes = 36 + 10 + kMaxRobots * 14;
using PictureHeaderBytes = std::array<std::byte, kPictureHeaderBytes>;

constexpr std::byte kNextPicture{'N'};

/// Returns the largest number of bytes of a picture: a JPEG may be as large as the decoded picture.
std::size_t largest_picture(CameraFormat format, std::uint16_t width_px, std::uint16_t height_px);

StreamHelloBytes encode(const StreamHello& hello);
PictureHeaderBytes encode(const PictureHeader& header);
/// kInconsistent: the bytes are not from a sender of pictures; the message says what is wrong.
Result<StreamHello> parse_stream_hello(std::span<const std::byte, kStreamHelloBytes> bytes);
/// kInconsistent: not a header, the picture is empty or larger than `largest` bytes, or its truth is impossible.
Result<PictureHeader> parse_picture_header(std::span<const std::byte, kPictureHeaderBytes> bytes, std::size_t largest);

}  // namespace touchline::hal
