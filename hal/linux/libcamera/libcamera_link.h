#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/linux/dma_buffer.h"

// Interface between the driver (libcamera_camera.h) and libcamera. The driver uses no type of libcamera and is tested
// without it; the implementation (libcamera_link.cpp) only calls the library.
namespace touchline::hal {

struct LibcameraName {
  std::string id;     // stays the same as long as the socket is the same
  std::string model;  // model of the sensor or of the USB camera
  bool external = false;
};

/// Returns "id (model), ..." or "none".
std::string list_of(const std::vector<LibcameraName>& cameras);

/// Returns the camera that `device` names, null if there is none. "auto": the first camera that is not a USB camera,
/// else the first one. Otherwise an id, or a part that only one id contains.
const LibcameraName* choose(const std::vector<LibcameraName>& cameras, const std::string& device);

/// Units are microseconds, gain factors, kelvins and diopters; for switches, 1 means manual.
enum class LibcameraControl : std::uint8_t {
  kExposureManual,
  kExposure,
  kGainManual,
  kGain,
  kWhiteBalanceManual,
  kTemperature,
  kRedGain,
  kBlueGain,
  kFlickerManual,
  kFlickerPeriod,
  kFrameDuration,
  kFocusManual,
  kLensPosition,
};
inline constexpr std::size_t kLibcameraControls = 13;

/// A number for each control, if known.
class LibcameraNumbers {
 public:
  std::optional<double>& operator[](LibcameraControl control) { return numbers_[static_cast<std::size_t>(control)]; }
  const std::optional<double>& operator[](LibcameraControl control) const {
    return numbers_[static_cast<std::size_t>(control)];
  }

 private:
  std::array<std::optional<double>, kLibcameraControls> numbers_{};
};

/// Ranges of the controls that a camera has.
struct LibcameraLimits {
  LibcameraNumbers low, high;
  [[nodiscard]] bool has(LibcameraControl control) const { return low[control].has_value(); }
};

/// Format and buffers of a stream.
struct LibcameraStream {
  PixelFormat format = PixelFormat::kNv12;
  std::uint16_t width_px = 0, height_px = 0;
  std::uint32_t stride_bytes = 0;  // stride of the first plane
  std::size_t frame_bytes = 0;     // bytes of a buffer that the device needs
  std::size_t buffers = 0;
  bool full_range = false;  // luma from 0 to 255 instead of 16 to 235
  bool mirrored = false;    // the picture is a mirror image
};

/// A completed request.
struct LibcameraFrame {
  enum class State : std::uint8_t { kGood, kDamaged, kCancelled };
  State state = State::kGood;
  std::uint32_t buffer = 0;
  std::uint32_t sequence = 0;
  std::size_t bytes = 0;      // number of bytes that were written
  std::int64_t stamp_ns = 0;  // time stamp in CLOCK_MONOTONIC or CLOCK_BOOTTIME; 0: none
  LibcameraNumbers reported;  // metadata of the frame
};

/// Receives frames, on a thread of libcamera.
class LibcameraSink {
 public:
  virtual void frame_done(const LibcameraFrame& frame) noexcept = 0;
  virtual void camera_gone() noexcept = 0;

 protected:
  ~LibcameraSink() = default;
};

/// A connection to libcamera. All calls come from the same thread, and may block and allocate. They return 0 or an
/// errno.
class LibcameraLink {
 public:
  virtual ~LibcameraLink() = default;

  /// Lists the cameras; starts the library if it is not running.
  virtual int cameras(std::vector<LibcameraName>& found) = 0;
  /// Acquires a camera for this process; `sink` must live until release().
  virtual int acquire(const std::string& id, LibcameraSink& sink) = 0;
  /// Sets format, size and number of buffers, and writes the negotiated values to `requested`. EINVAL: they are not
  /// available; `offers` then lists the available ones.
  virtual int configure(LibcameraStream& requested, std::string& offers) = 0;
  /// Returns the ranges of the controls; call it after configure().
  virtual LibcameraLimits limits() = 0;
  /// Uses the caller's buffers; the caller keeps the ownership of their files.
  virtual int use_buffers(const std::vector<DmaBuffer>& buffers) = 0;
  /// Lets the driver allocate buffers; their files stay open until release().
  virtual int make_buffers(std::vector<DmaBuffer>& buffers) = 0;
  /// Starts the stream with these controls. Buffers are queued afterwards.
  virtual int start(const LibcameraNumbers& controls) = 0;
  /// Sends these controls with the next queued buffer.
  virtual void adjust(const LibcameraNumbers& controls) = 0;
  virtual int queue(std::uint32_t buffer) = 0;
  /// Stops the stream; afterwards no frame is in progress.
  virtual void stop() = 0;
  /// Releases the camera, and stops the library if it has no other user.
  virtual void release() = 0;
};

/// Returns null if this build has no libcamera.
std::unique_ptr<LibcameraLink> make_libcamera_link();

/// Returns all cameras that libcamera finds; none in a build without it. Blocks.
std::vector<LibcameraName> libcamera_cameras();

}  // namespace touchline::hal
