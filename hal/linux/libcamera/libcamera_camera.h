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
  std::uint64_t frames = 0;  // frames returned by wait()
  std::uint64_t lost = 0;    // gaps in the device's sequence numbers or in time
  std::uint64_t corrupt = 0, short_frames = 0;
};

/// A camera of libcamera. Its buffers are mapped once and lent to the caller.
///
/// There are three threads. A thread of this driver makes all calls to libcamera. A thread of libcamera synchronizes
/// the caches and puts completed frames into a ring. The caller takes frames from this ring and returns buffers through
/// a second one. Thus neither wait() nor the end of a lease uses the heap or calls libcamera, which allocates for every
/// frame.
///
/// wait() returns kTimeout, kShortFrame, kCorruptFrame (the next frame may be good), kDisconnected and kIo (reopen the
/// camera).
class LibcameraCamera final : public Camera, private LibcameraSink {
 public:
  /// `priority`: SCHED_FIFO priority of the loop; 0: none. The threads of libcamera get this priority minus one; they
  /// need it because they deliver the frames. `link` null: this build has no libcamera, and open() fails with a message
  /// that says so.
  LibcameraCamera(CameraSettings settings, int priority, std::unique_ptr<LibcameraLink> link);
  ~LibcameraCamera() override { LibcameraCamera::do_close(); }
  LibcameraCamera(const LibcameraCamera&) = delete;
  LibcameraCamera& operator=(const LibcameraCamera&) = delete;

  [[nodiscard]] const CameraInfo& info() const override { return info_; }

  /// Returns the counts since start().
  [[nodiscard]] const LibcameraCounters& counters() const { return counters_; }

 private:
  // largest value of CameraSettings::buffers
  static constexpr std::size_t kMaxBuffers = 32;
  enum class Task : std::uint8_t { kNone, kOpen, kStart, kAdjust, kStop, kClose };

  // Functions for the caller's thread.
  Result<void> do_open() override;
  Result<void> do_start() override;
  Result<std::string> do_adjust(const CameraSettings& settings) override;
  Result<FrameLease> do_wait(Instant deadline) override;
  void do_release(std::uint32_t buffer) noexcept override;
  void do_stop() override;
  void do_close() override;
  void stop_stream();
  void close_camera();
  Result<void> ask(Task task);
  bool take(Instant deadline, LibcameraFrame& frame);
  void discard_settling_frames();
  std::optional<LibcameraNumbers> await_controls();
  void set_exposure(const LibcameraNumbers& numbers);
  void drop_completed();
  void report_negotiated(const LibcameraNumbers& reported);
  Result<FrameLease> deliver(const LibcameraFrame& frame);
  std::uint32_t periods_since_last(const LibcameraFrame& frame, Instant stamp, Instant now);
  Error fail(Error error) noexcept;

  // Functions for the driver's thread.
  void work();
  Result<void> perform(Task task);
  Result<void> open_on_worker();
  Result<void> choose_camera();
  Result<void> configure();
  Result<void> prepare_buffers();
  Result<void> allocate_buffers(std::vector<DmaBuffer>& buffers);
  Result<void> start_on_worker();
  void stop_on_worker();
  void close_on_worker();
  [[nodiscard]] int queue(std::uint32_t buffer);
  void queue_returned();
  Error refused(const char* doing, int error);

  // Functions for a thread of libcamera.
  void frame_done(const LibcameraFrame& frame) noexcept override;
  void camera_gone() noexcept override;

  [[nodiscard]] const char* name() const { return id_.empty() ? settings_.device.c_str() : id_.c_str(); }

  CameraSettings settings_;
  std::mutex changing_;  // guards the controls, opening, closing and streaming; not needed by wait()
  const int priority_;
  const std::unique_ptr<LibcameraLink> link_;

  std::string id_, model_;
  std::uint32_t stamp_flags_ = 0;  // flags of v4l2_buffer
  CameraInfo info_;
  LibcameraStream stream_;
  std::size_t needed_bytes_ = 0;  // a frame with fewer bytes counts as short
  LibcameraLimits limits_;
  LibcameraNumbers controls_;
  DmaHeap heap_;
  std::vector<int> files_;  // files of the buffers that were allocated from the heap
  std::array<DmaMapping, kMaxBuffers> mappings_;
  ErrorText negotiated_;  // differences from the settings
  std::size_t negotiated_at_open_ = 0;

  bool streaming_ = false;
  std::optional<Error> lost_;  // an error after which the camera must be reopened
  CaptureStamp stamps_;
  FrameCounter sequence_;
  Instant last_stamp_{};         // last plausible time stamp
  bool last_has_stamp_ = false;  // whether the last frame had a plausible time stamp
  double last_duration_us_ = 0.0;
  LibcameraCounters counters_;

  // Data shared by the threads. A buffer is in at most one ring, so no ring can be full.
  SpscRing<LibcameraFrame, kMaxBuffers> completed_;
  SpscRing<std::uint32_t, kMaxBuffers> returned_;
  Semaphore ready_, work_, done_;
  std::atomic<bool> accepts_frames_{false}, disconnected_{false};
  std::atomic<int> queue_error_{0};
  // True while adjust() waits for the metadata of frames. There is no lock, because adjust() runs with ordinary
  // priority, and frames must not wait for its thread.
  std::atomic<bool> metadata_wanted_{false};
  SpscRing<LibcameraNumbers, 2 * kMaxBuffers> metadata_;
  Semaphore metadata_ready_;
  std::atomic<Task> task_{Task::kNone};
  Result<void> result_;  // result of the task; published by done_
  std::thread worker_;
};

}  // namespace touchline::hal
