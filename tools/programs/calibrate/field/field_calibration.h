#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/replay/picture.h"
#include "hal/result.h"
#include "tools/programs/calibrate/field/field_report.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

// Turns pictures of the field into the sections of the venue file, for touchline-calibrate field and touchline-setup.
namespace touchline::calibrate {

/// Used in place of a drawing's path: only the border is used, whatever is painted inside it.
inline constexpr std::string_view kNoDrawing = "none";

/// A person's entries about the field.
struct FieldChoice {
  std::string preset, drawing;       // name of a preset, or path of a drawing (or kNoDrawing); at most one of them
  double length_m = 0, width_m = 0;  // 0: taken from the preset, drawing or venue file
  double camera_height_m = 0;        // height of the lens above the floor; 0: not measured
};

/// The field to look for.
struct ChosenField {
  FieldDrawing drawing;
  std::optional<HeightPrior> height;  // prior of the camera's height: measured, or else from the rules
  std::optional<HeightPrior> rules;   // prior from the league's rules
  HeightSource height_source = HeightSource::kSeen;
};

/// Combines the choice with the venue file. kNotFound: the preset is unknown. kInconsistent: the size is missing, or
/// both preset and drawing are given. Errors of read_drawing().
Result<ChosenField> choose_field(const VenueDraft& venue, const FieldChoice& choice);

struct FieldPictures {
  std::vector<hal::Picture> pictures;  // at least one, all of the same view; they are averaged
  std::vector<FloorPoint> points;      // known points, corners included; empty: the border is searched
  bool refine = true;                  // false: only the points are used
};

/// Finds the camera model from the border of the field or from known points. kInconsistent: pictures have different
/// sizes, or there are fewer than four points. kOutOfRange: the picture contradicts the given height (0: none) or the
/// drawing of the center line and circle, or a point lies outside the picture. Errors of find_border(), fit_field() and
/// refine_field(); the message also says what was found until then.
Result<FieldReport> calibrate_field(const FieldPictures& input, const ChosenField& field, double camera_height_m);

/// Returns [picture], [field] (see painted_field()) and [camera_model] of the venue file.
std::vector<Section> field_sections(const VenueDraft& venue, const hal::Picture& picture, const FieldParameters& field,
                                    const FieldReport& report);

/// Returns a warning if a region of interest was chosen for another view of the camera, and so excludes a part of the
/// field: the message says which part. Empty if it contains the whole field. A `region` with fewer than three corners
/// means the whole picture.
std::string region_warning(const Polygon& region, const hal::Picture& picture, const FieldParameters& field,
                           const CameraParameters& camera);

/// Draws the border and the markings over the picture, projected with the model found. kInconsistent: the model is
/// invalid.
Result<hal::Picture> draw_result(const hal::Picture& picture, const FieldParameters& field, const FieldReport& report);
/// Draws the residuals, enlarged. Needs report.refinement.points > 0. kInconsistent: the model is invalid.
Result<hal::Picture> draw_errors(const hal::Picture& picture, const FieldReport& report);

}  // namespace touchline::calibrate
