#pragma once

#include <memory>
#include <vector>

#include "tests/marker/painted_field.h"

namespace touchline::testing {

/// Synthetic regions without pixels: centroid, area and color with any accuracy. They are only for tests of the
/// matcher.
class RegionList {
 public:
  RegionList(const CameraParameters& camera, const MarkerParameters& parameters);

  void clear() { regions_->clear(); }
  /// Adds a region at this point of the plane, with `ratio` times the area of the patch at this position.
  void add(FieldPoint at, ColorId color, const PatchPlace& patch, float height_m, float ratio = 1.0f);
  /// Adds all patches of a robot, each center moved by up to `error_m` along both axes.
  void add(const Placed& robot, PortableRandom& random, float error_m);

  const Sightings& match();
  [[nodiscard]] const Regions& regions() const { return *regions_; }
  [[nodiscard]] const CameraModel& camera() const { return camera_; }

 private:
  MarkerParameters parameters_;
  CameraModel camera_;
  std::unique_ptr<Matcher> matcher_;
  std::unique_ptr<Runs> runs_;
  std::unique_ptr<Regions> regions_;
  std::unique_ptr<Sightings> sightings_;
};

}  // namespace touchline::testing
