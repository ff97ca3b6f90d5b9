#pragma once

#include <memory>
#include <numbers>
#include <vector>

#include "core/marker/matcher.h"
#include "core/region/labeling.h"
#include "tests/marker/portable_random.h"
#include "tests/region/literal_labeling.h"

// Paints robots and ball into a picture of colors, as a camera sees them, and runs the matcher on it.
namespace touchline::testing {

inline constexpr float kPi = std::numbers::pi_v<float>;

enum TestColor : ColorId {
  kBlue = 1,
  kYellow,
  kOrange,
  kRed,
  kGreen,
  kMagenta,
  kCyan,
  kViolet,
  kPink,
  kLime,
  kBrown,
  kGrey,
  kWhite
};

/// Returns a camera of 640 x 480 pixels, 2 m above the middle of a field of 2.2 x 1.8 m: 250 px per meter on the floor.
CameraParameters straight_camera();
/// Returns a camera for the same picture from 2.3 m, beside the middle, tilted by 8 degrees, with a lens that bends
/// edges by 20 px.
CameraParameters tilted_camera();

/// Returns five robots per team in the paper's layout: blue with red, green, magenta, cyan, violet; yellow with pink,
/// lime, brown, gray, white; the ball is orange. Ids are 0 to 4.
MarkerParameters paper_teams();

/// A robot of MarkerParameters with a pose.
struct Placed {
  Team team = Team::kOwn;
  std::size_t robot = 0;  // index in TeamMarking::robots
  Pose pose;
};

/// Returns true if the point (in the robot's frame) is on the patch.
bool covers(const PatchPlace& place, FieldPoint point);

/// Transforms a point of the robot's frame to the field.
FieldPoint on_field(const Pose& pose, float x_m, float y_m);

/// Returns true if the two squares overlap.
bool overlap(const Pose& a, const Pose& b, float side_m);

/// Returns robots 0 to `robots` - 1 of every team with a color, their centers anywhere in the rectangle around the
/// field's center, without overlap. They may cover at most a third of the rectangle.
std::vector<Placed> scattered(PortableRandom& random, const MarkerParameters& parameters, std::size_t robots,
                              float length_m, float width_m);

class PaintedField {
 public:
  PaintedField(const CameraParameters& camera, const MarkerParameters& parameters);

  void clear();
  void paint(const Placed& robot);
  void paint(const std::vector<Placed>& robots);
  /// Paints one of its patches in any color; kBackground hides it.
  void paint_patch(const Placed& robot, std::size_t patch, ColorId color);
  /// Paints a rectangle of the robot's top (its frame, [left, right) x [bottom, top)) in a color.
  void paint_part(const Placed& robot, FieldPoint low, FieldPoint high, ColorId color);
  void paint_ball(FieldPoint at);
  ColorGrid& grid() { return grid_; }
  /// Returns the number of the picture's pixels with a color.
  [[nodiscard]] std::ptrdiff_t pixels_of(ColorId color) const;

  /// Labels and matches the picture. With a frame, ids and ball also follow from its pixels, the typical colors, the
  /// known light, and the position at which the ball is expected.
  const Sightings& match(const Frame* frame = nullptr, const ExpectedGain& light = {}, const ExpectedBall& ball = {});
  /// Sets whether an overload cut the regions of the next pictures.
  void set_cut(bool is_cut) { is_cut_ = is_cut; }
  void set_typical_colors(const TypicalColors& typical) { matcher_->set_typical_colors(typical); }

  [[nodiscard]] const Regions& regions() const { return *regions_; }
  /// Returns the verdict of the region at this pixel of the last picture. The pixel must not be background.
  [[nodiscard]] Verdict verdict_at(PixelPoint pixel) const;
  [[nodiscard]] Verdict verdict_at(FieldPoint point, float height_m) const {
    return verdict_at(camera_.to_pixel(point, height_m));
  }
  [[nodiscard]] const CameraModel& camera() const { return camera_; }
  [[nodiscard]] const TeamMarking& marking(Team team) const {
    return parameters_.teams[static_cast<std::size_t>(team)];
  }

 private:
  static std::array<FieldPoint, 4> corners_of(const Pose& pose, FieldPoint low, FieldPoint high);
  // Calls a function for pixels within the corners whose point on the plane is inside.
  template <class Inside>
  void fill(const std::array<FieldPoint, 4>& corners, float height_m, ColorId color, Inside inside);

  MarkerParameters parameters_;
  CameraModel camera_;
  ColorGrid grid_;
  bool is_cut_ = false;
  std::unique_ptr<Labeling> labeling_;
  std::unique_ptr<Matcher> matcher_;
  std::unique_ptr<Runs> runs_;
  std::unique_ptr<Regions> regions_;
  std::unique_ptr<Sightings> sightings_;
};

/// Compares reported with painted robots. A reported robot is matched with the nearest painted one within `near_m`.
struct Comparison {
  std::size_t right = 0;    // number with the right team and id
  std::size_t unknown = 0;  // number with the right team, but no id
  std::size_t wrong = 0;    // number with another robot's id or team
  std::size_t ghosts = 0;   // number reported where no robot is
  std::size_t missed = 0;
  float position_m = 0, heading_rad = 0;  // largest errors of robots with a heading
};
Comparison compare(const std::vector<Placed>& placed, const Sightings& seen, const MarkerParameters& parameters,
                   float near_m = 0.035f);

}  // namespace touchline::testing
