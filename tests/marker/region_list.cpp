#include "tests/marker/region_list.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchline::testing {

RegionList::RegionList(const CameraParameters& camera, const MarkerParameters& parameters)
    : parameters_(parameters),
      matcher_(std::make_unique<Matcher>()),
      runs_(std::make_unique<Runs>()),
      regions_(std::make_unique<Regions>()),
      sightings_(std::make_unique<Sightings>()) {
  EXPECT_TRUE(camera_.configure(camera).ok());
  EXPECT_TRUE(matcher_->configure(parameters, camera_).ok());
}

void RegionList::add(FieldPoint at, ColorId color, const PatchPlace& patch, float height_m, float ratio) {
  Region region;
  region.color = color;
  region.centroid = camera_.to_pixel(at, height_m);
  const float scale = camera_.scale_px_per_m(at, height_m);
  region.area_px = static_cast<std::uint32_t>(std::lround(ratio * area_m2(patch) * scale * scale));
  const float half = 0.5f * std::sqrt(static_cast<float>(region.area_px));
  const auto bound = [](float value) { return static_cast<std::uint16_t>(std::lround(std::max(0.0f, value))); };
  region.box = {bound(region.centroid.u_px - half), bound(region.centroid.v_px - half),
                bound(region.centroid.u_px + half), bound(region.centroid.v_px + half)};
  ASSERT_TRUE(regions_->push_back(region));
}

void RegionList::add(const Placed& robot, PortableRandom& random, float error_m) {
  const TeamMarking& team = parameters_.teams[static_cast<std::size_t>(robot.team)];
  for (std::size_t p = 0; p < team.layout.patches.size(); ++p) {
    const PatchPlace& place = team.layout.patches[p];
    const FieldPoint at =
        on_field(robot.pose, place.x_m + random.real(-error_m, error_m), place.y_m + random.real(-error_m, error_m));
    const ColorId color = p == 0 ? team.team_color : team.robots[robot.robot].colors[p - 1];
    add(at, color, place, team.layout.height_m);
  }
}

const Sightings& RegionList::match() {
  matcher_->match(*runs_, *regions_, *sightings_);
  return *sightings_;
}

}  // namespace touchline::testing
