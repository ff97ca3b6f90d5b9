#pragma once

#include <memory>
#include <string>

#include "firmware/config/configuration.h"
#include "hal/result.h"
#include "tools/programs/radio/motion_pattern.h"
#include "tools/programs/setup/job.h"

namespace touchline::setup {

/// Reads the files of the draft in `folder`. Errors of config::load().
Result<std::shared_ptr<const config::Configuration>> load_draft(const SetupFiles& files, const std::string& folder);

struct PatternRequest {
  RobotId robot = 0;
  radio::Pattern pattern = radio::Pattern::kForward;
  double speed_mps = radio::kPatternSpeed_mps, duration_s = radio::kPatternDuration_s;
};
/// A job that rolls the wheels of one robot and shows its bytes; `result` has the last ones. The draft does not change.
Job pattern_job(const PatternRequest& request, std::shared_ptr<const config::Configuration> files);

/// A job that drives one robot under the camera and measures its drive, into state.measured["radio"]["drive"].
Job measuring_job(RobotId robot, std::shared_ptr<const config::Configuration> files);

}  // namespace touchline::setup
