#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/linux/libcamera/libcamera_link.h"
#include "tests/linux/fake_dma.h"

namespace touchline::fake {

/// A fake libcamera with a camera that the test controls. The first frames are completed on the thread that queues
/// buffers, because the driver's start waits for them. After that, complete() completes each frame.
struct LibcameraWorld {
  using Change = std::function<void(hal::LibcameraFrame&)>;
  // Properties.
  std::vector<hal::LibcameraName> cameras{{"/base/soc/i2c0mux/i2c@1/imx219@10", "imx219", false}};
  std::map<std::string, int> errors;  // errors by name of the call; each occurs once
  int good_queues = 0;                // number of successful calls of queue() before its error
  std::string offers = "nv12 32x32 to 3280x2464";
  std::uint32_t padding_bytes = 0;  // padding of each row
  std::size_t spare_bytes = 0;      // bytes after the picture
  std::size_t actual_buffers = 0;   // 0: as many as requested
  std::size_t missing_bytes = 0;    // missing bytes of buffers that the driver allocates
  bool full_range = false, mirrored = false;
  hal::LibcameraLimits limits;
  hal::LibcameraNumbers metadata;        // reported by each frame
  hal::LibcameraNumbers early_metadata;  // reported by the first `early_frames`
  int early_frames = 0, frames_at_start = 1;
  bool applies_controls = true;  // the metadata contains an adjustment from the frame of its request on

  // Observations.
  std::string acquired;
  hal::LibcameraNumbers controls;
  int adjustments = 0;  // number of adjustments sent with a buffer
  std::vector<std::unique_ptr<DmaBufferFile>> own_buffers;
  std::vector<DmaBufferFile*> buffers;
  bool heap_used = false, running = false, released = true;
  std::string violation;

  /// Writes the number to the oldest queued buffer and completes it. `change` modifies the frame. Waits until a buffer
  /// is queued.
  void complete(std::uint32_t number, const Change& change = {});
  /// Waits until this number of buffers is queued.
  void wait_for_queued(std::size_t count);
  void unplug();

 private:
  friend class FakeLibcamera;
  void apply_carried_controls(std::uint32_t buffer);
  void finish(std::uint32_t buffer, std::uint32_t number, const Change& change);
  hal::LibcameraSink* sink_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::uint32_t> queued_;
  std::map<std::uint32_t, hal::LibcameraNumbers> carried_;  // controls sent with each buffer
  std::size_t frame_bytes_ = 0;
  int frames_left_ = 0;
  std::thread::id caller_;
};

/// The LibcameraLink to a LibcameraWorld.
class FakeLibcamera final : public hal::LibcameraLink {
 public:
  explicit FakeLibcamera(LibcameraWorld& world) : world_(world) {}

  int cameras(std::vector<hal::LibcameraName>& found) override;
  int acquire(const std::string& id, hal::LibcameraSink& sink) override;
  int configure(hal::LibcameraStream& requested, std::string& offers) override;
  hal::LibcameraLimits limits() override { return world_.limits; }
  int use_buffers(const std::vector<hal::DmaBuffer>& buffers) override;
  int make_buffers(std::vector<hal::DmaBuffer>& buffers) override;
  int start(const hal::LibcameraNumbers& controls) override;
  void adjust(const hal::LibcameraNumbers& controls) override { adjusted_ = controls; }
  int queue(std::uint32_t buffer) override;
  void stop() override;
  void release() override;

 private:
  int error_of(const char* call);
  LibcameraWorld& world_;
  hal::LibcameraStream stream_;
  std::optional<hal::LibcameraNumbers> adjusted_;
  std::vector<int> files_;
};

}  // namespace touchline::fake
