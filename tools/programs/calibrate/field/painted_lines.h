#pragma once

#include <string>

#include "tools/programs/calibrate/field/field_report.h"

// Which lines of a drawing a field really has: halls differ from the rules of a league.
namespace touchline::calibrate {

/// Whether most points of the mark were found, at its place in the drawing or beside it.
bool is_seen(const MarkReport& mark);

/// The field with only those optional lines (center circle, penalty areas) that the pictures show. A line that the
/// drawing does not have, or of which nothing is in the picture, stays as it is; so do all without refinement.
FieldParameters painted_field(const FieldParameters& field, const FieldReport& report);

/// Names the lines that painted_field() leaves out: "the field has no penalty areas"; "" if it has all.
std::string describe_unpainted(const FieldParameters& field, const FieldReport& report);

}  // namespace touchline::calibrate
