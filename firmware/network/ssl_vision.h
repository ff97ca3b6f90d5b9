#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/status.h"
#include "firmware/network/messages.h"
#include "firmware/network/ssl_calibration.h"

namespace touchline::network {

/// Venue and robots as the encoders describe them.
struct VenueGeometry {
  FieldParameters field;
  CameraParameters camera;
  std::uint16_t width_px = 0, height_px = 0;  // size of the picture; 0: a source of poses
  float ball_radius_m = 0.0f;
  std::array<float, 2> robot_height_m{};  // height by Team
};

/// Encodes SSL-Vision's SSL_WrapperPacket (docs/network.md): millimeters, radians, pixels.
class SslVisionEncoder {
 public:
  /// Sets the geometry. Errors of CameraModel::configure().
  Status configure(const VenueGeometry& geometry);

  /// Writes a packet with the frame's detections. Returns its bytes; 0 if `out` is too small.
  std::size_t encode_detection(const OutputFrame& frame, std::span<std::byte> out) const;
  /// Writes a packet with field and calibration.
  std::size_t encode_geometry(std::uint32_t camera_id, std::span<std::byte> out) const;

  /// Returns nullopt if the camera sees too little of the field. Then the geometry has no calibration.
  [[nodiscard]] const std::optional<SslCalibration>& calibration() const { return calibration_; }

 private:
  VenueGeometry geometry_;
  std::optional<SslCalibration> calibration_;
};

}  // namespace touchline::network
