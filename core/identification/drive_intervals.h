#pragma once

#include <array>

#include "core/identification/drive_record.h"
#include "core/identification/wheel_response.h"
#include "core/identification/wheel_wiring.h"

namespace touchline {

/// Motion between two sightings, and what the wheels drove meanwhile according to a model.
struct DriveInterval {
  // The commands that acted during the interval are known, and the interval is short enough for the model.
  bool is_usable = false;
  bool continues = false;  // the interval begins where the former usable one ended
  double dt_s = 0.0;
  double forward_m = 0.0, turn_rad = 0.0;  // seen: along the mean heading, and counter-clockwise
  std::array<WheelTravel, 2> wheels{};     // of the wheels on the robot's left and right, for a gain of 1
  // If the commands that change within the interval act a time t later, each wheel's travel in the interval changes by
  // late_travel * t, and its speed at the end by late_speed * t.
  std::array<double, 2> late_travel_mps{}, late_speed_mps2{};
};

/// Reads a record from its oldest sighting to the one that is the newest at construction. Sightings and commands may
/// be added between two calls.
class DriveIntervals {
 public:
  DriveIntervals() = default;
  /// `response`: of the wheels on the robot's left and right.
  DriveIntervals(const DriveRecord& record, double delay_s, const std::array<WheelResponseParameters, 2>& response,
                 const WheelWiring& wiring);
  /// Returns false at the end.
  bool next(const DriveRecord& record, DriveInterval& out);

 private:
  [[nodiscard]] Duration settling_time() const;
  void begin(const DriveRecord& record, Instant instant);
  void advance_to(const DriveRecord& record, Instant instant, DriveInterval& out);
  void advance(Duration dt, const WheelSpeeds& command, DriveInterval& out);

  Duration delay_{};
  std::array<WheelResponseParameters, 2> response_;
  WheelWiring wiring_;
  std::uint64_t sighting_ = 0, end_ = 0, command_ = 0;
  std::array<WheelResponse, 2> wheels_;
  Instant now_{}, settled_{};
  bool has_begun_ = false, was_usable_ = false;
};

}  // namespace touchline
