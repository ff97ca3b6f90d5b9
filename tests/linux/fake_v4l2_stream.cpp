#include <fcntl.h>
#include <linux/dma-buf.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tests/linux/fake_v4l2.h"

namespace touchline::fake {
namespace {

// Distance of the mmap() offsets of memory planes: larger than a plane, and 64 of them fit into 32 bits.
constexpr std::uint32_t kOffsetStep = 1u << 25;

}  // namespace

int DmaBuf::ioctl(unsigned long request, void* argument) {
  if (request != DMA_BUF_IOCTL_SYNC) return -ENOTTY;
  if (interruptions > 0) {
    --interruptions;
    return -EAGAIN;
  }
  const auto flags = static_cast<const dma_buf_sync*>(argument)->flags;
  const bool begin = (flags & DMA_BUF_SYNC_END) == 0;
  if ((flags & DMA_BUF_SYNC_RW) != DMA_BUF_SYNC_READ) return -EINVAL;
  if (begin == readable) violations_.push_back(begin ? "read begun twice" : "read ended twice");
  readable = begin;
  return 0;
}

std::size_t VideoDevice::mapped() const {
  return static_cast<std::size_t>(
      std::count_if(buffers_.begin(), buffers_.end(), [](const auto& buffer) { return buffer->plane[0].mapped; }));
}

std::size_t VideoDevice::readable() const {
  return static_cast<std::size_t>(std::count_if(buffers_.begin(), buffers_.end(), [](const auto& buffer) {
    return buffer->plane[0].shared != nullptr && buffer->plane[0].shared->readable;
  }));
}

std::size_t VideoDevice::exported() const {
  std::size_t count = 0;
  for (const auto& buffer : buffers_) {
    for (const Plane& plane : buffer->plane) count += plane.shared != nullptr && plane.shared->open ? 1U : 0U;
  }
  return count;
}

int VideoDevice::request_buffers(v4l2_requestbuffers& request) {
  if (!is_own(request.type) || request.memory != V4L2_MEMORY_MMAP) return -EINVAL;
  if (streaming_ || mapped() != 0) return -EBUSY;
  if (exported() != 0) violations_.push_back("buffers freed while a dma-buf is open");
  buffers_.clear();
  if (request.count == 0) return 0;
  cached_memory_requested_ = (request.flags & V4L2_MEMORY_FLAG_NON_COHERENT) != 0;
  request.count = std::clamp(request.count, min_buffers, max_buffers);
  for (std::uint32_t i = 0; i < request.count; ++i) {
    buffers_.push_back(std::make_unique<Buffer>());
    for (std::size_t p = 0; p < picture_.planes; ++p) {
      buffers_.back()->plane[p].memory.resize(picture_.bytes[p] + plane_offset);
    }
  }
  return 0;
}

bool VideoDevice::is_addressed(const v4l2_buffer& buffer) const {
  return is_own(buffer.type) && (!multi_planar() || (buffer.m.planes != nullptr && buffer.length >= picture_.planes));
}

int VideoDevice::query_buffer(v4l2_buffer& buffer) const {
  if (buffer.index >= buffers_.size() || !is_addressed(buffer)) return -EINVAL;
  const auto& planes = buffers_[buffer.index]->plane;
  buffer.flags = stamp_flags;
  if (!multi_planar()) {
    buffer.length = static_cast<std::uint32_t>(planes[0].memory.size());
    buffer.m.offset = static_cast<__u32>(kMaxPlanes) * buffer.index * kOffsetStep;
    return 0;
  }
  buffer.length = static_cast<std::uint32_t>(picture_.planes);
  for (std::uint32_t i = 0; i < buffer.length; ++i) {
    buffer.m.planes[i].length = static_cast<std::uint32_t>(planes[i].memory.size());
    buffer.m.planes[i].m.mem_offset = (static_cast<__u32>(kMaxPlanes) * buffer.index + i) * kOffsetStep;
  }
  return 0;
}

int VideoDevice::export_buffer(v4l2_exportbuffer& request) {
  if (!exports) return -ENOTTY;
  if (!is_own(request.type) || request.index >= buffers_.size() || request.plane >= picture_.planes) return -EINVAL;
  if (request.flags != (O_RDONLY | O_CLOEXEC)) return -EINVAL;
  Plane& plane = buffers_[request.index]->plane[request.plane];
  plane.shared = std::make_unique<DmaBuf>(violations_);
  plane.shared->interruptions = sync_interruptions;
  request.fd = kernel()->adopt(*plane.shared);
  return 0;
}

void* VideoDevice::map(std::size_t length, long offset, int protection) {
  const std::size_t index = static_cast<std::size_t>(offset) / kOffsetStep;
  if (!maps || index / kMaxPlanes >= buffers_.size() || protection != PROT_READ) return nullptr;
  Plane& plane = buffers_[index / kMaxPlanes]->plane[index % kMaxPlanes];
  if (plane.memory.size() != length) return nullptr;
  plane.mapped = true;
  return plane.memory.data();
}

bool VideoDevice::unmap(void* memory) {
  for (const auto& buffer : buffers_) {
    for (Plane& plane : buffer->plane) {
      if (plane.memory.data() != memory) continue;
      if (!plane.mapped) violations_.push_back("unmapped twice");
      plane.mapped = false;
      return true;
    }
  }
  return false;
}

int VideoDevice::queue(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_.size() || buffer.memory != V4L2_MEMORY_MMAP || !is_addressed(buffer)) return -EINVAL;
  Buffer& own = *buffers_[buffer.index];
  if (own.owner != Owner::kUser) {
    violations_.push_back("queued a buffer that the driver owns");
    return -EINVAL;
  }
  for (const Plane& plane : own.plane) {
    if (plane.shared != nullptr && plane.shared->readable) violations_.push_back("queued during a read");
  }
  own.owner = Owner::kQueued;
  queue_.push_back(buffer.index);
  return 0;
}

