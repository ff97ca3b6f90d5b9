#pragma once

#include <string>

#include "tools/programs/calibrate/field/field_report.h"

// Finds which lines of a drawing a field really has: fields in halls differ from the rules of a league.
namespace touchline::calibrate {

/// Whether most points of the mark were found, at the place of the drawing or beside it.
bool is_seen(const MarkReport& mark);

/// Returns the field with only those optional lines (center circle, penalty areas) that the pictures show. A line stays
/// as it is if the drawing does not have it or if the pictures do not show its place. Without refinement all lines
/// stay.
FieldParameters painted_field(const FieldParameters& field, const FieldReport& report);

/// Names the lines that painted_field() leaves out: "the field has no penalty areas"; "" if it has all.
std::string describe_unpainted(const FieldParameters& field, const FieldReport& report);

}  // namespace touchline::calibrate
