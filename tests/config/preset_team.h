#pragma once

#include <algorithm>
#include <string>

#include "firmware/config/radio_presets.h"
#include "firmware/config/team_file.h"

namespace touchline::config {

/// A team of as many robots as the packets of a preset have places and ids for, at most eleven, with addresses from 10
/// on. Robots whose source does not tell it have wheels of 3 cm and 1000 steps.
inline TeamFile team_of(const std::string& format) {
  TeamFile team;
  read_radio_preset(format, team.radio);
  team.radio.format = format;
  team.own.color = "blue";
  if (team.radio.wheel_radius_m == 0.0) team.radio.wheel_radius_m = 0.03;
  if (team.radio.steps_per_turn == 0.0) team.radio.steps_per_turn = 1000.0;
  const bool has_places = team.radio.places > 0 && team.radio.packet_for == PacketFor::kAll;
  int first_id = team.radio.first_id, robots = has_places ? team.radio.places : static_cast<int>(kMaxRobotsPerTeam);
  for (const FieldEntry& field : team.radio.field) {
    if (field.value != FieldValue::kId || field.low < 0.0) continue;
    first_id = std::max(first_id, static_cast<int>(field.low));
    robots = std::min(robots, static_cast<int>(std::min(field.high, 127.0)) - first_id + 1);
  }
  for (int i = 0; i < robots; ++i) {
    RobotEntry robot;
    robot.id = first_id + i;
    robot.address = std::to_string(10 + i);
    team.own.robot.push_back(robot);
  }
  return team;
}

}  // namespace touchline::config
