#pragma once

#include <cstdint>

// What the arena on the host and the feeder in the guest say to each other, over a port of virtio-serial: whole
// messages, each with its header first; both ends are little endian.
namespace touchline::board {

constexpr std::uint32_t kWireMagic = 0x31464C54;  // "TLF1"

enum class ToGuest : std::uint32_t {
  kFrame,      // `bytes` of picture follow; to be shown at its time
  kNoFrame,    // the same without a picture: the camera has nothing to show, time goes on
  kTornFrame,  // `bytes` of picture follow, of which some get lost on the way
  kPlug,       // open the camera's device, so that it offers pictures of this format; the answer comes when it does
  kUnplug,     // close it; the answer comes when it is closed
};

constexpr bool has_picture(ToGuest kind) { return kind == ToGuest::kFrame || kind == ToGuest::kTornFrame; }

struct FrameHeader {
  std::uint32_t magic = kWireMagic;
  ToGuest kind = ToGuest::kFrame;
  std::uint32_t number = 0, period_us = 0;
  std::uint32_t fourcc = 0, width_px = 0, height_px = 0, bytes = 0;
};

struct FrameAnswer {
  std::uint32_t magic = kWireMagic;
  std::uint32_t number = 0;
  std::int32_t error = 0;    // errno of opening or writing the device, 0: shown
  std::int32_t late_us = 0;  // by the guest's clock, behind the frame's time
};

}  // namespace touchline::board
