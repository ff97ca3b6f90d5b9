#include "hal/linux/v4l2/v4l2_format_list.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <utility>

#include "hal/device_parameters.h"

namespace touchline::hal {
namespace {

// Limit for drivers whose lists never end; no camera has so many formats, sizes or rates.
constexpr std::uint32_t kMaxListed = 64;

double rate_of(const v4l2_fract& period) {
  return period.numerator == 0 ? 0.0 : static_cast<double>(period.denominator) / period.numerator;
}

void list_rates(const V4l2Device& device, std::uint32_t fourcc, V4l2FrameSize& size) {
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = size.max_width_px;
  interval.height = size.max_height_px;
  for (; interval.index < kMaxListed && device.request(VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0; ++interval.index) {
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      size.rates_hz = {rate_of(interval.stepwise.min), rate_of(interval.stepwise.max)};
      size.rates_are_range = true;
      break;  // the specification allows only one entry
    }
    size.rates_hz.push_back(rate_of(interval.discrete));
  }
  std::sort(size.rates_hz.rbegin(), size.rates_hz.rend());
}

void list_sizes(const V4l2Device& device, bool with_rates, V4l2FormatInfo& format) {
  v4l2_frmsizeenum size{};
  size.pixel_format = format.fourcc;
  for (bool range = false; !range && size.index < kMaxListed && device.request(VIDIOC_ENUM_FRAMESIZES, &size) == 0;
       ++size.index) {
    range = size.type != V4L2_FRMSIZE_TYPE_DISCRETE;  // the specification allows only one entry
    V4l2FrameSize offer{
        size.discrete.width, size.discrete.height, size.discrete.width, size.discrete.height, {}, false};
    if (range) {
      offer = {size.stepwise.min_width,
               size.stepwise.min_height,
               size.stepwise.max_width,
               size.stepwise.max_height,
               {},
               false};
    }
    if (with_rates) list_rates(device, format.fourcc, offer);
    format.sizes.push_back(std::move(offer));
  }
}

}  // namespace

std::string size_text(std::uint32_t width_px, std::uint32_t height_px) {
  return std::to_string(width_px) + "x" + std::to_string(height_px);
}

const char* word_of_fourcc(std::uint32_t fourcc) {
  if (fourcc == V4L2_PIX_FMT_MJPEG || fourcc == V4L2_PIX_FMT_JPEG) return kCameraFormats.back().word.data();
  for (const PixelFormatInfo& info : kPixelFormatTable) {
    if (fourcc != 0 && (fourcc == info.v4l2 || fourcc == info.v4l2_planar)) return info.word.data();
  }
  return nullptr;
}

std::string code_of_fourcc(std::uint32_t fourcc) {
  std::string letters;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const char letter = static_cast<char>((fourcc >> shift) & 0x7fu);
    if (letter > ' ') letters += letter;
  }
  return letters;
}

std::vector<V4l2FormatInfo> list_formats(const V4l2Device& device, bool multi_planar, bool with_rates) {
  std::vector<V4l2FormatInfo> offers;
  v4l2_fmtdesc format{};
  format.type = capture_type(multi_planar);
  for (; format.index < kMaxListed && device.request(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    const char* const word = word_of_fourcc(format.pixelformat);
    V4l2FormatInfo offer{format.pixelformat,
                         code_of_fourcc(format.pixelformat),
                         word != nullptr ? word : "",
                         reinterpret_cast<const char*>(format.description),
                         {}};
    list_sizes(device, with_rates, offer);
    offers.push_back(std::move(offer));
  }
  return offers;
}

std::string formats_text(const std::vector<V4l2FormatInfo>& offers) {
  std::string supported, unsupported;
  for (const V4l2FormatInfo& offer : offers) {
    if (offer.word.empty()) {
      unsupported += (unsupported.empty() ? "" : ", ") + offer.code;
      continue;
    }
    supported += (supported.empty() ? "" : "; ") + offer.word;
    for (const V4l2FrameSize& size : offer.sizes) {
      supported += (&size == offer.sizes.data() ? " " : ", ") + size_text(size.width_px, size.height_px);
      if (size.max_width_px != size.width_px || size.max_height_px != size.height_px) {
        supported += " to " + size_text(size.max_width_px, size.max_height_px);
      }
    }
  }
  if (supported.empty()) supported = "no format that Touchline supports";
  return unsupported.empty() ? supported : supported + "; unsupported: " + unsupported;
}

}  // namespace touchline::hal
