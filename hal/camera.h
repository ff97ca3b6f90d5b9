#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "core/time.h"
#include "core/types.h"
#include "hal/result.h"
#include "hal/true_places.h"

namespace touchline::hal {

/// Minimum number of frame buffers: the driver fills one while the loop holds the other.
constexpr std::size_t kMinBuffers = 2;

class Camera;
struct CameraSettings;

/// File descriptors of the memory (dma-buf) of a picture, with which another device (encoder, display) reads it without
/// a copy. There is one per memory plane; -1: none. Planar formats may lie in one memory plane.
using DmaBufs = std::array<int, kMaxPlanes>;
inline constexpr DmaBufs kNoDmaBufs{-1, -1, -1};

/// A frame in the driver's buffer. Move-only; the destructor returns the buffer to the driver. The camera must outlive
/// the lease, and stop() must not be called while a lease exists.
class FrameLease {
 public:
  FrameLease() = default;
  FrameLease(Camera& owner, const Frame& frame, std::uint32_t buffer, DmaBufs dma_bufs = kNoDmaBufs)
      : owner_(&owner), frame_(frame), buffer_(buffer), dma_bufs_(dma_bufs) {}
  FrameLease(FrameLease&& other) noexcept { swap(other); }
  FrameLease& operator=(FrameLease&& other) noexcept {
    FrameLease(std::move(other)).swap(*this);
    return *this;
  }
  FrameLease(const FrameLease&) = delete;
  FrameLease& operator=(const FrameLease&) = delete;
  ~FrameLease();

  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// The camera owns them; they stay open until its close(). To keep the descriptors longer, duplicate them. They are
  /// for reading only. The picture does not change during the lifetime of the lease.
  [[nodiscard]] const DmaBufs& dma_bufs() const { return dma_bufs_; }
  /// The JPEG file from which the frame was decoded, as the camera sent it; empty: the camera sends this picture. Valid
  /// during the lifetime of the lease.
  [[nodiscard]] std::span<const std::uint8_t> jpeg() const { return jpeg_; }
  void set_jpeg(std::span<const std::uint8_t> jpeg) { jpeg_ = jpeg; }
  /// Null: the camera does not know it. Valid during the lifetime of the lease.
  [[nodiscard]] const TruePlaces* truth() const { return truth_; }
  void set_truth(const TruePlaces* truth) { truth_ = truth; }

 private:
  void swap(FrameLease& other) noexcept {
    std::swap(owner_, other.owner_);
    std::swap(frame_, other.frame_);
    std::swap(buffer_, other.buffer_);
    std::swap(dma_bufs_, other.dma_bufs_);
    std::swap(jpeg_, other.jpeg_);
    std::swap(truth_, other.truth_);
  }
  Camera* owner_ = nullptr;
  Frame frame_;
  std::uint32_t buffer_ = 0;
  DmaBufs dma_bufs_ = kNoDmaBufs;
  std::span<const std::uint8_t> jpeg_;
  const TruePlaces* truth_ = nullptr;
};

/// Format and settings of an open camera.
struct CameraInfo {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  double rate_hz = 0.0;  // 0: the input has no frame rate
  // One line: device, format, and the values of the controls; empty if the camera has no settings.
  std::string description{};
  // The device, and the values that differ from the settings; empty if all values are as set.
  std::string negotiated{};
};

/// What a source of poses did not use.
struct SourceCounters {
  std::uint64_t late = 0;       // packets that a newer one had overtaken
  std::uint64_t doubled = 0;    // packets that arrived twice
  std::uint64_t foreign = 0;    // packets of a second sender
  std::uint64_t malformed = 0;  // packets that cannot be read

  [[nodiscard]] std::uint64_t sum() const { return late + doubled + foreign + malformed; }
};

/// A source of frames. After any error but kTimeout, kShortFrame and kCorruptFrame: close() and open() it again.
/// Messages of errors name the device, the cause and what to do.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Negotiates the format and allocates; may block.
  Result<void> open() { return do_open(); }
  /// Starts to stream. Nothing is allocated between start() and stop(), except for error messages that do not fit into
  /// an ErrorText.
  Result<void> start() { return do_start(); }
  /// Returns the oldest frame that was not returned yet and waits for it until `deadline` (of hal::Clock).
  /// kTimeout: no frame arrived. kShortFrame, kCorruptFrame: this frame is lost, the next one may be good.
  /// kEndOfStream: a recording has ended.
  Result<FrameLease> wait(Instant deadline) { return do_wait(deadline); }
  /// Sets exposure, gain, white balance, focus and the flicker filter to the values in `settings`, now and after the
  /// next open(); ignores all other settings. May block. Any thread may call it at any time; streaming goes on. Returns
  /// the device and the values that differ from the settings. Returns "" if all values are as set, or if the camera is
  /// not open; open() then reports differences in info(). kUnsupported: the camera has no such controls.
  Result<std::string> adjust(const CameraSettings& settings) { return do_adjust(settings); }
  void stop() { do_stop(); }
  void close() { do_close(); }

  /// Returns the camera's format and settings; valid after open().
  [[nodiscard]] virtual const CameraInfo& info() const = 0;
  /// Returns counts since the construction, for the loop's thread.
  [[nodiscard]] virtual SourceCounters source_counters() const { return {}; }

 private:
  friend class FrameLease;
  virtual Result<void> do_open() = 0;
  virtual Result<void> do_start() = 0;
  virtual Result<FrameLease> do_wait(Instant deadline) = 0;
  virtual void do_release(std::uint32_t buffer) noexcept = 0;
  virtual Result<std::string> do_adjust(const CameraSettings& /*settings*/) {
    return failure(ErrorCode::kUnsupported,
                   "exposure, gain and focus of this camera cannot be changed while it streams");
  }
  virtual void do_stop() = 0;
  virtual void do_close() = 0;
};

inline FrameLease::~FrameLease() {
  if (owner_ != nullptr) owner_->do_release(buffer_);
}

}  // namespace touchline::hal
