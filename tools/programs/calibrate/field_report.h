#pragma once

#include <optional>
#include <string>

#include "core/status.h"
#include "tools/programs/calibrate/border_search.h"
#include "tools/programs/calibrate/field_drawing.h"
#include "tools/programs/calibrate/field_refinement.h"
#include "tools/programs/calibrate/paper_steps.h"

namespace touchline::calibrate {

enum class HeightSource : std::uint8_t { kSeen, kMeasured, kRules };

/// All that `touchline-calibrate field` found, for a person and for a file.
struct FieldReport {
  std::optional<BorderSearch> border;  // none: corners or points were given
  std::optional<PaperSteps> steps;
  ResidualSummary steps_mm;  // of the paper's model as its steps give it, at the points found
  FieldFit fit;
  std::size_t points_given = 0;
  RefinementReport refinement;  // points 0: not refined
  std::string unrefined;        // why not
  std::vector<Mark> marks;
  HeightSource height = HeightSource::kSeen;
  double seconds = 0;
};

/// The residual of the model in use: one line.
std::string residual_text(const FieldReport& report);
/// For a terminal, each line ended.
std::string text_of(const FieldReport& report);
/// The same as JSON, lengths and units in the keys. kIo, kPermission: the file; `reason` says.
Status write_json(const FieldReport& report, const std::string& path, std::string& reason);

}  // namespace touchline::calibrate
