#include "tests/linux/fake_libcamera.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline::fake {

void LibcameraWorld::finish(std::uint32_t buffer, std::uint32_t number, const Change& change) {
  hal::LibcameraFrame frame;
  frame.buffer = buffer;
  frame.sequence = number;
  frame.bytes = frame_bytes_;
  frame.stamp_ns = hal::MonotonicClock::read().time_since_epoch().count();
  apply_carried_controls(buffer);
  frame.reported = metadata;
  if (frames_left_ > 0 && early_frames > 0) {
    --early_frames;
    frame.reported = early_metadata;
  }
  if (change) change(frame);
  buffers[buffer]->write(0, std::vector<std::uint8_t>(frame_bytes_, static_cast<std::uint8_t>(number)));
  sink_->frame_done(frame);
}

void LibcameraWorld::apply_carried_controls(std::uint32_t buffer) {
  const std::lock_guard lock(mutex_);
  const auto carried = carried_.extract(buffer);
  if (!carried) return;
  ++adjustments;
  controls = carried.mapped();
  for (std::size_t i = 0; applies_controls && i < hal::kLibcameraControls; ++i) {
    const auto control = static_cast<hal::LibcameraControl>(i);
    if (metadata[control] && carried.mapped()[control]) metadata[control] = carried.mapped()[control];
  }
}

void LibcameraWorld::complete(std::uint32_t number, const Change& change) {
  wait_for_queued(1);
  std::uint32_t buffer = 0;
  {
    const std::lock_guard lock(mutex_);
    buffer = queued_.front();
    queued_.pop_front();
  }
  finish(buffer, number, change);
}

void LibcameraWorld::wait_for_queued(std::size_t count) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return queued_.size() >= count; });
}

void LibcameraWorld::unplug() {
  cameras.clear();
  sink_->camera_gone();
}

int FakeLibcamera::error_of(const char* call) {
  const auto found = world_.errors.find(call);
  if (world_.caller_ == std::thread::id{}) world_.caller_ = std::this_thread::get_id();
  if (world_.caller_ != std::this_thread::get_id()) world_.violation = std::string(call) + " from another thread";
  if (found == world_.errors.end()) return 0;
  if (found->first == "queue" && world_.good_queues-- > 0) return 0;
  const int error = found->second;
  world_.errors.erase(found);
  return error;
}

int FakeLibcamera::cameras(std::vector<hal::LibcameraName>& found) {
  found = world_.cameras;
  return error_of("cameras");
}

int FakeLibcamera::formats(const std::string& /*id*/, std::vector<hal::V4l2FormatInfo>& offers) {
  offers = world_.formats;
  return error_of("formats");
}

int FakeLibcamera::acquire(const std::string& id, hal::LibcameraSink& sink) {
  world_.acquired = id;
  world_.sink_ = &sink;
  world_.released = false;
  return error_of("acquire");
}

int FakeLibcamera::configure(hal::LibcameraStream& requested, std::string& offers) {
  if (const int error = error_of("configure"); error != 0) {
    offers = world_.offers;
    return error;
  }
  // Chroma has half as many bytes as luma in 4:2:0, as many in 4:2:2.
  const bool has_planes = info_of(requested.format).planes > 1,
             has_420 = info_of(requested.format).channel[1].shift_v > 0;
  requested.stride_bytes = requested.width_px * info_of(requested.format).channel[0].step + world_.padding_bytes;
  world_.frame_bytes_ = std::size_t{requested.stride_bytes} * requested.height_px *
                        (!has_planes ? 2
                         : has_420   ? 3
                                     : 4) /
                        2;
  requested.frame_bytes = world_.frame_bytes_ + world_.spare_bytes;
  requested.full_range = world_.full_range;
  requested.mirrored = world_.mirrored;
  if (world_.actual_buffers != 0) requested.buffers = world_.actual_buffers;
  stream_ = requested;
  return 0;
}

int FakeLibcamera::use_buffers(const std::vector<hal::DmaBuffer>& buffers) {
  world_.heap_used = true;
  for (const hal::DmaBuffer& buffer : buffers) {
    world_.buffers.push_back(static_cast<DmaBufferFile*>(kernel()->file(buffer.plane[0].file)));
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < kMaxPlanes; ++i) {
      const bool is_used = i < info_of(stream_.format).planes;
      if (is_used != (buffer.plane[i].file == buffer.plane[0].file)) world_.violation = "planes of a heap's buffer";
      bytes += buffer.plane[i].length;
    }
    if (bytes != stream_.frame_bytes) world_.violation = "a heap's buffer's size";
  }
  return error_of("use_buffers");
}

int FakeLibcamera::make_buffers(std::vector<hal::DmaBuffer>& buffers) {
  const std::size_t bytes = stream_.frame_bytes - world_.missing_bytes;
  for (std::size_t i = 0; i < stream_.buffers; ++i) {
    world_.own_buffers.push_back(std::make_unique<DmaBufferFile>(bytes));
    world_.buffers.push_back(world_.own_buffers.back().get());
    files_.push_back(kernel()->adopt(*world_.own_buffers.back()));
    buffers.push_back({{hal::DmaPlane{files_.back(), 0, bytes}, hal::DmaPlane{}}});
  }
  return error_of("make_buffers");
}

int FakeLibcamera::start(const hal::LibcameraNumbers& controls) {
  world_.controls = controls;
  world_.running = true;
  world_.frames_left_ = world_.frames_at_start;
  return error_of("start");
}

int FakeLibcamera::queue(std::uint32_t buffer) {
  if (const int error = error_of("queue"); error != 0) return error;
  if (world_.frames_left_ > 0) {
    world_.finish(buffer, 0, {});
    --world_.frames_left_;
    return 0;
  }
  const std::lock_guard lock(world_.mutex_);
  if (adjusted_) world_.carried_[buffer] = *std::exchange(adjusted_, std::nullopt);
  if (std::find(world_.queued_.begin(), world_.queued_.end(), buffer) != world_.queued_.end()) {
    world_.violation = "a buffer is queued twice";
  }
  world_.queued_.push_back(buffer);
  world_.changed_.notify_all();
  return 0;
}

void FakeLibcamera::stop() {
  error_of("stop");
  world_.running = false;
  const std::lock_guard lock(world_.mutex_);
  for (const std::uint32_t buffer : world_.queued_) {
    hal::LibcameraFrame frame;
    frame.state = hal::LibcameraFrame::State::kCancelled;
    frame.buffer = buffer;
    world_.sink_->frame_done(frame);
  }
  world_.queued_.clear();
}

void FakeLibcamera::release() {
  error_of("release");
  if (world_.running) world_.violation = "released while it streams";
  for (const int file : files_) ::close(file);
  files_.clear();
  world_.buffers.clear();
  world_.caller_ = {};
  world_.released = true;
}

}  // namespace touchline::fake
