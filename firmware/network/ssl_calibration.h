#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/camera_model.h"
#include "core/geometry/field_area.h"
#include "core/status.h"

namespace touchline::network {

/// The camera model of SSL-Vision: a point p of the field in mm is R(q) p + t in the camera frame (z forward, y down).
/// With (x, y) = (X/Z, Y/Z) of this point and r = |(x, y)|, the pixel is principal_point + focal_length (x, y) s / r,
/// where r = s (1 + distortion s^2). The model has a single focal length, no tangential distortion, and no distortion
/// that bends outwards.
struct SslCalibration {
  double focal_length_px = 0.0;
  std::array<double, 2> principal_point_px{};
  double distortion = 0.0;
  std::array<double, 4> q{};  // x, y, z, w
  std::array<double, 3> t_mm{};
  std::array<double, 3> position_mm{};  // position of the camera in the field frame
  // Distance between the points on the field that both models give for a pixel, over the visible part of the field.
  double rms_mm = 0.0, max_mm = 0.0;
};

/// Finds the SSL-Vision model whose field points are nearest to those of our model, in the least-squares sense, on the
/// floor and at `robot_height_m`. Errors as for CameraModel::configure(); kInconsistent: the camera sees too little of
/// the field. Takes milliseconds.
Status fit_ssl_calibration(const CameraParameters& camera, const FieldParameters& field, std::uint16_t width_px,
                           std::uint16_t height_px, float robot_height_m, SslCalibration& out);

/// Returns the point on the plane z = height_m that a receiver computes for a pixel, in m.
FieldPoint to_field(const SslCalibration& calibration, PixelPoint pixel, float height_m);

}  // namespace touchline::network
