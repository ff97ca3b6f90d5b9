#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// A frame size, or a range of sizes.
struct V4l2FrameSize {
  std::uint32_t width_px = 0, height_px = 0;          // the smallest size of a range
  std::uint32_t max_width_px = 0, max_height_px = 0;  // the largest size; equal to the smallest for a single size
  std::vector<double> rates_hz;  // for the largest size, fastest first; for a range of rates its two ends
  bool rates_are_range = false;
};

struct V4l2FormatInfo {
  std::uint32_t fourcc = 0;
  std::string code;         // "YUYV"
  std::string word;         // name in the board file; "": Touchline does not support it
  std::string description;  // the driver's description
  std::vector<V4l2FrameSize> sizes;
};

/// Lists the formats and sizes that the driver offers. `with_rates`: also lists the frame rates, with one request for
/// each size.
std::vector<V4l2FormatInfo> list_formats(const V4l2Device& device, bool multi_planar, bool with_rates);

/// Returns text such as "yuyv 640x480, 320x240; unsupported: GREY". Lists sizes only for formats that Touchline
/// supports.
std::string formats_text(const std::vector<V4l2FormatInfo>& offers);

std::string size_text(std::uint32_t width_px, std::uint32_t height_px);
/// Returns the board file's word for a FourCC; null if Touchline does not support it.
const char* word_of_fourcc(std::uint32_t fourcc);
/// Returns the letters of a FourCC.
std::string code_of_fourcc(std::uint32_t fourcc);

}  // namespace touchline::hal
