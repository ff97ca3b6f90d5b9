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

/// Fields of a format that V4L2's single-planar and multi-planar interfaces have in common.
struct NegotiatedFormat {
  std::uint32_t fourcc = 0, width = 0, height = 0;
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t quantization = V4L2_QUANTIZATION_DEFAULT, colorspace = V4L2_COLORSPACE_DEFAULT;
  std::uint8_t planes = 1;
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
};

/// Returns the number of memory planes: all color planes share one, or each has its own.
std::uint8_t memory_planes_of(CameraFormat format, std::uint32_t fourcc) {
  const PixelFormatInfo& info = info_of(pixel_format(format));
  return format != CameraFormat::kMjpg && fourcc == info.v4l2_planar ? info.planes : 1;
}

int set_format(const V4l2Device& device, bool multi_planar, std::uint32_t fourcc, const CameraSettings& requested,
               NegotiatedFormat& actual) {
  v4l2_format format{};
  format.type = capture_type(multi_planar);
  if (!multi_planar) {
    v4l2_pix_format& pix = format.fmt.pix;
    pix.width = requested.width_px;
    pix.height = requested.height_px;
    pix.pixelformat = fourcc;
    pix.field = V4L2_FIELD_NONE;
    const int error = device.request(VIDIOC_S_FMT, &format);
    actual = {pix.pixelformat,  pix.width,      pix.height, pix.field,
              pix.quantization, pix.colorspace, 1,          {pix.bytesperline}};
    return error;
  }
  v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
  pix.width = requested.width_px;
  pix.height = requested.height_px;
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.num_planes = memory_planes_of(requested.format, fourcc);
  const int error = device.request(VIDIOC_S_FMT, &format);
  actual = {pix.pixelformat, pix.width, pix.height, pix.field, pix.quantization, pix.colorspace, pix.num_planes, {}};
  for (std::size_t i = 0; i < kMaxPlanes; ++i) actual.stride_bytes[i] = pix.plane_fmt[i].bytesperline;
  return error;
}

/// Returns the FourCCs of a format in the order in which they are tried.
std::array<std::uint32_t, 2> codes_of(CameraFormat format, bool multi_planar) {
  if (format == CameraFormat::kMjpg) return {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG};
  const PixelFormatInfo& info = info_of(pixel_format(format));
  return {info.v4l2, multi_planar ? info.v4l2_planar : 0};
}

std::string name_of(std::uint32_t fourcc) {
  const char* const word = word_of_fourcc(fourcc);
  return word != nullptr ? word : code_of_fourcc(fourcc);
}

V4l2Picture picture_of(const NegotiatedFormat& actual, CameraFormat format, bool multi_planar) {
  V4l2Picture picture;
  picture.format = format;
  picture.width_px = static_cast<std::uint16_t>(actual.width);
  picture.height_px = static_cast<std::uint16_t>(actual.height);
  picture.multi_planar = multi_planar;
  picture.planes = actual.planes;
  picture.interlaced = actual.field != V4L2_FIELD_NONE && actual.field != V4L2_FIELD_ANY;
  // JPEG has full range, whatever the driver reports.
  picture.full_range = format == CameraFormat::kMjpg || actual.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
                       (actual.quantization == V4L2_QUANTIZATION_DEFAULT && actual.colorspace == V4L2_COLORSPACE_JPEG);
  if (format == CameraFormat::kMjpg) {
    picture.needed_bytes[0] = 1;
    return picture;
  }
  const PixelFormat pixels = pixel_format(format);
  const auto bytes_of = [&](std::size_t plane) {
    const std::size_t bytes = plane_bytes(pixels, plane, actual.width, actual.height, picture.stride_bytes[plane]);
    return static_cast<std::uint32_t>(bytes);
  };
  for (std::size_t plane = 0; plane < info_of(pixels).planes; ++plane) {
    const auto row = static_cast<std::uint32_t>(row_bytes(pixels, plane, actual.width));
    const bool has_own_stride = plane < actual.planes;
    picture.stride_bytes[plane] = has_own_stride ? std::max(actual.stride_bytes[plane], row)
                                                 : plane_stride(pixels, plane, picture.stride_bytes[0]);
    if (has_own_stride) picture.needed_bytes[plane] = bytes_of(plane);
  }
  if (actual.planes == 1) {
    const std::size_t last = info_of(pixels).planes - std::size_t{1};
    const PictureLayout layout = picture_layout(pixels, actual.height, picture.stride_bytes);
    picture.needed_bytes[0] = static_cast<std::uint32_t>(layout.offset_bytes[last]) + bytes_of(last);
  }
  return picture;
}

}  // namespace

Result<V4l2Picture> negotiate_format(const V4l2Device& device, bool multi_planar, const CameraSettings& requested) {
  const std::array<std::uint32_t, 2> codes = codes_of(requested.format, multi_planar);
  const std::string wanted = name_of(codes[0]) + " " + size_text(requested.width_px, requested.height_px);
  NegotiatedFormat actual;
  int error = EINVAL;
  for (const std::uint32_t code : codes) {
    if (code == 0) break;
    error = set_format(device, multi_planar, code, requested, actual);
    if ((error == 0 && actual.fourcc == code) || (error != 0 && error != EINVAL)) break;
  }
  if (error == EBUSY) return device_busy(requested.device.c_str());
  if (error != 0 && error != EINVAL) {
    return failure(use_error(error), "%s: cannot set a format: %s", requested.device.c_str(), system_text(error));
  }
  const bool same_format = actual.fourcc == codes[0] || actual.fourcc == codes[1];
  if (error != 0 || !same_format || actual.width != requested.width_px || actual.height != requested.height_px) {
    const std::string instead =
        error != 0 ? std::string("invalid argument")
                   : "the driver set " + name_of(actual.fourcc) + " " + size_text(actual.width, actual.height);
    return failure(ErrorCode::kUnsupported, "%s: %s is not available (%s); the camera offers %s",
                   requested.device.c_str(), wanted.c_str(), instead.c_str(),
                   formats_text(list_formats(device, multi_planar, false)).c_str());
  }
  if (actual.field == V4L2_FIELD_TOP || actual.field == V4L2_FIELD_BOTTOM || actual.field == V4L2_FIELD_ALTERNATE) {
    return failure(ErrorCode::kUnsupported, "%s: delivers single fields instead of frames at %s; try half the height",
                   requested.device.c_str(), wanted.c_str());
  }
  if (actual.planes != memory_planes_of(requested.format, actual.fourcc)) {
    return failure(ErrorCode::kUnsupported, "%s: delivers %s in %u memory planes, which is not supported",
                   requested.device.c_str(), wanted.c_str(), unsigned{actual.planes});
  }
  return picture_of(actual, requested.format, multi_planar);
}

double negotiate_rate(const V4l2Device& device, bool multi_planar, double requested_hz) {
  v4l2_streamparm parameter{};
  parameter.type = capture_type(multi_planar);
  v4l2_fract& period = parameter.parm.capture.timeperframe;
  period.numerator = 1000;  // in millihertz, for rates such as 29.97 Hz
  period.denominator = static_cast<std::uint32_t>(std::lround(requested_hz * 1000.0));
  // A driver without frame rates refuses the request or leaves zeros.
  if (device.request(VIDIOC_S_PARM, &parameter) != 0) return 0.0;
  if ((parameter.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return 0.0;
  if (period.numerator == 0 || period.denominator == 0) return 0.0;
  return static_cast<double>(period.denominator) / static_cast<double>(period.numerator);
}

}  // namespace touchline::hal
