#include "hal/linux/v4l2/v4l2_buffers.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "hal/linux/dma_buffer.h"

namespace touchline::hal {

/// Sets the fields that all requests for a buffer need; `planes` must outlive `buffer`.
void V4l2Buffers::fill_request(v4l2_buffer& buffer, Planes& planes, std::size_t index) const {
  buffer = {};
  buffer.type = capture_type(multi_planar_);
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = static_cast<std::uint32_t>(index);
  if (!multi_planar_) return;
  planes = {};
  buffer.m.planes = planes.data();
  buffer.length = static_cast<std::uint32_t>(planes_);
}

int V4l2Buffers::map(const V4l2Device& device, bool multi_planar, std::size_t planes, std::size_t count) {
  multi_planar_ = multi_planar;
  planes_ = planes;
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(std::min(count, kMax));
  request.type = capture_type(multi_planar_);
  request.memory = V4L2_MEMORY_MMAP;
  request.flags = V4L2_MEMORY_FLAG_NON_COHERENT;  // drivers without this option ignore it
  if (const int error = device.request(VIDIOC_REQBUFS, &request); error != 0) return error;
  const std::size_t actual = std::min<std::size_t>(request.count, kMax);
  while (count_ < actual) {
    // Count the buffer before mapping, so that unmap() also unmaps a partly mapped one.
    if (const int error = map_slot(device, count_++); error != 0) return error;
  }
  export_all(device);
  return 0;
}

int V4l2Buffers::map_slot(const V4l2Device& device, std::size_t index) {
  v4l2_buffer buffer;
  Planes planes;
  fill_request(buffer, planes, index);
  if (const int error = device.request(VIDIOC_QUERYBUF, &buffer); error != 0) return error;
  if (multi_planar_ && buffer.length < planes_) return EPROTO;
  flags_ = buffer.flags;
  Slot& slot = slots_[index];
  for (std::size_t i = 0; i < planes_; ++i) {
    const std::size_t size = multi_planar_ ? planes[i].length : buffer.length;
    const std::uint32_t offset = multi_planar_ ? planes[i].m.mem_offset : buffer.m.offset;
    // Read only: only the driver writes.
    void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, device.file(), offset);
    if (memory == MAP_FAILED) return errno;
    slot.memory[i] = static_cast<std::uint8_t*>(memory);
    slot.size[i] = size;
  }
  return 0;
}

/// Exports either all planes of all buffers or none, because users of a picture need all of its planes.
void V4l2Buffers::export_all(const V4l2Device& device) {
  exported_ = true;
  for (std::size_t i = 0; i < count_ * planes_ && exported_; ++i) {
    v4l2_exportbuffer request{};
    request.type = capture_type(multi_planar_);
    request.index = static_cast<std::uint32_t>(i / planes_);
    request.plane = static_cast<std::uint32_t>(i % planes_);
    request.flags = O_RDONLY | O_CLOEXEC;
    exported_ = device.request(VIDIOC_EXPBUF, &request) == 0;
    if (exported_) slots_[i / planes_].dma_bufs[i % planes_] = request.fd;
  }
  if (!exported_) close_exports();
}

void V4l2Buffers::close_exports() {
  for (Slot& slot : slots_) {
    for (int& file : slot.dma_bufs) {
      if (file >= 0) ::close(file);
      file = -1;
    }
  }
  exported_ = false;
}

void V4l2Buffers::unmap(const V4l2Device& device) noexcept {
  if (count_ == 0) return;
  close_exports();
  for (Slot& slot : slots_) {
    for (std::size_t i = 0; i < kMaxPlanes; ++i) {
      if (slot.memory[i] != nullptr) ::munmap(slot.memory[i], slot.size[i]);
    }
    slot = {};
  }
  count_ = 0;
  v4l2_requestbuffers request{};
  request.type = capture_type(multi_planar_);
  request.memory = V4L2_MEMORY_MMAP;
  // This fails if the device has disappeared; the kernel has then freed the buffers.
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
  v4l2_buffer buffer;
  Planes planes;
  fill_request(buffer, planes, index);
  const int error = device.request(VIDIOC_QBUF, &buffer);
  slots_[index].with_driver = error == 0;
  return error;
}

int V4l2Buffers::dequeue(const V4l2Device& device, Filled& filled) {
  v4l2_buffer buffer;
  Planes planes;
  fill_request(buffer, planes, 0);
  if (const int error = device.request(VIDIOC_DQBUF, &buffer); error != 0) return error;
  if (buffer.index >= count_) return EPROTO;
  Slot& slot = slots_[buffer.index];
  slot.with_driver = false;
  filled.index = buffer.index;
  filled.flags = buffer.flags;
  filled.sequence = buffer.sequence;
  filled.stamp =
      Instant(std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec));
  for (std::size_t i = 0; i < planes_; ++i) {
    // bytesused includes data_offset.
    const std::size_t used =
        std::min<std::size_t>(multi_planar_ ? planes[i].bytesused : buffer.bytesused, slot.size[i]);
    const std::size_t offset = multi_planar_ ? std::min<std::size_t>(planes[i].data_offset, used) : 0;
    filled.begin[i] = slot.memory[i] + offset;
    filled.bytes[i] = static_cast<std::uint32_t>(used - offset);
  }
  return 0;
}

void V4l2Buffers::forget_queue() {
  for (Slot& slot : slots_) slot.with_driver = false;
}

std::size_t V4l2Buffers::queued() const {
  return static_cast<std::size_t>(
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return slot.with_driver; }));
}

int V4l2Buffers::begin_read(std::size_t index) const {
  int error = 0;
  for (std::size_t i = 0; i < planes_ && exported_ && error == 0; ++i) error = begin_cpu_read(dma_bufs(index)[i]);
  return error;
}

int V4l2Buffers::end_read(std::size_t index) const {
  int error = 0;
  for (std::size_t i = 0; i < planes_ && exported_ && error == 0; ++i) error = end_cpu_read(dma_bufs(index)[i]);
  return error;
}

}  // namespace touchline::hal
