#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/vector2.h"
#include "core/types.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/random.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// Sees robots and ball as one side's camera and recognition do, without a picture: with noise, biases that last while
/// a robot stands, misses, and a ball that robots hide. The sightings are in the side's own coordinates: its robots are
/// Team::kOwn and attack towards positive x, so the opponent's side sees the field turned by 180 degrees. Nothing is
/// allocated after construction.
class Observer {
 public:
  Observer(const ArenaParameters& parameters, Side side, std::uint64_t seed);

  /// Writes what the side recognizes of the world at one instant. `hidden`: bit i is set if robot i is invisible.
  void observe(const World& world, Sightings& out, std::uint32_t hidden = 0);

 private:
  struct Bias {
    Vector2 at;          // position at the last sighting
    double theta = 0.0;  // heading at the last sighting
    Vector2 position_m;
    double heading_rad = 0.0;
    bool begun = false;
  };
  void drift(Bias& bias, const Placement& seen, double position_sigma_m, double heading_sigma_rad);
  [[nodiscard]] bool is_ball_hidden(const Snapshot& all, std::uint32_t hidden) const;
  [[nodiscard]] Pose in_own_coordinates(Vector2 position, double theta) const;
  void observe_robot(const World& world, std::size_t robot, const Placement& truth, bool is_hidden, Sightings& out);
  void observe_ball(const Snapshot& all, std::uint32_t hidden, Sightings& out);

  const ViewParameters parameters_;
  const Side side_;
  const double robot_half_side_m_, robot_height_m_, ball_radius_m_;
  const std::array<double, 3> camera_m_;
  Random random_;
  std::array<Bias, kMaxRobots> robots_{};
  Bias ball_;
};

}  // namespace touchline::hal::mock
