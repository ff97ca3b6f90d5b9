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

// The seam between the driver (libcamera_camera.h) and the library: what is above knows nothing of libcamera's types
// and versions and is tested without it; what is below (libcamera_link.cpp) only calls.
namespace touchline::hal {

struct LibcameraName {
  std::string id;     // stays the same in the same socket
  std::string model;  // of the sensor, or what a USB camera calls itself
  bool external = false;
};

/// "id (model), ..." or "none".
std::string list_of(const std::vector<LibcameraName>& cameras);

/// The camera that `device` means: "auto" the first, at a ribbon cable rather than at USB; else an id, or a part that
/// only one id has. Null: none.
const LibcameraName* choose(const std::vector<LibcameraName>& cameras, const std::string& device);

/// Each a number: times in microseconds, gains as factors, Kelvin, dioptres; of switches 1 is manual.
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

/// Of each control a number, where there is one.
class LibcameraNumbers {
 public:
  std::optional<double>& operator[](LibcameraControl control) { return numbers_[static_cast<std::size_t>(control)]; }
  const std::optional<double>& operator[](LibcameraControl control) const {
    return numbers_[static_cast<std::size_t>(control)];
  }

 private:
  std::array<std::optional<double>, kLibcameraControls> numbers_{};
};

/// What a camera can be told: the least and most of each control that it has.
struct LibcameraLimits {
  LibcameraNumbers low, high;
  [[nodiscard]] bool has(LibcameraControl control) const { return low[control].has_value(); }
};

/// How pictures will come.
struct LibcameraStream {
  PixelFormat format = PixelFormat::kNv12;
  std::uint16_t width_px = 0, height_px = 0;
  std::uint32_t stride_bytes = 0;  // of the first plane
  std::size_t frame_bytes = 0;     // that the device needs a buffer
  std::size_t buffers = 0;
  bool full_range = false;  // luma from 0 to 255 instead of 16 to 235
};

/// A completed request.
struct LibcameraFrame {
  enum class State : std::uint8_t { kGood, kDamaged, kCancelled };
  State state = State::kGood;
  std::uint32_t buffer = 0;
  std::uint32_t sequence = 0;
  std::size_t bytes = 0;      // that were written
  std::int64_t stamp_ns = 0;  // of CLOCK_MONOTONIC or CLOCK_BOOTTIME; 0: none
  LibcameraNumbers reported;  // what the camera says that it did
};

/// Who gets frames, on a thread of libcamera's.
class LibcameraSink {
 public:
  virtual void frame_done(const LibcameraFrame& frame) noexcept = 0;
  virtual void camera_gone() noexcept = 0;

 protected:
  ~LibcameraSink() = default;
};

/// One use of libcamera. All calls come from one thread; all may block and allocate. Errors are errnos, 0 is success.
class LibcameraLink {
 public:
  virtual ~LibcameraLink() = default;

  /// Starts the library where it is not running.
  virtual int cameras(std::vector<LibcameraName>& found) = 0;
  /// Takes a camera of the list for this process alone; `sink` must live until release().
  virtual int acquire(const std::string& id, LibcameraSink& sink) = 0;
  /// Asks for `wish` and puts in its place what is granted. EINVAL: another format or size; `offers` lists what there
  /// is.
  virtual int configure(LibcameraStream& wish, std::string& offers) = 0;
  /// After configure().
  virtual LibcameraLimits limits() = 0;
  /// Pictures go to buffers of the caller's, whose files stay the caller's too.
  virtual int use_buffers(const std::vector<DmaBuffer>& buffers) = 0;
  /// Has the driver make buffers; their files stay open until release().
  virtual int make_buffers(std::vector<DmaBuffer>& buffers) = 0;
  /// Begins, with these controls from the first frame on. Buffers are queued afterwards.
  virtual int start(const LibcameraNumbers& controls) = 0;
  /// While it streams: these controls go with the next buffer that is queued.
  virtual void adjust(const LibcameraNumbers& controls) = 0;
  virtual int queue(std::uint32_t buffer) = 0;
  /// When it returns no frame is under way.
  virtual void stop() = 0;
  /// Ends the library, too, unless somebody else uses it.
  virtual void release() = 0;
};

/// Null: this build has no libcamera.
std::unique_ptr<LibcameraLink> make_libcamera_link();

/// All cameras that libcamera finds now, for listings; nothing in a build without it. Blocks.
std::vector<LibcameraName> libcamera_cameras();

}  // namespace touchline::hal
