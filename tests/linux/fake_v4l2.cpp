#include "tests/linux/fake_v4l2.h"

#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace touchline::fake {
namespace {

// Distance of the buffers' offsets for mmap(): above their size, and 64 of them fit into 32 bits.
constexpr std::uint32_t kOffsetStep = 1u << 25;

std::uint32_t bytes_per_pixel(std::uint32_t fourcc) {
  return fourcc == V4L2_PIX_FMT_RGB24 || fourcc == V4L2_PIX_FMT_BGR24 ? 3 : fourcc == V4L2_PIX_FMT_NV12 ? 1 : 2;
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
  if (mapped() != 0) breaches_.push_back("closed with buffers mapped");
  stop();
  buffers_.clear();
}

std::size_t VideoDevice::mapped() const {
  return static_cast<std::size_t>(
      std::count_if(buffers_.begin(), buffers_.end(), [](const auto& buffer) { return buffer->mapped; }));
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
    default:
      return -ENOTTY;
  }
}

int VideoDevice::query(v4l2_capability& capability) const {
  copy_text(capability.card, card);
  copy_text(capability.bus_info, bus);
  // The whole driver's, which may have more nodes than this one; then this node's.
  capability.capabilities = capabilities | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_DEVICE_CAPS;
  capability.device_caps = capabilities;
  return 0;
}

int VideoDevice::enumerate(v4l2_fmtdesc& format) const {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || format.index >= formats.size()) return -EINVAL;
  format.pixelformat = formats[format.index].fourcc;
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

