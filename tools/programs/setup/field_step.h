#pragma once

#include <optional>
#include <string>

#include "hal/result.h"
#include "tools/programs/calibrate/field/field_calibration.h"
#include "tools/programs/setup/job.h"

namespace touchline::setup {

/// A person's entries in the step "field".
struct FieldRequest {
  calibrate::FieldChoice choice;
  std::optional<calibrate::Corners> corners;  // empty: the border is searched
};

/// Finds the camera model in the frames and writes it to the venue file in the job's folder. Errors of choose_field()
/// and calibrate_field().
Result<void> find_field(const FieldRequest& request, const JobInput& input, const JobOutput& output);

}  // namespace touchline::setup
