#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/pixel_format.h"
#include "tests/linux/fake_kernel.h"

namespace touchline::fake {

struct V4l2Format {
  std::uint32_t fourcc = V4L2_PIX_FMT_YUYV;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;  // for a stepwise list: smallest and largest size
  bool stepwise = false;
};

struct V4l2Control {
  int low = 0, high = 0, step = 1, value = 0;
  int set_error = 0;            // error of setting the control
  int refused_value = -1;       // a value that the control rejects
  bool ignores_writes = false;  // accepts new values without using them
  std::uint32_t flags = 0;
  std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
  std::string name = "Control";
  std::int64_t unit = 1;            // for 64-bit controls: factor of all values
  std::vector<std::string> menu{};  // names of the values; "": the value does not exist
  int reads = 0, writes = 0;
  int default_value = low;  // the default
};

/// Faults of a frame, by the driver's sequence number.
struct V4l2FrameFault {
  bool damaged = false;
  bool dropped = false;        // the frame is lost before it gets a buffer
  std::int64_t bytes = -1;     // bytes in the last memory plane; -1: all
  std::int64_t wrong_at = -1;  // position of a wrong byte in a JPEG
  Duration stamp_shift{};
  std::int64_t sequence = -1;  // sequence number instead of the right one
};

/// An exported memory plane of a buffer. Records whether the processor may read it.
class DmaBuf final : public File {
 public:
  explicit DmaBuf(std::vector<std::string>& violations) : violations_(violations) {}
  int ioctl(unsigned long request, void* argument) override;
  void close() override { open = false; }
  bool open = true, readable = false;
  int interruptions = 0;  // number of calls that return EAGAIN first

 private:
  std::vector<std::string>& violations_;
};

/// A camera that behaves like videobuf2 of the kernel: buffers are queued, filled in time and dequeued in order;
/// formats are adjusted to the nearest one; errors are those of the specification. It records violations of the
/// specification that the kernel would not report.
class VideoDevice final : public File {
 public:
  VideoDevice();

  // Properties.
  std::string driver = "fake", card = "Fake Camera", bus = "usb-0000:00:14.0-1";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<V4l2Format> formats;
  std::vector<int> rates_hz{30, 60};
  bool reports_rate = true;
  bool exports = true;
  std::uint32_t quantization = V4L2_QUANTIZATION_DEFAULT;
  std::uint32_t plane_offset = 0;   // multi-planar: bytes before the picture in each memory plane
  std::vector<std::uint8_t> jpeg;   // content of MJPG frames
  std::uint32_t padding_bytes = 0;  // padding of each row
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t missing_bytes = 0;  // bytes missing from a buffer
  std::uint32_t min_buffers = 2, max_buffers = 32;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  std::map<std::uint32_t, V4l2Control> controls;
  bool forgets_controls_at_start = false;

  // Faults.
  std::map<std::uint32_t, V4l2FrameFault> frame_faults;
  std::int64_t gone_at_frame = -1;    // the device is unplugged at this frame
  std::int64_t stalls_at_frame = -1;  // there are no frames from this one on, until the stream is restarted
  bool maps = true;
  int sync_interruptions = 0;
  int spurious_wakeups = 0;  // number of times that poll() reports a frame although there is none
  void unplug() { gone_ = true; }
  /// `times` requests of this kind fail after `after` successful ones.
  void fail(unsigned long request, int error, int after = 0, int times = 1) {
    failures_[request] = {error, after, times};
  }

  // Observations.
  [[nodiscard]] Instant start_of_exposure(std::uint32_t sequence) const;
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }
  [[nodiscard]] std::size_t mapped() const;
  /// Return the numbers of buffers whose dma-buf is synchronized for reading, and of open dma-bufs.
  [[nodiscard]] std::size_t readable() const;
  [[nodiscard]] std::size_t exported() const;
  [[nodiscard]] bool cached_memory_requested() const { return cached_memory_requested_; }
  [[nodiscard]] bool streaming() const { return streaming_; }
  [[nodiscard]] int requests(unsigned long request) const;
  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
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
  struct Plane {
    std::vector<std::uint8_t> memory;
    bool mapped = false;
    std::unique_ptr<DmaBuf> shared;
    v4l2_plane filled{};
  };
  struct Buffer {
    std::array<Plane, kMaxPlanes> plane;
    Owner owner = Owner::kUser;
    v4l2_buffer filled{};
  };
  /// The current format, which both interfaces report.
  struct Picture {
    std::uint32_t fourcc = 0, width = 0, height = 0;
    std::size_t planes = 1;
    std::array<std::uint32_t, kMaxPlanes> stride_bytes{}, bytes{};
  };
  struct Failure {
    int error = 0, after = 0, times = 0;
  };

  int handle(unsigned long request, void* argument);
  int query(v4l2_capability& capability) const;
  int enumerate(v4l2_fmtdesc& format) const;
  int enumerate(v4l2_frmsizeenum& size) const;
  int enumerate(v4l2_frmivalenum& interval) const;
  int enumerate(v4l2_querymenu& item) const;
  [[nodiscard]] bool multi_planar() const { return (capabilities & V4L2_CAP_VIDEO_CAPTURE) == 0; }
  [[nodiscard]] bool is_own(std::uint32_t type) const;
  void choose(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height);
  int set_format(v4l2_format& format);
  int set_rate(v4l2_streamparm& parameter);
  int request_buffers(v4l2_requestbuffers& request);
  int query_buffer(v4l2_buffer& buffer) const;
  int export_buffer(v4l2_exportbuffer& request);
  [[nodiscard]] bool is_addressed(const v4l2_buffer& buffer) const;
  int queue(v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  int start();
  int stop();
  int query(v4l2_queryctrl& control) const;
  int query(v4l2_query_ext_ctrl& control) const;
  int set(v4l2_control& control);
  int get(v4l2_control& control);
  int get(v4l2_ext_controls& request);
  void run();
  void fill(std::uint32_t sequence);
  [[nodiscard]] Duration period() const { return from_seconds(1.0 / rate_hz_); }
  [[nodiscard]] Instant ready(std::uint32_t sequence) const;

  Picture picture_;
  int rate_hz_ = 30;
  std::vector<std::unique_ptr<Buffer>> buffers_;
  std::deque<std::uint32_t> queue_, done_;
  bool streaming_ = false, gone_ = false, cached_memory_requested_ = false;
  int open_count_ = 0;
  Instant started_{};
  std::uint32_t next_sequence_ = 0;
  std::map<unsigned long, Failure> failures_;
  std::map<unsigned long, int> requests_;
  std::vector<std::string> violations_;
};

}  // namespace touchline::fake
