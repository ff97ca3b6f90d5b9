// The part of LibcameraCamera that runs on the driver's thread: all calls to libcamera. It may block and allocate.
#include <linux/videodev2.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>

#include "hal/linux/libcamera/libcamera_camera.h"
#include "hal/linux/libcamera/libcamera_controls.h"
#include "hal/linux/system_error.h"

namespace touchline::hal {
namespace {

// On processors whose caches DMA bypasses, the buffers that the driver allocates are not cached.
#if defined(__x86_64__) || defined(__i386__)
constexpr bool kDmaIsCoherent = true;
#else
constexpr bool kDmaIsCoherent = false;
#endif

std::array<std::uint32_t, kMaxPlanes> strides_of(const LibcameraStream& stream) {
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
  for (std::size_t i = 0; i < info_of(stream.format).planes; ++i) {
    stride_bytes[i] = plane_stride(stream.format, i, stream.stride_bytes);
  }
  return stride_bytes;
}

/// Returns the bytes that a picture needs in each plane.
std::array<std::size_t, kMaxPlanes> needed_bytes(const LibcameraStream& stream) {
  std::array<std::size_t, kMaxPlanes> bytes{};
  for (std::size_t i = 0; i < kMaxPlanes; ++i) {
    bytes[i] = plane_bytes(stream.format, i, stream.width_px, stream.height_px, strides_of(stream)[i]);
  }
  return bytes;
}

/// Splits a picture in one piece of memory into its planes.
void split(DmaBuffer& buffer, const LibcameraStream& stream) {
  const std::size_t planes = info_of(stream.format).planes;
  const DmaPlane whole = buffer.plane[0];
  const PictureLayout layout = picture_layout(stream.format, stream.height_px, strides_of(stream));
  if (planes == 1 || buffer.plane[1].file >= 0 || whole.length < layout.offset_bytes[planes - 1]) return;
  for (std::size_t i = 0; i < planes; ++i) {
    const std::size_t begin = layout.offset_bytes[i];
    const std::size_t end = i + 1 < planes ? layout.offset_bytes[i + 1] : whole.length;
    buffer.plane[i] = {whole.file, whole.offset + begin, end - begin};
  }
}

}  // namespace

void LibcameraCamera::work() {
  // The threads of libcamera inherit the priority. A refusal is not reported here: the system then also refuses the
  // loop's priority, and the loop reports it.
  if (priority_ > 0) {
    const sched_param below{.sched_priority = std::max(priority_ - 1, 1)};
    static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &below));
  }
  for (;;) {
    work_.wait();
    queue_returned();
    const Task task = task_.exchange(Task::kNone, std::memory_order_acquire);
    if (task == Task::kNone) continue;
    try {
      result_ = perform(task);
    } catch (const std::exception& error) {  // out of memory, or the library failed: the camera can be reopened
      result_ = failure(ErrorCode::kIo, "%s: libcamera failed: %s", name(), error.what());
    }
    done_.post();
    if (task == Task::kClose) return;
  }
}

Result<void> LibcameraCamera::perform(Task task) {
  switch (task) {
    case Task::kOpen:
      return open_on_worker();
    case Task::kStart:
      return start_on_worker();
    case Task::kAdjust:
      link_->adjust(controls_);
      break;
    case Task::kStop:
      stop_on_worker();
      break;
    case Task::kClose:
      close_on_worker();
      break;
    case Task::kNone:
      break;
  }
  return {};
}

Result<void> LibcameraCamera::open_on_worker() {
  disconnected_.store(false, std::memory_order_relaxed);
  TOUCHLINE_TRY(choose_camera());
  TOUCHLINE_TRY(configure());
  TOUCHLINE_TRY(prepare_buffers());
  limits_ = link_->limits();
  controls_ = controls_for(settings_, limits_, negotiated_);
  negotiated_at_open_ = negotiated_.size();
  return {};
}

