#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tools/programs/evaluate/picture_evaluation.h"
#include "tools/programs/evaluate/pose_evaluation.h"

namespace touchline::evaluate {

/// Tables for a person: millimeters, degrees, pixels, percent.
void print(const PoseReport& report, double seen_within_m, std::ostream& out);
void print(const std::vector<Spread>& spread, std::size_t frames, std::ostream& out);
void print(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance, std::ostream& out);

/// The same as JSON for programs: meters, radians, pixels, counts.
std::string to_json(const PoseReport& report, double seen_within_m);
std::string to_json(const std::vector<Spread>& spread, std::size_t frames);
std::string to_json(const std::vector<PictureReport>& pictures, const PictureTolerance& tolerance);

}  // namespace touchline::evaluate
