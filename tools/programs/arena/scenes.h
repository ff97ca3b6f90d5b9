#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/mock/renderer.h"
#include "hal/mock/world.h"

// Scenes of the arena as pictures with truth: to calibrate from, to measure recognition with.
namespace touchline::arena {

enum class SceneKind : std::uint8_t { kEmpty, kGrey, kSamples, kLayouts, kStatic, kTouching, kMatch };

struct SceneWord {
  std::string_view word;
  SceneKind kind;
  unsigned pictures;  // unless the person says how many
  std::string_view help;
};
const std::vector<SceneWord>& scene_words();
/// Null: no such scene.
const SceneWord* find_scene(std::string_view word);

/// What is where during one exposure.
struct Moment {
  hal::mock::Snapshot begin, end;
  double t_s = 0.0;
  bool objects = true;  // false: field or paper alone
};

/// `count` moments of a scene, 1 or more; none when the field has no room for all. Placements are drawn from `seed`;
/// robots never overlap each other, the ball or the walls.
std::vector<Moment> make_scene(SceneKind kind, const hal::mock::ArenaParameters& parameters, double rate_hz,
                               unsigned count, std::uint64_t seed);

}  // namespace touchline::arena
