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

/// What libcamera and its camera do, by the test's word. The first frames come by themselves, in the thread that
/// queues, as a driver's start needs them; after that complete() makes each.
struct LibcameraWorld {
  using Change = std::function<void(hal::LibcameraFrame&)>;
  // What it is.
  std::vector<hal::LibcameraName> cameras{{"/base/soc/i2c0mux/i2c@1/imx219@10", "imx219", false}};
  std::map<std::string, int> errors;  // by the call's name, once each
  int good_queues = 0;                // before the error of "queue"
  std::string offers = "nv12 32x32 to 3280x2464";
  std::uint32_t padding_bytes = 0;  // of a row
  std::size_t spare_bytes = 0;      // behind the picture
  std::size_t granted_buffers = 0;  // 0: as asked
  std::size_t missing_bytes = 0;    // of a buffer that the driver makes
  bool full_range = false;
  hal::LibcameraLimits limits;
  hal::LibcameraNumbers told;   // by each frame
  hal::LibcameraNumbers early;  // by the first `early_frames`
  int early_frames = 0, frames_at_start = 1;
  bool obeys = true;  // an adjustment, in what is told from the frame on whose buffer it went with

  // What was seen.
  std::string acquired;
  hal::LibcameraNumbers controls;
  int adjustments = 0;  // that went with a buffer
  std::vector<std::unique_ptr<DmaBufferFile>> own_buffers;
  std::vector<DmaBufferFile*> buffers;
  bool heap_used = false, running = false, released = true;
  std::string breach;

  /// The oldest queued buffer is filled with its number and completed. `change`: what is odd about it. Waits until one
  /// is queued.
  void complete(std::uint32_t number, const Change& change = {});
  /// Waits until so many buffers are queued.
  void wait_for_queued(std::size_t count);
  void plug_out();

 private:
  friend class FakeLibcamera;
  void obey(std::uint32_t buffer);
  void finish(std::uint32_t buffer, std::uint32_t number, const Change& change);
  hal::LibcameraSink* sink_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::uint32_t> queued_;
  std::map<std::uint32_t, hal::LibcameraNumbers> carried_;  // by buffers
  std::size_t frame_bytes_ = 0;
  int frames_left_ = 0;
  std::thread::id caller_;
};

/// The link to it.
class FakeLibcamera final : public hal::LibcameraLink {
 public:
  explicit FakeLibcamera(LibcameraWorld& world) : world_(world) {}

  int cameras(std::vector<hal::LibcameraName>& found) override;
  int acquire(const std::string& id, hal::LibcameraSink& sink) override;
  int configure(hal::LibcameraStream& wish, std::string& offers) override;
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