int VideoDevice::dequeue(v4l2_buffer& buffer) {
  if (!is_addressed(buffer) || buffer.memory != V4L2_MEMORY_MMAP || !streaming_) return -EINVAL;
  if (spurious_wakeups > 0) {
    --spurious_wakeups;
    return -EAGAIN;
  }
  if (done_.empty()) return -EAGAIN;
  Buffer& own = *buffers_[done_.front()];
  v4l2_plane* const planes = buffer.m.planes;
  buffer = own.filled;
  if (multi_planar()) {
    buffer.m.planes = planes;
    buffer.length = static_cast<std::uint32_t>(picture_.planes);
    for (std::size_t i = 0; i < picture_.planes; ++i) planes[i] = own.plane[i].filled;
  }
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

short VideoDevice::events() {
  run();
  if (gone_) return POLLERR | POLLHUP;
  if (!streaming_) return POLLERR;
  return static_cast<short>(!done_.empty() || spurious_wakeups > 0 ? POLLIN | POLLRDNORM : 0);
}

Instant VideoDevice::next_event() {
  const bool stalled = stalls_at_frame >= 0 && next_sequence_ >= static_cast<std::uint32_t>(stalls_at_frame);
  return streaming_ && !gone_ && !stalled ? ready(next_sequence_) : Instant::max();
}

/// Processes all frames that are due.
void VideoDevice::run() {
  while (streaming_ && !gone_ && ready(next_sequence_) <= kernel()->now()) {
    if (gone_at_frame >= 0 && next_sequence_ >= static_cast<std::uint32_t>(gone_at_frame)) {
      gone_ = true;
      return;
    }
    if (stalls_at_frame >= 0 && next_sequence_ >= static_cast<std::uint32_t>(stalls_at_frame)) return;
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
  v4l2_buffer& buffer = own.filled;
  buffer = {};
  buffer.index = index;
  buffer.type = multi_planar() ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  for (std::size_t i = 0; i < picture_.planes; ++i) {
    std::vector<std::uint8_t>& memory = own.plane[i].memory;
    std::size_t used = memory.size();
    if (picture_.fourcc == V4L2_PIX_FMT_MJPEG) {
      used = std::min(jpeg.size(), memory.size());
      std::copy_n(jpeg.begin(), used, memory.begin());
      if (fault.wrong_at >= 0) memory[static_cast<std::size_t>(fault.wrong_at)] ^= 0x55u;
    } else {
      std::memcpy(memory.data() + plane_offset, &sequence, sizeof sequence);
      memory.back() = static_cast<std::uint8_t>(sequence);
    }
    if (fault.bytes >= 0 && i + 1 == picture_.planes) used = static_cast<std::size_t>(fault.bytes);
    buffer.bytesused = static_cast<std::uint32_t>(used);
    own.plane[i].filled = {};
    own.plane[i].filled.bytesused = static_cast<std::uint32_t>(used);
    own.plane[i].filled.length = static_cast<std::uint32_t>(memory.size());
    own.plane[i].filled.data_offset = plane_offset;
  }
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