Result<void> LibcameraCamera::choose_camera() {
  std::vector<LibcameraName> cameras;
  if (const int error = link_->cameras(cameras); error != 0) {
    return failure(open_error(error), "libcamera cannot be started: %s", system_text(error));
  }
  const LibcameraName* const chosen = choose(cameras, settings_.device);
  if (chosen == nullptr) {
    return failure(ErrorCode::kNotFound, "%s: no such camera; available cameras: %s%s", name(),
                   list_of(cameras).c_str(),
                   cameras.empty() ? " (is it plugged in, and the user in the group video?)" : "");
  }
  id_ = chosen->id;
  model_ = chosen->model;
  // The time stamp marks the arrival of the first row, after the end of its exposure, although libcamera's
  // documentation calls it the time of the exposure. The time stamps of USB cameras come from the kernel's driver.
  const bool is_of_start = chosen->external && uvc_computes_stamps();
  stamp_flags_ =
      V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (is_of_start ? V4L2_BUF_FLAG_TSTAMP_SRC_SOE : V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
  if (const int error = link_->acquire(id_, *this); error != 0) return refused("acquiring the camera", error);
  return {};
}

Result<void> LibcameraCamera::configure() {
  const char* const format = kCameraFormats[static_cast<std::size_t>(settings_.format)].word.data();
  if (settings_.format == CameraFormat::kMjpg) {
    return failure(ErrorCode::kUnsupported, "%s: libcamera does not offer %s; for a USB camera use backend v4l2",
                   name(), format);
  }
  stream_ = {};
  stream_.format = pixel_format(settings_.format);
  stream_.width_px = settings_.width_px;
  stream_.height_px = settings_.height_px;
  stream_.buffers = static_cast<std::size_t>(settings_.buffers);
  std::string offers;
  const int error = link_->configure(stream_, offers);
  if (error == EINVAL) {
    return failure(ErrorCode::kUnsupported, "%s: %s %ux%u is not available; the camera offers %s", name(), format,
                   unsigned{settings_.width_px}, unsigned{settings_.height_px}, offers.c_str());
  }
  if (error != 0) return refused("setting a format", error);
  info_ = {stream_.format, stream_.width_px, stream_.height_px, settings_.rate_hz};
  const std::array<std::size_t, kMaxPlanes> bytes = needed_bytes(stream_);
  const std::size_t last = info_of(stream_.format).planes - std::size_t{1};
  const PictureLayout layout = picture_layout(stream_.format, stream_.height_px, strides_of(stream_));
  needed_bytes_ = layout.offset_bytes[last] + bytes[last];
  if (const char* const note = note_on_range(stream_.format, stream_.full_range)) {
    negotiated_.append_format("%s", note);
  }
  if (stream_.mirrored) {
    negotiated_.append_format(
        "%slibcamera delivers a mirror image (its orientation): robots' headings and turns would be reflected. Check "
        "the camera's mounting and tuning; writing below the camera must be readable",
        negotiated_.separator());
  }
  return {};
}

Result<void> LibcameraCamera::prepare_buffers() {
  std::vector<DmaBuffer> buffers;
  TOUCHLINE_TRY(allocate_buffers(buffers));
  if (buffers.size() < kMinBuffers || buffers.size() > kMaxBuffers) {
    return failure(ErrorCode::kUnsupported, "%s: the camera provides %zu buffers; %zu to %zu are needed", name(),
                   buffers.size(), kMinBuffers, kMaxBuffers);
  }
  stream_.buffers = buffers.size();
  if (stream_.buffers != static_cast<std::size_t>(settings_.buffers)) {
    negotiated_.append_format("%sbuffers = %d: set to %zu", negotiated_.separator(), settings_.buffers,
                              stream_.buffers);
  }
  const std::array<std::size_t, kMaxPlanes> needed = needed_bytes(stream_);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    split(buffers[i], stream_);
    for (std::size_t p = 0; p < needed.size(); ++p) {
      if (buffers[i].plane[p].length >= needed[p]) continue;
      return failure(ErrorCode::kUnsupported, "%s: plane %zu of a buffer has %zu bytes, a picture needs %zu", name(), p,
                     buffers[i].plane[p].length, needed[p]);
    }
    if (const int error = mappings_[i].map(buffers[i]); error != 0) return refused("mapping buffers", error);
  }
  return {};
}

/// Allocates buffers from a cached DMA heap, otherwise from the driver.
Result<void> LibcameraCamera::allocate_buffers(std::vector<DmaBuffer>& buffers) {
  int error = heap_.open();
  const std::size_t bytes = std::max(stream_.frame_bytes, needed_bytes_);
  while (error == 0 && buffers.size() < stream_.buffers) {
    int file = -1;
    error = heap_.allocate(bytes, file);
    if (error != 0) break;
    files_.push_back(file);
    buffers.push_back({{DmaPlane{file, 0, bytes}, DmaPlane{}}});
    split(buffers.back(), stream_);
  }
  if (error == 0) {
    error = link_->use_buffers(buffers);
    return error == 0 ? Result<void>() : refused("using buffers of a DMA heap", error);
  }
  if (!kDmaIsCoherent || error != ENOENT) {
    negotiated_.append_format("%sno memory from a DMA heap (%s%s%s): the driver's own buffers may be slow to read",
                              negotiated_.separator(), heap_.name(), *heap_.name() != '\0' ? ": " : "",
                              system_text(error));
  }
  buffers.clear();
  error = link_->make_buffers(buffers);
  return error == 0 ? Result<void>() : refused("allocating buffers", error);
}

Result<void> LibcameraCamera::start_on_worker() {
  if (disconnected_.load(std::memory_order_acquire)) {
    return device_lost(name(), "camera", ErrorCode::kDisconnected, "before the stream began", 0);
  }
  queue_error_.store(0, std::memory_order_relaxed);
  accepts_frames_.store(true, std::memory_order_release);
  int error = link_->start(controls_);
  for (std::uint32_t i = 0; error == 0 && i < stream_.buffers; ++i) error = queue(i);
  if (error == 0) return {};
  stop_on_worker();
  return refused("starting the stream", error);
}

void LibcameraCamera::stop_on_worker() {
  accepts_frames_.store(false, std::memory_order_release);
  link_->stop();
  queue_returned();
}

void LibcameraCamera::close_on_worker() {
  for (DmaMapping& mapping : mappings_) mapping.unmap();
  link_->release();
  for (const int file : files_) ::close(file);
  files_.clear();
  heap_.close();
}

int LibcameraCamera::queue(std::uint32_t buffer) {
  const int error = mappings_[buffer].end_read();
  return error != 0 ? error : link_->queue(buffer);
}

void LibcameraCamera::queue_returned() {
  std::uint32_t buffer = 0;
  while (returned_.pop(buffer)) {
    if (!accepts_frames_.load(std::memory_order_relaxed)) continue;
    if (const int error = queue(buffer); error != 0 && !disconnected_.load(std::memory_order_acquire)) {
      queue_error_.store(error, std::memory_order_release);
      ready_.post();
    }
  }
}

Error LibcameraCamera::refused(const char* doing, int error) {
  const ErrorCode code = open_error(error);
  if (code == ErrorCode::kDeviceBusy) {
    return failure(code, "%s: in use by another process; `fuser -v /dev/media* /dev/video*` shows it", name());
  }
  return failure(code, "%s: %s failed: %s", name(), doing, system_text(error));
}

}  // namespace touchline::hal
