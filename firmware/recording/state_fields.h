#pragma once

#include "core/control/roles.h"
#include "core/control/strike.h"
#include "core/geometry/vector2.h"
#include "firmware/recording/step_fields.h"

// The values in Pipeline::visit_state() that no step has as an input or result. Include it where a pipeline's state is
// written or read.
namespace touchline::recording {

template <>
struct LastOf<Job> : LastIs<Job::kMark> {};

template <class Archive, Of<Vector2> Value>
void fields(Archive& archive, Value& value) {
  auto& [x, y] = value;
  archive(x, y);
}
template <class Archive, Of<SkillGoal> Value>
void fields(Archive& archive, Value& value) {
  auto& [place, direction, end_speed, avoid_ball, twist] = value;
  archive(place, direction, end_speed, avoid_ball, twist);
}
template <class Archive, Of<Strike> Value>
void fields(Archive& archive, Value& value) {
  auto& [goal, ball, direction, contact, cost] = value;
  archive(goal, ball, direction, contact, cost);
}

}  // namespace touchline::recording
