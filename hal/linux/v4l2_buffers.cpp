#include "hal/linux/v4l2_buffers.h"

#include <linux/videodev2.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>

namespace touchline::hal {

int V4l2Buffers::map(const V4l2Device& device, std::size_t count) {
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(std::min(count, kMax));
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = device.request(VIDIOC_REQBUFS, &request); error != 0) return error;
  const std::size_t granted = std::min<std::size_t>(request.count, kMax);
  for (count_ = 0; count_ < granted; ++count_) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = static_cast<std::uint32_t>(count_);
    if (const int error = device.request(VIDIOC_QUERYBUF, &buffer); error != 0) return error;
    // Written by the driver only.
    void* const memory = ::mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, device.file(), buffer.m.offset);
    if (memory == MAP_FAILED) return errno;
    slots_[count_] = {static_cast<std::uint8_t*>(memory), buffer.length, false};
    flags_ = buffer.flags;
  }
  return 0;
}

void V4l2Buffers::unmap(const V4l2Device& device) noexcept {
  if (count_ == 0) return;
  for (std::size_t i = 0; i < count_; ++i) {
    ::munmap(slots_[i].memory, slots_[i].length);
    slots_[i] = {};
  }
  count_ = 0;
  v4l2_requestbuffers request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  // A device that is gone has freed them already.
  static_cast<void>(device.request(VIDIOC_REQBUFS, &request));
}

int V4l2Buffers::queue_all(const V4l2Device& device) {
  for (std::size_t i = 0; i < count_; ++i) {
    if (const int error = queue(device, i); error != 0) return error;
  }
  return 0;
}

int V4l2Buffers::queue(const V4l2Device& device, std::size_t index) {
  if (index >= count_ || slots_[index].with_driver) return 0;
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = static_cast<std::uint32_t>(index);
  const int error = device.request(VIDIOC_QBUF, &buffer);
  slots_[index].with_driver = error == 0;
  return error;
}

int V4l2Buffers::dequeue(const V4l2Device& device, v4l2_buffer& buffer) {
  buffer = {};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (const int error = device.request(VIDIOC_DQBUF, &buffer); error != 0) return error;
  if (buffer.index >= count_) return EPROTO;
  slots_[buffer.index].with_driver = false;
  return 0;
}

void V4l2Buffers::forget_queue() {
  for (Slot& slot : slots_) slot.with_driver = false;
}

std::size_t V4l2Buffers::queued() const {
  return static_cast<std::size_t>(
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return slot.with_driver; }));
}

}  // namespace touchline::hal
