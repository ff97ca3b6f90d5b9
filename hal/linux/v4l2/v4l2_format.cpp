#include "hal/linux/v4l2/v4l2_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <string>

#include "hal/linux/system_error.h"
#include "hal/linux/v4l2/v4l2_format_list.h"

namespace touchline::hal {
namespace {

/// The fields of a format that V4L2's single-planar and multi-planar interfaces share.
struct Granted {
  std::uint32_t fourcc = 0, width = 0, height = 0;
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t quantization = V4L2_QUANTIZATION_DEFAULT, colorspace = V4L2_COLORSPACE_DEFAULT;
  std::uint8_t planes = 1;
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
};

/// The planes lie in one piece of memory, or each in its own.
std::uint8_t pieces_of_memory(CameraFormat format, std::uint32_t fourcc) {
  const PixelFormatInfo& info = info_of(pixel_format(format));
  return format != CameraFormat::kMjpg && fourcc == info.v4l2_planar ? info.planes : 1;
}

int set_format(const V4l2Device& device, bool multi_planar, std::uint32_t fourcc, const CameraSettings& asked,
               Granted& granted) {
  v4l2_format format{};
  format.type = capture_type(multi_planar);
  if (!multi_planar) {
    v4l2_pix_format& pix = format.fmt.pix;
    pix.width = asked.width_px;
    pix.height = asked.height_px;
    pix.pixelformat = fourcc;
    pix.field = V4L2_FIELD_NONE;
    const int error = device.request(VIDIOC_S_FMT, &format);
    granted = {pix.pixelformat,  pix.width,      pix.height, pix.field,
               pix.quantization, pix.colorspace, 1,          {pix.bytesperline}};
    return error;
  }
  v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
  pix.width = asked.width_px;
  pix.height = asked.height_px;
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.num_planes = pieces_of_memory(asked.format, fourcc);
  const int error = device.request(VIDIOC_S_FMT, &format);
  granted = {pix.pixelformat, pix.width, pix.height, pix.field, pix.quantization, pix.colorspace, pix.num_planes, {}};
  for (std::size_t i = 0; i < kMaxPlanes; ++i) granted.stride_bytes[i] = pix.plane_fmt[i].bytesperline;
  return error;
}

/// The FourCCs of a format in the order in which they are tried.
std::array<std::uint32_t, 2> codes_of(CameraFormat format, bool multi_planar) {
  if (format == CameraFormat::kMjpg) return {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG};
  const PixelFormatInfo& info = info_of(pixel_format(format));
  return {info.v4l2, multi_planar ? info.v4l2_planar : 0};
}

std::string name_of(std::uint32_t fourcc) {
  const char* const word = word_of_fourcc(fourcc);
  return word != nullptr ? word : code_of_fourcc(fourcc);
}

V4l2Picture picture_of(const Granted& granted, CameraFormat format, bool multi_planar) {
  V4l2Picture picture;
  picture.format = format;
  picture.width_px = static_cast<std::uint16_t>(granted.width);
  picture.height_px = static_cast<std::uint16_t>(granted.height);
  picture.multi_planar = multi_planar;
  picture.planes = granted.planes;
  picture.interlaced = granted.field != V4L2_FIELD_NONE && granted.field != V4L2_FIELD_ANY;
  picture.full_range =
      info_of(pixel_format(format)).range == ColorRange::kLimited &&
      (granted.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
       (granted.quantization == V4L2_QUANTIZATION_DEFAULT && granted.colorspace == V4L2_COLORSPACE_JPEG));
  if (format == CameraFormat::kMjpg) {
    picture.needed_bytes[0] = 1;
    return picture;
  }
  const PixelFormat pixels = pixel_format(format);
  const auto bytes_of = [&](std::size_t plane) {
    const std::size_t bytes = plane_bytes(pixels, plane, granted.width, granted.height, picture.stride_bytes[plane]);
    return static_cast<std::uint32_t>(bytes);
  };
  for (std::size_t plane = 0; plane < info_of(pixels).planes; ++plane) {
    const auto row = static_cast<std::uint32_t>(row_bytes(pixels, plane, granted.width));
    const bool has_own_stride = plane < granted.planes;
    picture.stride_bytes[plane] = has_own_stride ? std::max(granted.stride_bytes[plane], row)
                                                 : plane_stride(pixels, plane, picture.stride_bytes[0]);
    if (has_own_stride) picture.needed_bytes[plane] = bytes_of(plane);
  }
  if (granted.planes == 1) {
    const std::size_t last = info_of(pixels).planes - std::size_t{1};
    const PictureLayout layout = picture_layout(pixels, granted.height, picture.stride_bytes);
    picture.needed_bytes[0] = static_cast<std::uint32_t>(layout.offset_bytes[last]) + bytes_of(last);
  }
  return picture;
}

}  // namespace

Result<V4l2Picture> negotiate_format(const V4l2Device& device, bool multi_planar, const CameraSettings& asked) {
  const std::array<std::uint32_t, 2> codes = codes_of(asked.format, multi_planar);
  const std::string wanted = name_of(codes[0]) + " " + size_text(asked.width_px, asked.height_px);
  Granted granted;
  int error = EINVAL;
  for (const std::uint32_t code : codes) {
    if (code == 0) break;
    error = set_format(device, multi_planar, code, asked, granted);
    if ((error == 0 && granted.fourcc == code) || (error != 0 && error != EINVAL)) break;
  }
  if (error == EBUSY) return device_busy(asked.device.c_str());
  if (error != 0 && error != EINVAL) {
    return failure(use_error(error), "%s: cannot set a format: %s", asked.device.c_str(), system_text(error));
  }
  const bool same_format = granted.fourcc == codes[0] || granted.fourcc == codes[1];
  if (error != 0 || !same_format || granted.width != asked.width_px || granted.height != asked.height_px) {
    const std::string instead = error != 0
                                    ? std::string("(invalid argument)")
                                    : "but " + name_of(granted.fourcc) + " " + size_text(granted.width, granted.height);
    return failure(ErrorCode::kUnsupported, "%s: no %s %s; it offers %s", asked.device.c_str(), wanted.c_str(),
                   instead.c_str(), formats_text(list_formats(device, multi_planar, false)).c_str());
  }
  if (granted.field == V4L2_FIELD_TOP || granted.field == V4L2_FIELD_BOTTOM || granted.field == V4L2_FIELD_ALTERNATE) {
    return failure(ErrorCode::kUnsupported,
                   "%s: delivers single fields, not whole frames, at %s; half the height may be progressive",
                   asked.device.c_str(), wanted.c_str());
  }
  if (granted.planes != pieces_of_memory(asked.format, granted.fourcc)) {
    return failure(ErrorCode::kUnsupported, "%s: delivers %s in %u pieces of memory", asked.device.c_str(),
                   wanted.c_str(), unsigned{granted.planes});
  }
  return picture_of(granted, asked.format, multi_planar);
}

double negotiate_rate(const V4l2Device& device, bool multi_planar, double asked_hz) {
  v4l2_streamparm parameter{};
  parameter.type = capture_type(multi_planar);
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
