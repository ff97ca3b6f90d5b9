#pragma once

#include <array>
#include <cstdint>

#include "core/parameter.h"

namespace touchline::hal::mock {

/// Rules of the game. kSimple: the ball returns to the center after goals and jams. kMirosot: the restarts and fouls of
/// MiroSot and VSSS (LeagueRules).
enum class League : std::uint8_t { kSimple, kMirosot };
inline constexpr std::array<Choice<League>, 2> kLeagues{{{"simple", League::kSimple}, {"mirosot", League::kMirosot}}};

/// How robots reach their places before a restart.
enum class RobotsAtRestart : std::uint8_t { kPlaced, kDrive };
inline constexpr std::array<Choice<RobotsAtRestart>, 2> kRobotsAtRestart{
    {{"placed", RobotsAtRestart::kPlaced}, {"drive", RobotsAtRestart::kDrive}}};

struct RulesParameters {
  League league = League::kSimple;
  RobotsAtRestart robots = RobotsAtRestart::kPlaced;
  double half_s = 0.0;
  double line_up_s = 10.0;
  // Of the VSSS field.
  double goal_area_depth_m = 0.15, goal_area_width_m = 0.7;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.choice(self.league, kLeagues,
                 {.name = "league",
                  .help = "simple: the ball returns to the center after goals and jams; mirosot: restarts and fouls of "
                          "MiroSot and VSSS"});
    visit.choice(self.robots, kRobotsAtRestart,
                 {.name = "robots",
                  .help = "With league \"mirosot\": robots are placed for a restart, or drive to their places"});
    visit.number(self.half_s, {.name = "half_s",
                               .range = {0.0, 3600.0},
                               .unit = "s",
                               .help = "Time after which the teams exchange sides; 0: never"});
    visit.number(self.line_up_s, {.name = "line_up_s",
                                  .range = {0.5, 60.0},
                                  .unit = "s",
                                  .help = "Time after which robots that drive are placed if they are not allowed where "
                                          "they are"});
    visit.number(self.goal_area_depth_m, {.name = "goal_area_depth_m",
                                          .range = {0.0, 5.0},
                                          .unit = "m",
                                          .help = "Depth of the goal areas in front of the goal lines"});
    visit.number(self.goal_area_width_m,
                 {.name = "goal_area_width_m", .range = {0.0, 20.0}, .unit = "m", .help = "Width of the goal areas"});
  }
};

}  // namespace touchline::hal::mock
