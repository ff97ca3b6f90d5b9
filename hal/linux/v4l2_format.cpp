#include "hal/linux/v4l2_format.h"

#include <linux/videodev2.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <string>

#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

struct FourccFormat {
  std::uint32_t fourcc;
  PixelFormat format;
  std::uint32_t bytes_per_pixel;  // of the first plane
};
constexpr std::array<FourccFormat, 5> kFormats{{{V4L2_PIX_FMT_RGB24, PixelFormat::kRgb24, 3},
                                                {V4L2_PIX_FMT_BGR24, PixelFormat::kBgr24, 3},
                                                {V4L2_PIX_FMT_YUYV, PixelFormat::kYuyv, 2},
                                                {V4L2_PIX_FMT_UYVY, PixelFormat::kUyvy, 2},
                                                {V4L2_PIX_FMT_NV12, PixelFormat::kNv12, 1}}};

const FourccFormat& entry_of(PixelFormat format) {
  for (const FourccFormat& entry : kFormats) {
    if (entry.format == format) return entry;
  }
  return kFormats.front();  // not reached: every PixelFormat has an entry
}

// A driver that never says "no more" must not hold us: no camera lists so many formats or sizes.
constexpr std::uint32_t kMaxListed = 64;

/// The board file's word, null for a format that Touchline does not read.
const char* word_of(std::uint32_t fourcc) {
  for (const FourccFormat& entry : kFormats) {
    if (entry.fourcc != fourcc) continue;
    for (const Choice<PixelFormat>& choice : kPixelFormats) {
      if (choice.value == entry.format) return choice.word.data();
    }
  }
  return nullptr;
}

std::string name_of(std::uint32_t fourcc) {
  if (const char* word = word_of(fourcc); word != nullptr) return word;
  std::string letters;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const char letter = static_cast<char>((fourcc >> shift) & 0x7fu);
    if (letter > ' ') letters += letter;
  }
  return letters;
}

std::string size_text(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string sizes_of(const V4l2Device& device, std::uint32_t fourcc) {
  std::string list;
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  for (size.index = 0; size.index < kMaxListed && device.request(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    list += list.empty() ? " " : ", ";
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      list += size_text(size.discrete.width, size.discrete.height);
    } else {
      list += size_text(size.stepwise.min_width, size.stepwise.min_height) + " to " +
              size_text(size.stepwise.max_width, size.stepwise.max_height);
      break;  // by the standard there is one entry only
    }
  }
  return list;
}

/// "yuyv 640x480, 320x240; nv12 640x480; and MJPG, which cannot be read": sizes only of what would help.
std::string offers_of(const V4l2Device& device) {
  std::string readable, others;
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (format.index = 0; format.index < kMaxListed && device.request(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    if (word_of(format.pixelformat) != nullptr) {
      readable += (readable.empty() ? "" : "; ") + name_of(format.pixelformat) + sizes_of(device, format.pixelformat);
    } else {
      others += (others.empty() ? "" : ", ") + name_of(format.pixelformat);
    }
  }
  if (readable.empty()) readable = "nothing that can be read";
  return others.empty() ? readable : readable + "; besides, " + others + ", which cannot be read";
}

V4l2Picture picture_of(const v4l2_pix_format& granted, const FourccFormat& entry) {
  V4l2Picture picture;
  picture.format = entry.format;
  picture.width_px = static_cast<std::uint16_t>(granted.width);
  picture.height_px = static_cast<std::uint16_t>(granted.height);
  // Packed 4:2:2 holds whole pairs of pixels.
  const bool pairs = entry.format == PixelFormat::kYuyv || entry.format == PixelFormat::kUyvy;
  const std::uint32_t row_bytes = (pairs ? (granted.width + 1) / 2 * 2 : granted.width) * entry.bytes_per_pixel;
  picture.stride_bytes = granted.bytesperline >= row_bytes ? granted.bytesperline : row_bytes;
  // The last row need not be padded. NV12: the chroma rows follow with the same stride.
  const std::uint32_t rows = granted.height + (entry.format == PixelFormat::kNv12 ? (granted.height + 1) / 2 : 0);
  const std::uint32_t last_row = entry.format == PixelFormat::kNv12 ? (granted.width + 1) / 2 * 2 : row_bytes;
  picture.needed_bytes = picture.stride_bytes * (rows - 1) + last_row;
  picture.interlaced = granted.field != V4L2_FIELD_NONE && granted.field != V4L2_FIELD_ANY;
  return picture;
}

}  // namespace

Result<V4l2Picture> negotiate_format(const V4l2Device& device, const CameraSettings& asked, Reason& reason) {
  const FourccFormat& entry = entry_of(asked.format);
  const std::string wanted = name_of(entry.fourcc) + " " + size_text(asked.width_px, asked.height_px);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = asked.width_px;
  format.fmt.pix.height = asked.height_px;
  format.fmt.pix.pixelformat = entry.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const int error = device.request(VIDIOC_S_FMT, &format);
  if (error == EBUSY) return say_busy(reason, asked.device.c_str());
  if (error != 0 && error != EINVAL) {
    reason.set("%s: cannot set a format: %s", asked.device.c_str(), system_text(error));
    return use_error(error);
  }
  const v4l2_pix_format& granted = format.fmt.pix;
  const bool same = error == 0 && granted.pixelformat == entry.fourcc && granted.width == asked.width_px &&
                    granted.height == asked.height_px;
  if (!same) {
    const std::string instead =
        error != 0 ? std::string("(invalid argument)")
                   : "but " + name_of(granted.pixelformat) + " " + size_text(granted.width, granted.height);
    reason.set("%s: no %s %s; it offers %s", asked.device.c_str(), wanted.c_str(), instead.c_str(),
               offers_of(device).c_str());
    return ErrorCode::kUnsupported;
  }
  if (granted.field == V4L2_FIELD_TOP || granted.field == V4L2_FIELD_BOTTOM || granted.field == V4L2_FIELD_ALTERNATE) {
    reason.set("%s: delivers single fields, not whole frames, at %s; half the height may be progressive",
               asked.device.c_str(), wanted.c_str());
    return ErrorCode::kUnsupported;
  }
  return picture_of(granted, entry);
}

double negotiate_rate(const V4l2Device& device, double asked_hz) {
  v4l2_streamparm parameter{};
  parameter.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_fract& period = parameter.parm.capture.timeperframe;
  period.numerator = 1000;  // mHz: 29.97 Hz is a rate too
  period.denominator = static_cast<std::uint32_t>(std::lround(asked_hz * 1000.0));
  // A driver without the call, or without a rate of its own, leaves zeros or refuses.
  if (device.request(VIDIOC_S_PARM, &parameter) != 0) return 0.0;
  if ((parameter.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return 0.0;
  if (period.numerator == 0 || period.denominator == 0) return 0.0;
  return static_cast<double>(period.denominator) / static_cast<double>(period.numerator);
}

}  // namespace touchline::hal
