#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "hal/mock/arena_parameters.h"
#include "hal/mock/lens.h"
#include "tools/programs/arena/scenes.h"

namespace touchline::arena {

// What is written beside the pictures; formats in docs/arena.md.

/// truth.jsonl: one line a picture, as touchline-evaluate reads it.
std::string truth_line(const Moment& moment, const std::string& file, const hal::mock::ArenaParameters& parameters,
                       const hal::mock::Lens& lens);

/// clicks.json: the middle of every patch and ball, as touchline-calibrate colors reads it.
std::string clicks(const std::vector<Moment>& moments, const std::vector<std::string>& files,
                   const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

/// scene.json: sizes of field and things, and the pixels of points that a person could click on the field.
std::string scene_description(const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

/// field-points.txt: the same points, "x,y,u,v" a line as touchline-calibrate field takes them, to half a pixel.
std::string field_points(const hal::mock::ArenaParameters& parameters, const hal::mock::Lens& lens);

}  // namespace touchline::arena