int VideoDevice::set_format(v4l2_format& format) {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return -EINVAL;
  if (!buffers_.empty()) return -EBUSY;
  v4l2_pix_format& pix = format.fmt.pix;
  const V4l2Format* chosen = &formats.front();
  for (const V4l2Format& entry : formats) {
    if (entry.fourcc == pix.pixelformat) chosen = &entry;
  }
  pix.pixelformat = chosen->fourcc;
  if (chosen->stepwise) {
    pix.width = std::clamp(pix.width, chosen->sizes[0].first, chosen->sizes[1].first);
    pix.height = std::clamp(pix.height, chosen->sizes[0].second, chosen->sizes[1].second);
  } else {
    const auto distance = [&](const auto& size) {
      return std::abs(static_cast<int>(size.first) - static_cast<int>(pix.width)) +
             std::abs(static_cast<int>(size.second) - static_cast<int>(pix.height));
    };
    const auto size = *std::min_element(chosen->sizes.begin(), chosen->sizes.end(),
                                        [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    pix.width = size.first;
    pix.height = size.second;
  }
  pix.field = field;
  pix.bytesperline = pix.width * bytes_per_pixel(pix.pixelformat) + padding_bytes;
  pix.sizeimage = pix.bytesperline * pix.height;
  if (pix.pixelformat == V4L2_PIX_FMT_NV12) pix.sizeimage += pix.bytesperline * ((pix.height + 1) / 2);
  pix.sizeimage -= missing_bytes;
  picture_ = pix;
  return 0;
}

int VideoDevice::set_rate(v4l2_streamparm& parameter) {
  if (parameter.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return -EINVAL;
  v4l2_fract& time = parameter.parm.capture.timeperframe;
  const double asked = time.numerator == 0 ? 30.0 : static_cast<double>(time.denominator) / time.numerator;
  rate_hz_ = *std::min_element(rates_hz.begin(), rates_hz.end(),
                               [&](int a, int b) { return std::abs(a - asked) < std::abs(b - asked); });
  if (!tells_rate) return -ENOTTY;
  parameter.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  time = {1, static_cast<std::uint32_t>(rate_hz_)};
  return 0;
}

int VideoDevice::request_buffers(v4l2_requestbuffers& request) {
  if (request.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || request.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  if (streaming_ || mapped() != 0) return -EBUSY;
  buffers_.clear();
  if (request.count == 0) return 0;
  request.count = std::clamp(request.count, fewest_buffers, most_buffers);
  for (std::uint32_t i = 0; i < request.count; ++i) {
    buffers_.push_back(std::make_unique<Buffer>());
    buffers_.back()->memory.resize(picture_.sizeimage);
  }
  return 0;
}

int VideoDevice::query_buffer(v4l2_buffer& buffer) const {
  if (buffer.index >= buffers_.size()) return -EINVAL;
  buffer.length = static_cast<std::uint32_t>(buffers_[buffer.index]->memory.size());
  buffer.m.offset = buffer.index * kOffsetStep;
  buffer.flags = stamp_flags;
  return 0;
}

void* VideoDevice::map(std::size_t length, long offset, int protection) {
  const std::size_t index = static_cast<std::size_t>(offset) / kOffsetStep;
  if (!maps || index >= buffers_.size() || buffers_[index]->memory.size() != length || protection != PROT_READ)
    return nullptr;
  buffers_[index]->mapped = true;
  return buffers_[index]->memory.data();
}

bool VideoDevice::unmap(void* memory) {
  for (const auto& buffer : buffers_) {
    if (buffer->memory.data() != memory) continue;
    if (!buffer->mapped) breaches_.push_back("unmapped twice");
    buffer->mapped = false;
    return true;
  }
  return false;
}

int VideoDevice::queue(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_.size() || buffer.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  Buffer& own = *buffers_[buffer.index];
  if (own.owner != Owner::kUser) {
    breaches_.push_back("queued a buffer that the driver has");
    return -EINVAL;
  }
  own.owner = Owner::kQueued;
  queue_.push_back(buffer.index);
  return 0;
}

int VideoDevice::dequeue(v4l2_buffer& buffer) {
  if (buffer.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || buffer.memory != V4L2_MEMORY_MMAP || !streaming_) return -EINVAL;
  if (false_alarms > 0) {
    --false_alarms;
    return -EAGAIN;
  }
  if (done_.empty()) return -EAGAIN;
  Buffer& own = *buffers_[done_.front()];
  buffer = own.filled;
  own.owner = Owner::kUser;
  done_.pop_front();
  return 0;
}

int VideoDevice::start() {
  if (buffers_.empty()) return -EINVAL;
  if (forgets_controls_at_start) {
    controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_APERTURE_PRIORITY;
    controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 250;
  }
  streaming_ = true;
  started_ = kernel()->now();
  next_sequence_ = 0;
  return 0;
}

int VideoDevice::stop() {
  streaming_ = false;
  queue_.clear();
  done_.clear();
  for (const auto& buffer : buffers_) buffer->owner = Owner::kUser;
  return 0;
}

int VideoDevice::query(v4l2_queryctrl& control) const {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  control.minimum = found->second.low;
  control.maximum = found->second.high;
  control.step = found->second.step;
  control.flags = found->second.flags;
  return 0;
}

int VideoDevice::set(v4l2_control& control) {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  V4l2Control& own = found->second;
  ++own.writes;
  if (own.set_error != 0) return -own.set_error;
  if (control.value < own.low || control.value > own.high) return -ERANGE;
  if ((control.value - own.low) % own.step != 0) return -EINVAL;
  if (!own.stubborn) own.value = control.value;
  return 0;
}

int VideoDevice::get(v4l2_control& control) {
  const auto found = controls.find(control.id);
  if (found == controls.end()) return -EINVAL;
  ++found->second.reads;
  control.value = found->second.value;
  return 0;
}

short VideoDevice::events() {
  run();
  if (gone_) return POLLERR | POLLHUP;
  if (!streaming_) return POLLERR;
  return static_cast<short>(!done_.empty() || false_alarms > 0 ? POLLIN | POLLRDNORM : 0);
}

Instant VideoDevice::next_event() { return streaming_ && !gone_ ? ready(next_sequence_) : Instant::max(); }

/// Lets everything happen that is due.
void VideoDevice::run() {
  while (streaming_ && !gone_ && ready(next_sequence_) <= kernel()->now()) {
    if (gone_at_frame >= 0 && next_sequence_ >= static_cast<std::uint32_t>(gone_at_frame)) {
      gone_ = true;
      return;
    }
    fill(next_sequence_++);
  }
}

void VideoDevice::fill(std::uint32_t sequence) {
  const auto found = frame_faults.find(sequence);
  const V4l2FrameFault fault = found == frame_faults.end() ? V4l2FrameFault{} : found->second;
  if (queue_.empty() || fault.dropped) return;  // a frame without a buffer is lost
  const std::uint32_t index = queue_.front();
  queue_.pop_front();
  Buffer& own = *buffers_[index];
  std::memcpy(own.memory.data(), &sequence, sizeof sequence);
  own.memory.back() = static_cast<std::uint8_t>(sequence);
  v4l2_buffer& buffer = own.filled;
  buffer = {};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.bytesused = fault.bytes >= 0 ? static_cast<std::uint32_t>(fault.bytes) : picture_.sizeimage;
  buffer.flags = stamp_flags | (fault.damaged ? V4L2_BUF_FLAG_ERROR : 0u);
  buffer.sequence = fault.sequence >= 0 ? static_cast<std::uint32_t>(fault.sequence) : sequence;
  const bool start = (stamp_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const Instant stamp = (start ? start_of_exposure(sequence) : ready(sequence)) + fault.stamp_shift;
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(stamp.time_since_epoch()).count();
  buffer.timestamp = {us / 1000000, us % 1000000};
  own.owner = Owner::kDone;
  done_.push_back(index);
}

}  // namespace touchline::fake
