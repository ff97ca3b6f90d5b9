#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/mock/renderer.h"
#include "hal/mock/world.h"

// Scenes of the mock arena: object poses for pictures with known truth.
namespace touchline::arena {

enum class SceneKind : std::uint8_t { kEmpty, kGrey, kSamples, kLayouts, kStatic, kTouching, kMatch };

struct SceneType {
  std::string_view name;
  SceneKind kind;
  unsigned pictures;  // default number of frames
  std::string_view help;
};
const std::vector<SceneType>& scene_types();
/// Returns null if there is no such scene.
const SceneType* find_scene(std::string_view name);

/// Poses of all objects during one exposure.
struct SceneFrame {
  hal::mock::Snapshot begin, end;
  double t_s = 0.0;
  bool objects = true;  // false: only the field or paper is visible
};

/// Makes at least one frame, `count` frames, of a scene. Returns none if the field has no room for all objects. Poses
/// are random and depend on `seed`; robots never overlap each other, the ball or the walls.
std::vector<SceneFrame> make_scene(SceneKind kind, const hal::mock::ArenaParameters& parameters, double rate_hz,
                                   unsigned count, std::uint64_t seed);

}  // namespace touchline::arena
