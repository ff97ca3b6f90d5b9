#include "tests/linux/fake_v4l2.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace touchline::fake {
namespace {

std::uint32_t bytes_per_pixel(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_RGB24:
    case V4L2_PIX_FMT_BGR24:
      return 3;
    case V4L2_PIX_FMT_XBGR32:
      return 4;
    case V4L2_PIX_FMT_NV12:
    case V4L2_PIX_FMT_NV12M:
    case V4L2_PIX_FMT_YUV420:
    case V4L2_PIX_FMT_YUV420M:
    case V4L2_PIX_FMT_YUV422P:
      return 1;
    default:
      return 2;
  }
}

/// Planes of chroma.
struct ChromaPlanes {
  std::uint32_t count = 0, stride_divisor = 1;
  bool has_own_memory = false;
  std::uint32_t row_divisor = 2;
};
ChromaPlanes chroma_planes(std::uint32_t fourcc) {
  switch (fourcc) {
    case V4L2_PIX_FMT_NV12:
      return {1, 1, false};
    case V4L2_PIX_FMT_NV12M:
      return {1, 1, true};
    case V4L2_PIX_FMT_YUV420:
      return {2, 2, false};
    case V4L2_PIX_FMT_YUV420M:
      return {2, 2, true};
    case V4L2_PIX_FMT_YUV422P:
      return {2, 2, false, 1};
    default:
      return {};
  }
}

template <class Text, std::size_t N>
void copy_text(Text (&target)[N], const std::string& source) {
  std::memcpy(target, source.c_str(), std::min(source.size() + 1, N));
}

}  // namespace

VideoDevice::VideoDevice() {
  formats = {{V4L2_PIX_FMT_MJPEG, {{640, 480}, {1280, 720}}, false},
             {V4L2_PIX_FMT_YUYV, {{640, 480}, {320, 240}}, false}};
  controls[V4L2_CID_EXPOSURE_AUTO] = {0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY};
  controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY] = {0, 1, 1, 1};
  controls[V4L2_CID_EXPOSURE_ABSOLUTE] = {3, 2047, 1, 250};
  controls[V4L2_CID_GAIN] = {0, 255, 1, 64};
  controls[V4L2_CID_AUTO_WHITE_BALANCE] = {0, 1, 1, 1};
  controls[V4L2_CID_WHITE_BALANCE_TEMPERATURE] = {2000, 6500, 10, 4000};
  controls[V4L2_CID_POWER_LINE_FREQUENCY] = {0, 2, 1, 2};
}

int VideoDevice::open() {
  if (gone_) return -ENODEV;
  ++open_count_;
  return 0;
}

void VideoDevice::close() {
  if (--open_count_ > 0) return;
  if (mapped() != 0) violations_.push_back("closed with buffers mapped");
  stop();
  buffers_.clear();
}

bool VideoDevice::is_own(std::uint32_t type) const {
  return type ==
         static_cast<std::uint32_t>(multi_planar() ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE);
}

int VideoDevice::requests(unsigned long request) const {
  const auto found = requests_.find(request);
  return found == requests_.end() ? 0 : found->second;
}

Instant VideoDevice::ready(std::uint32_t sequence) const { return started_ + (sequence + 1) * period(); }

Instant VideoDevice::start_of_exposure(std::uint32_t sequence) const {
  const auto exposure = std::chrono::microseconds(100 * controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).value);
  return ready(sequence) - kReadout - exposure;
}

int VideoDevice::ioctl(unsigned long request, void* argument) {
  if (before_request) before_request(request);
  ++requests_[request];
  run();
  if (gone_) return -ENODEV;
  if (const auto found = failures_.find(request); found != failures_.end()) {
    Failure& failure = found->second;
    if (failure.after > 0) {
      --failure.after;
    } else if (failure.times > 0) {
      --failure.times;
      return -failure.error;
    }
  }
  return handle(request, argument);
}

