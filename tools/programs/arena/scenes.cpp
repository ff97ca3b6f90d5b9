#include "tools/programs/arena/scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::arena {
namespace {

using hal::mock::ArenaParameters;
using hal::mock::Placement;
using hal::mock::Random;
using hal::mock::Side;
using hal::mock::Snapshot;
using hal::mock::World;

constexpr std::uint64_t kSceneStream = 10;
// Largest gap between the robots of a pair in meters, and largest shift along their sides in robot sides.
constexpr double kPairGap = 0.001, kPairShift = 0.4;

class Placer {
 public:
  Placer(const ArenaParameters& parameters, std::uint64_t seed)
      : parameters_(parameters), random_(seed, kSceneStream) {}

  /// Returns false if at least one object found no room.
  [[nodiscard]] bool found_room() const { return found_room_; }

  Snapshot scattered() {
    Snapshot all;
    for (std::size_t i = 0; i < parameters_.robot.size(); ++i) all.robots.push_back(free_placement(all, robot_reach()));
    all.ball = free_placement(all, parameters_.ball_radius_m);
    return all;
  }

  // Places the robots in touching pairs, rotated by multiples of 90 degrees, so that all sides meet.
  Snapshot in_pairs() {
    Snapshot all;
    const double side = parameters_.robot_side_m;
    for (std::size_t i = 0; i < parameters_.robot.size(); i += 2) {
      const Placement first = free_placement(all, robot_reach() + std::hypot(side + kPairGap, kPairShift * side));
      all.robots.push_back(first);
      if (i + 1 == parameters_.robot.size()) break;
      const double way = first.theta_rad + quarter_turn();
      const double gap = side + random_.uniform(0.0, kPairGap);
      const double shift = random_.uniform(-kPairShift, kPairShift) * side;
      all.robots.push_back({first.x_m + gap * std::cos(way) - shift * std::sin(way),
                            first.y_m + gap * std::sin(way) + shift * std::cos(way), first.theta_rad + quarter_turn()});
    }
    all.ball = free_placement(all, parameters_.ball_radius_m);
    return all;
  }

 private:
  double quarter_turn() { return 0.5 * std::numbers::pi * static_cast<double>(random_.bits() % 4); }
  [[nodiscard]] double robot_reach() const { return parameters_.robot_side_m * std::numbers::sqrt2 / 2.0; }

  Placement free_placement(const Snapshot& taken, double reach_m) {
    const double gap = 0.004;
    Placement place;
    // If a thousand draws fail, the field counts as full.
    for (int draw = 0; draw < 1000; ++draw) {
      place = {random_.uniform(-0.5, 0.5) * (parameters_.field.length_m - 2.0 * reach_m),
               random_.uniform(-0.5, 0.5) * (parameters_.field.width_m - 2.0 * reach_m),
               random_.uniform(-std::numbers::pi, std::numbers::pi)};
      const double in_corner = 0.5 * (parameters_.field.length_m + parameters_.field.width_m) -
                               parameters_.field.corner_m - std::numbers::sqrt2 * reach_m;
      const bool free =
          std::abs(place.x_m) + std::abs(place.y_m) < in_corner &&
          std::none_of(taken.robots.begin(), taken.robots.end(), [&](const Placement& other) {
            return std::hypot(other.x_m - place.x_m, other.y_m - place.y_m) < reach_m + robot_reach() + gap;
          });
      if (free) return place;
    }
    found_room_ = false;
    return place;
  }

  const ArenaParameters& parameters_;
  Random random_;
  bool found_room_ = true;
};

// A game without strategy: own robots get random wheel speeds every half second; the opponents play.
std::vector<SceneFrame> play(const ArenaParameters& parameters, double rate_hz, unsigned count, std::uint64_t seed) {
  World world(parameters, seed);
  Random random(seed, kSceneStream);
  std::vector<SceneFrame> frames;
  const auto exposure = static_cast<std::uint64_t>(std::lround(parameters.sensor.exposure_s / World::kStepS));
  std::uint64_t steps = 0;
  double decide_s = 0.0;
  const auto step = [&] {
    const double t_s = static_cast<double>(steps) * World::kStepS;
    if (t_s >= decide_s) {
      decide_s += 0.5;
      for (const auto& robot : parameters.robot) {
        if (robot.team != Side::kOwn) continue;
        const double both = random.uniform(-0.6, 0.8), turn = random.uniform(-0.25, 0.25);
        world.drive(robot.id, both - turn, both + turn);
      }
    }
    world.step();
    ++steps;
  };
  for (unsigned i = 0; i < count; ++i) {
    const auto begin = static_cast<std::uint64_t>(std::ceil(static_cast<double>(i) / rate_hz / World::kStepS));
    while (steps < begin) step();
    SceneFrame frame;
    frame.begin = world.snapshot();
    const std::uint64_t since = steps;
    while (steps < since + exposure) step();
    frame.end = world.snapshot();
    frame.t_s = 0.5 * static_cast<double>(since + steps) * World::kStepS;
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace

const std::vector<SceneType>& scene_types() {
  static const std::vector<SceneType> all{
      {"empty", SceneKind::kEmpty, 1, "only the field"},
      {"grey", SceneKind::kGrey, 1, "the field covered with grey paper"},
      {"samples", SceneKind::kSamples, 4, "robots and ball at random places, with clicks to learn colors from"},
      {"layouts", SceneKind::kLayouts, 50, "robots and ball at random places"},
      {"static", SceneKind::kStatic, 50, "nothing moves; only the noise differs"},
      {"touching", SceneKind::kTouching, 20, "robots in pairs, side by side"},
      {"match", SceneKind::kMatch, 120, "a game, at the camera's rate"}};
  return all;
}

const SceneType* find_scene(std::string_view name) {
  const auto& all = scene_types();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SceneType& scene) { return scene.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<SceneFrame> make_scene(SceneKind kind, const ArenaParameters& parameters, double rate_hz, unsigned count,
                                   std::uint64_t seed) {
  if (kind == SceneKind::kMatch) return play(parameters, rate_hz, count, seed);
  Placer placer(parameters, seed);
  std::vector<SceneFrame> frames;
  for (unsigned i = 0; i < count; ++i) {
    SceneFrame frame;
    frame.t_s = static_cast<double>(i) / rate_hz;
    frame.objects = kind != SceneKind::kEmpty && kind != SceneKind::kGrey;
    if (kind == SceneKind::kStatic && i > 0) {
      frame.begin = frames[0].begin;
    } else if (frame.objects) {
      frame.begin = kind == SceneKind::kTouching ? placer.in_pairs() : placer.scattered();
    }
    frame.end = frame.begin;
    frames.push_back(frame);
  }
  if (!placer.found_room()) frames.clear();
  return frames;
}

}  // namespace touchline::arena
