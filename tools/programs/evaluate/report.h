#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tools/programs/evaluate/picture_evaluation.h"
#include "tools/programs/evaluate/pose_evaluation.h"

namespace touchline::evaluate {

/// Prints tables in millimeters, degrees, pixels and percent.
void print(const PoseReport& report, double seen_within_m, std::ostream& out);
void print(const std::vector<PoseSpread>& spread, std::size_t frames, std::ostream& out);
void print(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance, std::ostream& out);

/// Returns the same numbers as JSON, in meters, radians, pixels and counts.
std::string to_json(const PoseReport& report, double seen_within_m);
std::string to_json(const std::vector<PoseSpread>& spread, std::size_t frames);
std::string to_json(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance);

}  // namespace touchline::evaluate
