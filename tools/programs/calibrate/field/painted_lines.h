#pragma once

#include <string>

#include "tools/programs/calibrate/field/field_report.h"

// Finds which lines of a drawing a field really has, because fields in halls deviate from the rules of a league.
namespace touchline::calibrate {

/// Returns whether most points of the mark were found, at its drawing or beside it.
bool is_seen(const MarkReport& mark);

/// Returns the field with only those optional lines (center circle, penalty areas) that are seen in the pictures. A
/// line is left unchanged if the drawing does not have it or if the pictures do not show its place. Without refinement,
/// all lines are kept.
FieldParameters painted_field(const FieldParameters& field, const FieldReport& report);

/// Names the lines that painted_field() removes: "the field has no penalty areas"; "" if it removes none.
std::string describe_unpainted(const FieldParameters& field, const FieldReport& report);

}  // namespace touchline::calibrate
