#include "core/identification/drive_record.h"

#include <cmath>

namespace touchline {

void DriveRecord::clear() {
  commands_.end = sightings_.end = 0;
  is_broken_ = false;
}

bool DriveRecord::add_command(Instant sent, const WheelSpeeds& wheels) {
  if (commands_.end > 0 && commands_.at(commands_.end - 1).sent >= sent) return false;
  if (!std::isfinite(wheels.left_mps) || !std::isfinite(wheels.right_mps)) return false;
  commands_.push({sent, wheels});
  return true;
}

bool DriveRecord::add_sighting(Instant captured, const Pose& pose) {
  if (sightings_.end > 0 && sightings_.at(sightings_.end - 1).captured >= captured) return false;
  if (!std::isfinite(pose.position.x_m) || !std::isfinite(pose.position.y_m) || !std::isfinite(pose.theta_rad)) {
    return false;
  }
  sightings_.push({captured, pose, is_broken_});
  is_broken_ = false;
  return true;
}

}  // namespace touchline
