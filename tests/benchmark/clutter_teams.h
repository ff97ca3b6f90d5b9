#pragma once

#include "core/pipeline.h"

namespace touchline::testing {

/// The teams that look for robots in clutter: those of the mock board, or two of eleven robots with six patches each.
enum class ClutterTeams { kMock, kLargest };

/// Returns two teams of eleven robots in the colors of `mock`. Each robot has six patches of 18 mm in two columns.
TeamMarkings largest_teams(const TeamMarkings& mock);

}  // namespace touchline::testing
