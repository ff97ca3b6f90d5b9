#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/linux/fake_kernel.h"

namespace touchline::fake {

struct V4l2Format {
  std::uint32_t fourcc = V4L2_PIX_FMT_YUYV;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;  // stepwise: smallest and largest
  bool stepwise = false;
};

struct V4l2Control {
  int low = 0, high = 0, step = 1, value = 0;
  int set_error = 0;      // refuses
  bool stubborn = false;  // accepts, and keeps its value
  std::uint32_t flags = 0;
  int reads = 0, writes = 0;
};

/// What goes wrong with one frame, by the driver's count.
struct V4l2FrameFault {
  bool damaged = false;
  bool dropped = false;     // lost before it had a buffer
  std::int64_t bytes = -1;  // -1: all
  Duration stamp_shift{};
  std::int64_t sequence = -1;  // counted as this instead
};

/// A camera that behaves as the kernel's videobuf2 does: buffers queued, filled in time, dequeued in order; formats
/// adjusted to the nearest; refusals by the standard. Breaches of the standard that the kernel would not tell are
/// noted.
class VideoDevice final : public File {
 public:
  VideoDevice();

  // What it is.
  std::string card = "Fake Camera", bus = "usb-0000:00:14.0-1";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<V4l2Format> formats;
  std::vector<int> rates_hz{30, 60};
  bool tells_rate = true;
  std::uint32_t padding_bytes = 0;  // of a row
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t missing_bytes = 0;  // of a buffer
  std::uint32_t fewest_buffers = 2, most_buffers = 32;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  std::map<std::uint32_t, V4l2Control> controls;
  bool forgets_controls_at_start = false;

  // What goes wrong.
  std::map<std::uint32_t, V4l2FrameFault> frame_faults;
  std::int64_t gone_at_frame = -1;  // unplugged when this one is due
  bool maps = true;
  int false_alarms = 0;  // so often poll() says ready and nothing is
  void plug_out() { gone_ = true; }
  /// The `after`-th next request of the kind fails, `times` times.
  void fail(unsigned long request, int error, int after = 0, int times = 1) {
    failures_[request] = {error, after, times};
  }

  // What was seen.
  [[nodiscard]] Instant start_of_exposure(std::uint32_t sequence) const;
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }
  [[nodiscard]] std::size_t mapped() const;
  [[nodiscard]] bool streaming() const { return streaming_; }
  [[nodiscard]] int requests(unsigned long request) const;
  [[nodiscard]] const std::vector<std::string>& breaches() const { return breaches_; }
  static constexpr Duration kReadout = std::chrono::milliseconds(8);

  int open() override;
  void close() override;
  int ioctl(unsigned long request, void* argument) override;
  short events() override;
  Instant next_event() override;
  void* map(std::size_t length, long offset, int protection) override;
  bool unmap(void* memory) override;

 private:
  enum class Owner : std::uint8_t { kUser, kQueued, kDone };
  struct Buffer {
    std::vector<std::uint8_t> memory;
    Owner owner = Owner::kUser;
    bool mapped = false;
    v4l2_buffer filled{};
  };
  struct Failure {
    int error = 0, after = 0, times = 0;
  };

  int handle(unsigned long request, void* argument);
  int query(v4l2_capability& capability) const;
  int enumerate(v4l2_fmtdesc& format) const;
  int enumerate(v4l2_frmsizeenum& size) const;
  int set_format(v4l2_format& format);
  int set_rate(v4l2_streamparm& parameter);
  int request_buffers(v4l2_requestbuffers& request);
  int query_buffer(v4l2_buffer& buffer) const;
  int queue(v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  int start();
  int stop();
  int query(v4l2_queryctrl& control) const;
  int set(v4l2_control& control);
  int get(v4l2_control& control);
  void run();
  void fill(std::uint32_t sequence);
  [[nodiscard]] Duration period() const { return from_seconds(1.0 / rate_hz_); }
  [[nodiscard]] Instant ready(std::uint32_t sequence) const;

  v4l2_pix_format picture_{};
  int rate_hz_ = 30;
  std::vector<std::unique_ptr<Buffer>> buffers_;
  std::deque<std::uint32_t> queue_, done_;
  bool streaming_ = false, gone_ = false;
  int open_count_ = 0;
  Instant started_{};
  std::uint32_t next_sequence_ = 0;
  std::map<unsigned long, Failure> failures_;
  std::map<unsigned long, int> requests_;
  std::vector<std::string> breaches_;
};

}  // namespace touchline::fake
