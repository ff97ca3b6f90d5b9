#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/pixel_format.h"
#include "core/time.h"
#include "hal/device_parameters.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"

namespace touchline::hal::mock {

/// Injects the faults of FaultKind that begin with kPicture: pictures with fresh time stamps and frame numbers that do
/// not show the scene before the camera. Allocates only what the listed faults need, when
/// they are listed.
class PictureFaults {
 public:
  PictureFaults(const ArenaParameters& parameters, const CameraSettings& camera, std::uint64_t seed);

  /// Makes room for a fault of this kind. The constructor does so for the faults of the parameters.
  void prepare(FaultKind kind);

  /// Changes the scene before the sensor, so rotated and random pictures have fresh noise. `scene`: R, G, B of each
  /// pixel. The result is valid until the next call. `is_active`: FaultKind -> bool.
  template <class IsActive>
  std::span<const std::uint16_t> change_scene(std::span<const std::uint16_t> scene, IsActive is_active) {
    if (is_active(FaultKind::kPictureTurned)) scene = turned(scene);
    if (is_active(FaultKind::kPictureRandom)) scene = random_blocks();
    return scene;
  }
  /// Changes the bytes of the picture with this capture time, in the layout of picture_layout().
  template <class IsActive>
  void change_bytes(std::span<std::uint8_t> bytes, Instant capture_time, IsActive is_active) {
    if (!former_.empty()) remember(bytes, capture_time);
    if (is_active(FaultKind::kPictureTorn)) tear(bytes, capture_time);
    repeat(bytes, is_active(FaultKind::kPictureHalfFrozen), half_frozen_, Part::kLowerHalf);
    repeat(bytes, is_active(FaultKind::kPictureFrozen), frozen_, Part::kAll);
  }

  /// Age of the lower half of a torn picture.
  static constexpr Duration kTornAge = std::chrono::milliseconds(500);

 private:
  enum class Part : std::uint8_t { kAll, kLowerHalf };
  struct Picture {
    Instant capture_time{};
    std::vector<std::uint8_t> bytes;
  };
  // Picture that is repeated while the fault is active.
  struct Repeated {
    bool holds = false;
    std::vector<std::uint8_t> bytes;
  };

  std::span<const std::uint16_t> turned(std::span<const std::uint16_t> scene);
  std::span<const std::uint16_t> random_blocks();
  void remember(std::span<const std::uint8_t> bytes, Instant capture_time);
  void tear(std::span<std::uint8_t> bytes, Instant capture_time);
  void repeat(std::span<std::uint8_t> bytes, bool is_active, Repeated& repeated, Part part);
  // Copies all rows, or the lower half of the rows of each plane.
  void copy_part(std::span<const std::uint8_t> from, std::span<std::uint8_t> to, Part part) const;

  PixelFormat format_;
  std::size_t width_ = 0, height_ = 0;
  double rate_hz_ = 0.0;
  PictureLayout layout_;
  Random random_;
  std::vector<std::uint16_t> scene_;  // R, G, B of each pixel
  std::vector<Picture> former_;       // ring of the pictures of the last kTornAge
  std::size_t next_former_ = 0;
  Repeated frozen_, half_frozen_;
};

}  // namespace touchline::hal::mock
