#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/linux/v4l2/v4l2_device.h"

namespace touchline::hal {

/// A size of a format, or a range of them.
struct V4l2FrameSize {
  std::uint32_t width_px = 0, height_px = 0;            // the smallest of a range
  std::uint32_t most_width_px = 0, most_height_px = 0;  // the largest; equal to the former: one size
  std::vector<double> rates_hz;                         // of the largest; fastest first; of a range both ends
  bool rates_are_range = false;
};

struct V4l2FormatInfo {
  std::uint32_t fourcc = 0;
  std::string code;         // "YUYV"
  std::string word;         // the board file's, "": not read by Touchline
  std::string description;  // the driver's
  std::vector<V4l2FrameSize> sizes;
};

/// What the driver says it can deliver. `with_rates`: asks for those too, one request each.
std::vector<V4l2FormatInfo> list_formats(const V4l2Device& device, bool multi_planar, bool with_rates);

/// "yuyv 640x480, 320x240; and besides, GREY, which cannot be read": sizes only of what would help.
std::string formats_text(const std::vector<V4l2FormatInfo>& offers);

std::string size_text(std::uint32_t width_px, std::uint32_t height_px);
/// The board file's word for a fourcc, null for one that Touchline does not read; and the letters of any.
const char* word_of_fourcc(std::uint32_t fourcc);
std::string code_of_fourcc(std::uint32_t fourcc);

}  // namespace touchline::hal
