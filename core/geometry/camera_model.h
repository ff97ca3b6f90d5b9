#pragma once

#include <array>
#include <span>

#include "core/geometry/brown_distortion.h"
#include "core/parameter.h"
#include "core/types.h"

namespace touchline {

enum class CameraModelKind : std::uint8_t { kFull, kPaper };

/// Pinhole, radial and tangential distortion, pose.
struct FullModelParameters {
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  float k1 = 0, k2 = 0, k3 = 0, p1 = 0, p2 = 0;  // Brown 1971, on normalized coordinates
  std::array<float, 3> rotation_rad{};           // rotation vector, field frame -> camera frame (z forward, y down)
  std::array<float, 3> position_m{};             // camera in the field frame

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(self.fx_px, {.name = "fx_px", .range = {0.0, 1e5}, .unit = "px", .help = "Focal length along rows"});
    visit.number(self.fy_px,
                 {.name = "fy_px", .range = {0.0, 1e5}, .unit = "px", .help = "Focal length along columns"});
    visit.number(self.cx_px, {.name = "cx_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Principal point, column"});
    visit.number(self.cy_px, {.name = "cy_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Principal point, row"});
    visit.number(self.k1, {.name = "k1", .range = {-10.0, 10.0}, .help = "Radial distortion, second order"});
    visit.number(self.k2, {.name = "k2", .range = {-100.0, 100.0}, .help = "Radial distortion, fourth order"});
    visit.number(self.k3, {.name = "k3", .range = {-1000.0, 1000.0}, .help = "Radial distortion, sixth order"});
    visit.number(self.p1, {.name = "p1", .range = {-1.0, 1.0}, .help = "Tangential distortion, vertical"});
    visit.number(self.p2, {.name = "p2", .range = {-1.0, 1.0}, .help = "Tangential distortion, horizontal"});
    visit.numbers(self.rotation_rad,
                  {.name = "rotation_rad",
                   .range = {-7.0, 7.0},
                   .unit = "rad",
                   .help = "Rotation vector from the field frame to the camera frame (z forward, y down)"});
    visit.numbers(self.position_m, {.name = "position_m",
                                    .range = {-100.0, 100.0},
                                    .unit = "m",
                                    .help = "Position of the camera in the field frame"});
  }
};

/// Klancar eq. (12)-(15) and the affine map that remains after them.
struct PaperModelParameters {
  float center_u_px = 0, center_v_px = 0;
  float focal_px = 0;                 // H of eq. (12)
  float p_per_px = 0, q_per_px = 0;   // eq. (14)
  std::array<float, 6> affine{};      // floor: x_m = a0 x + a1 y + a2, y_m = a3 x + a4 y + a5
  std::array<float, 3> position_m{};  // camera in the field frame; its height is needed for objects above the floor

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.number(
        self.center_u_px,
        {.name = "center_u_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Center of the distortion, column"});
    visit.number(self.center_v_px,
                 {.name = "center_v_px", .range = {-1e4, 1e4}, .unit = "px", .help = "Center of the distortion, row"});
    visit.number(
        self.focal_px,
        {.name = "focal_px", .range = {0.0, 1e6}, .unit = "px", .help = "Focal length: H of Klancar eq. (12)"});
    visit.number(self.p_per_px,
                 {.name = "p_per_px", .range = {-1.0, 1.0}, .unit = "1/px", .help = "Tilt: p of Klancar eq. (14)"});
    visit.number(self.q_per_px,
                 {.name = "q_per_px", .range = {-1.0, 1.0}, .unit = "1/px", .help = "Tilt: q of Klancar eq. (14)"});
    visit.numbers(
        self.affine,
        {.name = "affine",
         .range = {-100.0, 100.0},
         .help = "Rectified pixels (X, Y) to meters on the floor: x = a0 X + a1 Y + a2, y = a3 X + a4 Y + a5"});
    visit.numbers(self.position_m, {.name = "position_m",
                                    .range = {-100.0, 100.0},
                                    .unit = "m",
                                    .help = "Position of the camera in the field frame"});
  }
};

struct CameraParameters {
  CameraModelKind kind = CameraModelKind::kFull;
  FullModelParameters full;
  PaperModelParameters paper;

  static constexpr std::array<Choice<CameraModelKind>, 2> kKinds{
      {{"full", CameraModelKind::kFull}, {"paper", CameraModelKind::kPaper}}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.kind, kKinds, {.name = "kind", .help = "The camera model in use"});
    visit.section(
        self.full,
        {.name = "full", .help = "Pinhole camera with radial and tangential distortion (Brown 1971) and its pose"});
    visit.section(self.paper, {.name = "paper", .help = "The paper's model: Klancar eq. (12) to (15)"});
  }
};

/// A line of sight in the field frame.
struct Ray {
  std::array<float, 3> origin_m{}, direction{};  // direction: unit vector away from the camera
};

/// Transforms pixels to rays and points on a plane, and back. Only coordinates are transformed, never a picture.
///
/// The model computes in double. Only the floats of the interface cost accuracy: less than 0.002 mm on the field
/// (tests/geometry).
///
/// Every function returns finite values for finite arguments, because regions also appear outside the calibrated part
/// of the picture. A line of sight above the angle kMinDip hits the ground at this angle, far outside of any field. A
/// plane at or above the camera is replaced by one just below it. Beyond its limit the lens model continues along its
/// tangent. Results are limited to 1e9 m or px.
class CameraModel {
 public:
  // Tangent of the smallest angle below the horizon; it corresponds to a distance of 50 camera heights.
  static constexpr double kMinDip = 0.02;

  /// kOutOfRange: focal length or camera height not positive, or a value is not finite. kInconsistent: the affine map
  /// is singular. After an error the model is unchanged.
  Status configure(const CameraParameters& parameters);

  [[nodiscard]] Ray ray(PixelPoint pixel) const;
  /// Returns where the line of sight meets the plane z = height_m, which is below the camera.
  [[nodiscard]] FieldPoint to_field(PixelPoint pixel, float height_m) const;
  /// Inverse of to_field() below the horizon, accurate to 1e-3 px (rounding of pixels and field points to float).
  [[nodiscard]] PixelPoint to_pixel(FieldPoint point, float height_m) const;
  /// Square root of the area in pixels of one square meter at this place and height.
  [[nodiscard]] float scale_px_per_m(FieldPoint point, float height_m) const;

 private:
  using Point2 = std::array<double, 2>;
  using Point3 = std::array<double, 3>;

  Status configure(const FullModelParameters& p);
  Status configure(const PaperModelParameters& p);
  [[nodiscard]] Point3 direction(Point2 pixel) const;    // of any length, pointing below the horizon
  [[nodiscard]] Point2 project(Point3 point) const;      // field frame, below the camera
  [[nodiscard]] Point3 from_camera(Point3 way) const;    // field frame -> camera frame, full model
  [[nodiscard]] Point2 paper_floor(Point2 pixel) const;  // eq. (12)-(14) and the affine part
  [[nodiscard]] Point2 paper_pixel(Point2 floor) const;
  [[nodiscard]] double below_camera(float height_m) const;

  CameraModelKind kind_ = CameraModelKind::kFull;
  Point3 position_{0, 0, 1};
  // full
  Point2 focal_{1, 1}, principal_{};
  BrownDistortion distortion_;
  std::array<Point3, 3> rotation_{};  // rows; field -> camera
  // paper
  Point2 center_{};
  double h_ = 1, p_ = 0, q_ = 0;
  std::array<double, 6> affine_{};
  double determinant_ = 1;
};

}  // namespace touchline
