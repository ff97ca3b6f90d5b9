#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// A frame size, or a range of sizes.
struct V4l2FrameSize {
  std::uint32_t width_px = 0, height_px = 0;          // the smallest size of a range
  std::uint32_t max_width_px = 0, max_height_px = 0;  // the largest; equal to the smallest for a single size
  std::vector<double> rates_hz;                       // for the largest size, fastest first; both ends of a range
  bool rates_are_range = false;
};

struct V4l2FormatInfo {
  std::uint32_t fourcc = 0;
  std::string code;         // "YUYV"
  std::string word;         // name in the board file; "": not supported by Touchline
  std::string description;  // from the driver
  std::vector<V4l2FrameSize> sizes;
};

/// Formats and sizes that the driver lists. `with_rates`: also the frame rates, one request for each.
std::vector<V4l2FormatInfo> list_formats(const V4l2Device& device, bool multi_planar, bool with_rates);

/// "yuyv 640x480, 320x240; unsupported: GREY". Lists sizes only for formats that Touchline supports.
std::string formats_text(const std::vector<V4l2FormatInfo>& offers);

std::string size_text(std::uint32_t width_px, std::uint32_t height_px);
/// The board file's word for a FourCC; null if Touchline does not support it.
const char* word_of_fourcc(std::uint32_t fourcc);
/// The letters of a FourCC.
std::string code_of_fourcc(std::uint32_t fourcc);

}  // namespace touchline::hal
