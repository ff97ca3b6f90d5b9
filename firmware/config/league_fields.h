#pragma once

#include <array>
#include <string_view>

#include "core/geometry/field_area.h"

namespace touchline::config {

/// The field of a league, with the name that `touchline-calibrate field --field-preset` accepts.
struct LeagueField {
  std::string_view name;
  FieldParameters field;
};

/// Fields according to the rules of FIRA MiroSot middle league, IEEE very small size, and RoboCup small size (divisions
/// A and B). The figures come from VSSSLeague/VSSReferee (src/utils/types/field/field_default_5v5.h and
/// field_default_3v3.h; its lines are drawn 6 mm wide, the rules say 3 mm) and from the default geometry of
/// RoboCup-SSL/ssl-game-controller. MiroSot's goal area, 0.15 m x 0.5 m, lies inside the penalty area; only the larger
/// one, the penalty area, is published.
inline constexpr std::array kLeagueFields{LeagueField{"mirosot-middle",
                                                      {.length_m = 2.2f,
                                                       .width_m = 1.8f,
                                                       .goal_width_m = 0.4f,
                                                       .goal_depth_m = 0.15f,
                                                       .line_width_m = 0.003f,
                                                       .center_circle_m = 0.25f,
                                                       .penalty_area_depth_m = 0.35f,
                                                       .penalty_area_width_m = 0.8f}},
                                          LeagueField{"vsss",
                                                      {.length_m = 1.5f,
                                                       .width_m = 1.3f,
                                                       .goal_width_m = 0.4f,
                                                       .goal_depth_m = 0.1f,
                                                       .line_width_m = 0.003f,
                                                       .center_circle_m = 0.2f,
                                                       .penalty_area_depth_m = 0.15f,
                                                       .penalty_area_width_m = 0.7f}},
                                          LeagueField{"ssl-a",
                                                      {.length_m = 12.0f,
                                                       .width_m = 9.0f,
                                                       .goal_width_m = 1.8f,
                                                       .goal_depth_m = 0.18f,
                                                       .line_width_m = 0.01f,
                                                       .center_circle_m = 0.5f,
                                                       .penalty_area_depth_m = 1.8f,
                                                       .penalty_area_width_m = 3.6f}},
                                          LeagueField{"ssl-b",
                                                      {.length_m = 9.0f,
                                                       .width_m = 6.0f,
                                                       .goal_width_m = 1.0f,
                                                       .goal_depth_m = 0.18f,
                                                       .line_width_m = 0.01f,
                                                       .center_circle_m = 0.5f,
                                                       .penalty_area_depth_m = 1.0f,
                                                       .penalty_area_width_m = 2.0f}}};

/// Returns a field by name; `name` must be in the table.
constexpr const FieldParameters& league_field(std::string_view name) {
  std::size_t i = 0;
  while (kLeagueFields.at(i).name != name) ++i;
  return kLeagueFields[i].field;
}

}  // namespace touchline::config