int VideoDevice::handle(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return query(*static_cast<v4l2_capability*>(argument));
    case VIDIOC_ENUM_FMT:
      return enumerate(*static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return enumerate(*static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return enumerate(*static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_QUERYMENU:
      return enumerate(*static_cast<v4l2_querymenu*>(argument));
    case VIDIOC_EXPBUF:
      return export_buffer(*static_cast<v4l2_exportbuffer*>(argument));
    case VIDIOC_S_FMT:
      return set_format(*static_cast<v4l2_format*>(argument));
    case VIDIOC_S_PARM:
      return set_rate(*static_cast<v4l2_streamparm*>(argument));
    case VIDIOC_REQBUFS:
      return request_buffers(*static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF:
      return query_buffer(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_QBUF:
      return queue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_DQBUF:
      return dequeue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      return start();
    case VIDIOC_STREAMOFF:
      return stop();
    case VIDIOC_QUERYCTRL:
      return query(*static_cast<v4l2_queryctrl*>(argument));
    case VIDIOC_S_CTRL:
      return set(*static_cast<v4l2_control*>(argument));
    case VIDIOC_G_CTRL:
      return get(*static_cast<v4l2_control*>(argument));
    case VIDIOC_QUERY_EXT_CTRL:
      return query(*static_cast<v4l2_query_ext_ctrl*>(argument));
    case VIDIOC_G_EXT_CTRLS:
      return get(*static_cast<v4l2_ext_controls*>(argument));
    default:
      return -ENOTTY;
  }
}

int VideoDevice::query(v4l2_capability& capability) const {
  copy_text(capability.driver, driver.c_str());
  copy_text(capability.card, card);
  copy_text(capability.bus_info, bus);
  // First the capabilities of the whole driver, which may have several nodes, then those of this node.
  capability.capabilities = capabilities | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_DEVICE_CAPS;
  capability.device_caps = capabilities;
  return 0;
}

int VideoDevice::enumerate(v4l2_fmtdesc& format) const {
  if (!is_own(format.type) || format.index >= formats.size()) return -EINVAL;
  format.pixelformat = formats[format.index].fourcc;
  copy_text(format.description, "Format " + std::to_string(format.index));
  return 0;
}

int VideoDevice::enumerate(v4l2_frmsizeenum& size) const {
  const auto format = std::find_if(formats.begin(), formats.end(),
                                   [&](const V4l2Format& entry) { return entry.fourcc == size.pixel_format; });
  if (format == formats.end() || size.index >= (format->stepwise ? 1u : format->sizes.size())) return -EINVAL;
  if (format->stepwise) {
    size.type = V4L2_FRMSIZE_TYPE_STEPWISE;
    size.stepwise = {format->sizes[0].first,  format->sizes[1].first,  2,
                     format->sizes[0].second, format->sizes[1].second, 2};
  } else {
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {format->sizes[size.index].first, format->sizes[size.index].second};
  }
  return 0;
}

int VideoDevice::enumerate(v4l2_frmivalenum& interval) const {
  if (interval.index >= rates_hz.size() || interval.width == 0 || interval.height == 0) return -EINVAL;
  interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  interval.discrete = {1, static_cast<std::uint32_t>(rates_hz[interval.index])};
  return 0;
}

int VideoDevice::enumerate(v4l2_querymenu& item) const {
  const auto found = controls.find(item.id);
  if (found == controls.end() || item.index >= found->second.menu.size()) return -EINVAL;
  if (found->second.menu[item.index].empty()) return -EINVAL;
  const std::string& name = found->second.menu[item.index];
  std::memcpy(&item.name, name.c_str(),
              std::min(name.size() + 1, sizeof item.name));  // packed struct: no reference to its member
  return 0;
}

/// Chooses the nearest available format and size.
void VideoDevice::choose(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height) {
  const V4l2Format* chosen = &formats.front();
  for (const V4l2Format& entry : formats) {
    if (entry.fourcc == fourcc) chosen = &entry;
  }
  if (chosen->stepwise) {
    width = std::clamp(width, chosen->sizes[0].first, chosen->sizes[1].first);
    height = std::clamp(height, chosen->sizes[0].second, chosen->sizes[1].second);
  } else {
    const auto distance = [&](const auto& size) {
      return std::abs(static_cast<int>(size.first) - static_cast<int>(width)) +
             std::abs(static_cast<int>(size.second) - static_cast<int>(height));
    };
    const auto size = *std::min_element(chosen->sizes.begin(), chosen->sizes.end(),
                                        [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    width = size.first;
    height = size.second;
  }
  picture_ = {};
  picture_.fourcc = chosen->fourcc;
  picture_.width = width;
  picture_.height = height;
  const std::uint32_t stride = width * bytes_per_pixel(chosen->fourcc) + padding_bytes;
  picture_.stride_bytes[0] = stride;
  picture_.bytes[0] = stride * height;
  const ChromaPlanes chroma = chroma_planes(chosen->fourcc);
  for (std::uint32_t i = 1; i <= chroma.count; ++i) {
    const std::uint32_t chroma_stride = stride / chroma.stride_divisor;
    picture_.bytes[chroma.has_own_memory ? i : 0] +=
        chroma_stride * ((height + chroma.row_divisor - 1) / chroma.row_divisor);
    if (!chroma.has_own_memory) continue;
    ++picture_.planes;
    picture_.stride_bytes[i] = chroma_stride;
  }
  picture_.bytes[0] -= missing_bytes;
}

int VideoDevice::set_format(v4l2_format& format) {
  if (!is_own(format.type)) return -EINVAL;
  if (!buffers_.empty()) return -EBUSY;
  if (!multi_planar()) {
    v4l2_pix_format& pix = format.fmt.pix;
    choose(pix.pixelformat, pix.width, pix.height);
    pix.pixelformat = picture_.fourcc;
    pix.width = picture_.width;
    pix.height = picture_.height;
    pix.field = field;
    pix.quantization = quantization;
    pix.bytesperline = picture_.fourcc == V4L2_PIX_FMT_MJPEG ? 0 : picture_.stride_bytes[0];
    pix.sizeimage = picture_.bytes[0];
    return 0;
  }
  v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
  choose(pix.pixelformat, pix.width, pix.height);
  pix.pixelformat = picture_.fourcc;
  pix.width = picture_.width;
  pix.height = picture_.height;
  pix.field = field;
  pix.quantization = static_cast<std::uint8_t>(quantization);
  pix.num_planes = static_cast<std::uint8_t>(picture_.planes);
  for (std::size_t i = 0; i < picture_.planes; ++i) {
    pix.plane_fmt[i].bytesperline = picture_.stride_bytes[i];
    pix.plane_fmt[i].sizeimage = picture_.bytes[i];
  }
  return 0;
}

int VideoDevice::set_rate(v4l2_streamparm& parameter) {
  if (!is_own(parameter.type)) return -EINVAL;
  v4l2_fract& time = parameter.parm.capture.timeperframe;
  const double requested = time.numerator == 0 ? 30.0 : static_cast<double>(time.denominator) / time.numerator;
  rate_hz_ = *std::min_element(rates_hz.begin(), rates_hz.end(),
                               [&](int a, int b) { return std::abs(a - requested) < std::abs(b - requested); });
  if (!reports_rate) return -ENOTTY;
  parameter.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  time = {1, static_cast<std::uint32_t>(rate_hz_)};
  return 0;
}

int VideoDevice::query(v4l2_queryctrl& control) const {
  const bool next = (control.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t id = control.id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  const auto found = next ? controls.upper_bound(id) : controls.find(id);
  if (found == controls.end()) return -EINVAL;
  const V4l2Control& own = found->second;
  control = {};
  control.id = found->first;
  control.type = own.type;
  control.flags = own.flags;
  copy_text(control.name, own.name);
  if (own.type == V4L2_CTRL_TYPE_INTEGER64) return 0;  // its values do not fit
  control.minimum = own.low;
  control.maximum = own.high;
  control.step = own.step;
  control.default_value = own.default_value;
  return 0;
}

int VideoDevice::query(v4l2_query_ext_ctrl& control) const {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  const V4l2Control& own = found->second;
  control.type = own.type;
  control.minimum = own.low * own.unit;
  control.maximum = own.high * own.unit;
  control.step = static_cast<std::uint64_t>(own.step * own.unit);
  control.default_value = control.minimum;
  return 0;
}

int VideoDevice::set(v4l2_control& control) {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  V4l2Control& own = found->second;
  ++own.writes;
  if (own.set_error != 0) return -own.set_error;
  if (control.value < own.low || control.value > own.high) return -ERANGE;
  if (control.value == own.refused_value) return -EINVAL;
  if ((control.value - own.low) % own.step != 0) return -EINVAL;
  if (!own.ignores_writes) own.value = control.value;
  return 0;
}

int VideoDevice::get(v4l2_control& control) {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  ++found->second.reads;
  if (found->second.type == V4L2_CTRL_TYPE_INTEGER64) return -EINVAL;
  control.value = found->second.value;
  return 0;
}

int VideoDevice::get(v4l2_ext_controls& request) {
  for (std::uint32_t i = 0; i < request.count; ++i) {
    const auto found = controls.find(request.controls[i].id);
    if (found == controls.end()) return -EINVAL;
    request.controls[i].value64 = found->second.value * found->second.unit;
  }
  return 0;
}

}  // namespace touchline::fake
