#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/lens.h"
#include "tools/programs/arena/scenes.h"

namespace touchline::arena {

// Contents of the files that touchline-arena writes beside the pictures. Formats: docs/arena.md.

/// Returns a line of truth.jsonl for one picture, in the format of touchline-evaluate.
std::string truth_line(const SceneFrame& frame, const std::string& file, const hal::mock::ArenaParameters& parameters,
                       const hal::mock::Lens& lens);

/// Returns clicks.json: the center of every patch and ball, in the format of touchline-calibrate colors.
std::string clicks(const std::vector<SceneFrame>& frames, const std::vector<std::string>& files,
                   const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

/// Returns scene.json: sizes of field and objects, and the pixels of points that a person can click on the field.
std::string scene_description(const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

/// Returns field-points.txt: the same points as lines "x,y,u,v" for touchline-calibrate field, rounded to half a pixel.
std::string field_points(const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

}  // namespace touchline::arena
