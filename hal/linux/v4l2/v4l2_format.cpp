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

/// What both of V4L2's interfaces say about a format.
struct Granted {
  std::uint32_t fourcc = 0, width = 0, height = 0;
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t quantization = V4L2_QUANTIZATION_DEFAULT, colorspace = V4L2_COLORSPACE_DEFAULT;
  std::uint8_t planes = 1;
  std::array<std::uint32_t, 2> stride_bytes{};
};

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
               pix.quantization, pix.colorspace, 1,          {pix.bytesperline, 0}};
    return error;
  }
  v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
  pix.width = asked.width_px;
  pix.height = asked.height_px;
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.num_planes = fourcc == V4L2_PIX_FMT_NV12M ? 2 : 1;
  const int error = device.request(VIDIOC_S_FMT, &format);
  granted = {
      pix.pixelformat,  pix.width,      pix.height,     pix.field,
      pix.quantization, pix.colorspace, pix.num_planes, {pix.plane_fmt[0].bytesperline, pix.plane_fmt[1].bytesperline}};
  return error;
}

/// Codes of a format in the order in which they are tried.
std::array<std::uint32_t, 2> codes_of(CameraFormat format, bool multi_planar) {
  switch (format) {
    case CameraFormat::kRgb24:
      return {V4L2_PIX_FMT_RGB24, 0};
    case CameraFormat::kBgr24:
      return {V4L2_PIX_FMT_BGR24, 0};
    case CameraFormat::kYuyv:
      return {V4L2_PIX_FMT_YUYV, 0};
    case CameraFormat::kUyvy:
      return {V4L2_PIX_FMT_UYVY, 0};
    case CameraFormat::kNv12:
      return {V4L2_PIX_FMT_NV12, multi_planar ? V4L2_PIX_FMT_NV12M : 0};
    case CameraFormat::kMjpg:
      break;
  }
  return {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG};
}

std::string name_of(std::uint32_t fourcc) {
  const char* const word = word_of_fourcc(fourcc);
  return word != nullptr ? word : code_of_fourcc(fourcc);
}

/// Bytes of a row of pixels; 0: the rows are not where one could tell.
std::uint32_t row_bytes(CameraFormat format, std::uint32_t width) {
  switch (format) {
    case CameraFormat::kRgb24:
    case CameraFormat::kBgr24:
      return 3 * width;
    case CameraFormat::kYuyv:
    case CameraFormat::kUyvy:
      return (width + 1) / 2 * 4;  // whole pairs of pixels
    case CameraFormat::kNv12:
      return width;
    case CameraFormat::kMjpg:
      break;
  }
  return 0;
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
      color_space(pixel_format(format)) == ColorSpace::kYuv &&
      (granted.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
       (granted.quantization == V4L2_QUANTIZATION_DEFAULT && granted.colorspace == V4L2_COLORSPACE_JPEG));
  if (format == CameraFormat::kMjpg) {
    picture.needed_bytes[0] = 1;
    return picture;
  }
  const std::uint32_t luma_row = row_bytes(format, granted.width);
  picture.stride_bytes[0] = std::max(granted.stride_bytes[0], luma_row);
  // The last row need not be padded.
  picture.needed_bytes[0] = picture.stride_bytes[0] * (granted.height - 1) + luma_row;
  if (format != CameraFormat::kNv12) return picture;
  const std::uint32_t chroma_row = (granted.width + 1) / 2 * 2, chroma_rows = (granted.height + 1) / 2;
  if (granted.planes == 2) {
    picture.stride_bytes[1] = std::max(granted.stride_bytes[1], chroma_row);
    picture.needed_bytes[1] = picture.stride_bytes[1] * (chroma_rows - 1) + chroma_row;
  } else {  // the chroma rows follow with the same stride
    picture.stride_bytes[1] = picture.stride_bytes[0];
    picture.needed_bytes[0] = picture.stride_bytes[0] * (granted.height + chroma_rows - 1) + chroma_row;
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
  if (granted.planes != (granted.fourcc == V4L2_PIX_FMT_NV12M ? 2 : 1)) {
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
