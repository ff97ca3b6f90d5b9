#pragma once

#include <cstdint>

// Messages between the arena on the host and the feeder in the guest, over a virtio-serial port. Each message starts
// with its header; both ends are little endian.
namespace touchline::board {

constexpr std::uint32_t kWireMagic = 0x31464C54;  // "TLF1"

enum class ToGuest : std::uint32_t {
  kFrame,      // followed by a picture of `bytes`, to be shown when it is due
  kNoFrame,    // no picture: the camera delivers nothing, but the period passes
  kTornFrame,  // followed by a picture of `bytes`, a part of which must be lost in transmission
  kPlug,       // open the camera device with this format; answered when it is open
  kUnplug,     // close the camera device; answered when it is closed
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
  std::int32_t error = 0;    // errno of opening or writing the device; 0: success
  std::int32_t late_us = 0;  // delay of the frame by the guest's clock
};

}  // namespace touchline::board
