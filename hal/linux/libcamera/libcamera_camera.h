#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/camera.h"
#include "hal/device_parameters.h"
#include "hal/error_text.h"
#include "hal/linux/dma_buffer.h"
#include "hal/linux/frame_counter.h"
#include "hal/linux/libcamera/libcamera_link.h"
#include "hal/linux/semaphore.h"
#include "hal/linux/v4l2/capture_stamp.h"
#include "hal/spsc_ring.h"

namespace touchline::hal {

struct LibcameraCounters {
  std::uint64_t frames = 0;  // handed out
  std::uint64_t lost = 0;    // gaps in the device's count, or in time
  std::uint64_t corrupt = 0, short_frames = 0;
};

/// A camera of libcamera's, its buffers mapped once and lent to the caller.
///
/// Three threads: all calls to libcamera are made on a thread of the driver's own; libcamera hands completed frames to
/// a ring on a thread of its own, caches made true to them; the caller takes them from there and gives buffers back by
/// a second ring. So wait() and the lease's end touch neither heap nor libcamera, which allocates for every frame.
///
/// wait() answers kTimeout, kShortFrame, kCorruptFrame (go on), kDisconnected and kIo (open again).
class LibcameraCamera final : public Camera, private LibcameraSink {
 public:
  /// `priority`: of the loop under SCHED_FIFO, 0 for none. libcamera's threads are put one below: a frame comes through
  /// them. `link` null: this build has no libcamera, which open() tells.
  LibcameraCamera(CameraSettings settings, int priority, std::unique_ptr<LibcameraLink> link);
  ~LibcameraCamera() override { LibcameraCamera::do_close(); }
  LibcameraCamera(const LibcameraCamera&) = delete;
  LibcameraCamera& operator=(const LibcameraCamera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

  /// Since start().
  [[nodiscard]] const LibcameraCounters& counters() const { return counters_; }

 private:
  // CameraSettings::buffers has at most 32.
  static constexpr std::size_t kMostBuffers = 32;
  enum class Task : std::uint8_t { kNone, kOpen, kStart, kAdjust, kStop, kClose };

  // Of Camera: on the caller's thread.
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<std::string> do_adjust(const CameraSettings& settings) override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override;
  void do_close() override;
  void halt();
  void shut();
  Result<void> ask(Task task);
  bool take(Instant deadline, LibcameraFrame& frame);
  void settle();
  std::optional<LibcameraNumbers> await_controls();
  void set_exposure(const LibcameraNumbers& numbers);
  void forget_completed();
  void report_negotiated(const LibcameraNumbers& reported);
  Result<FrameLease> deliver(const LibcameraFrame& frame);
  std::uint32_t periods_since_last(const LibcameraFrame& frame, Instant stamp, Instant now);
  Error fail(Error error) noexcept;

  // On the driver's own thread.
  void work();
  Result<void> perform(Task task);
  Result<void> open_here();
  Result<void> choose_camera();
  Result<void> configure();
  Result<void> prepare_buffers();
  Result<void> allocate_buffers(std::vector<DmaBuffer>& buffers);
  Result<void> start_here();
  void stop_here();
  void close_here();
  [[nodiscard]] int queue(std::uint32_t buffer);
  void queue_returned();
  Error refused(const char* doing, int error);

  // On a thread of libcamera's.
  void frame_done(const LibcameraFrame& frame) noexcept override;
  void camera_gone() noexcept override;

  [[nodiscard]] const char* name() const { return id_.empty() ? settings_.device.c_str() : id_.c_str(); }

  CameraSettings settings_;
  std::mutex changing_;  // the controls, or whether the device is open and streams; wait() changes neither
  const int priority_;
  const std::unique_ptr<LibcameraLink> link_;

  std::string id_, model_;
  std::uint32_t stamp_flags_ = 0;  // as V4L2 has them
  CameraInfo info_;
  LibcameraStream stream_;
  std::size_t needed_bytes_ = 0;  // a frame with fewer is short
  LibcameraLimits limits_;
  LibcameraNumbers controls_;
  DmaHeap heap_;
  std::vector<int> files_;  // of the heap's
  std::array<DmaMapping, kMostBuffers> mappings_;
  ErrorText negotiated_;  // what differs from the settings
  std::size_t negotiated_at_open_ = 0;

  bool streaming_ = false;
  std::optional<Error> lost_;  // an error after which the camera must be reopened
  CaptureStamp stamps_;
  FrameCounter sequence_;
  Instant last_stamp_{};         // that could be true
  bool last_has_stamp_ = false;  // so could the last frame's
  double last_duration_us_ = 0.0;
  LibcameraCounters counters_;

  // Between the threads. A buffer is in one ring at most, so neither can be full.
  SpscRing<LibcameraFrame, kMostBuffers> completed_;
  SpscRing<std::uint32_t, kMostBuffers> returned_;
  Semaphore ready_, work_, done_;
  std::atomic<bool> flowing_{false}, gone_{false};
  std::atomic<int> queue_error_{0};
  // Somebody wants to know what frames tell. No lock: who changes a parameter has an ordinary priority, and frames do
  // not wait until that thread has its turn.
  std::atomic<bool> watched_{false};
  SpscRing<LibcameraNumbers, 2 * kMostBuffers> told_;
  Semaphore telling_;
  std::atomic<Task> task_{Task::kNone};
  Result<void> result_;  // of the task; published by done_
  std::thread worker_;
};

}  // namespace touchline::hal
