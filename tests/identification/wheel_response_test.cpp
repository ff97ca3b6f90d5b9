#include "core/identification/wheel_response.h"

#include <gtest/gtest.h>

namespace touchline {
namespace {

struct CommandPart {
  double dt_s, command_mps;
};
constexpr std::array<CommandPart, 4> kCommands{{{0.1, 0.4}, {0.03, -0.2}, {0.05, 0.02}, {0.2, -0.4}}};

WheelTravel travel_with(const WheelResponseParameters& parameters, double delay_s = 0.0) {
  WheelResponse wheel;
  WheelTravel before, travel;
  // The last command is shortened by as much as the first one acts later.
  wheel.advance(0.05 + delay_s, 0.0, parameters, before);
  travel = {};
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    const double shorter = i + 1 == kCommands.size() ? delay_s : 0.0;
    wheel.advance(kCommands[i].dt_s - shorter, kCommands[i].command_mps, parameters, travel);
  }
  return travel;
}

TEST(WheelResponse, IsThatOfAFirstOrderLag) {
  WheelResponse wheel;
  WheelTravel travel;
  wheel.advance(0.08, 0.5, {0.08, 0.0}, travel);
  EXPECT_NEAR(wheel.speed_mps(), 0.5 * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(travel.distance_m, 0.5 * 0.08 * std::exp(-1.0), 1e-12);
}

TEST(WheelResponse, ADeadZoneMovesNothing) {
  WheelResponse wheel;
  WheelTravel travel;
  wheel.advance(1.0, 0.03, {0.02, 0.04}, travel);
  EXPECT_EQ(travel.distance_m, 0.0);
  wheel.advance(1.0, -0.1, {0.02, 0.04}, travel);
  EXPECT_NEAR(wheel.speed_mps(), -0.06, 1e-9);
}

TEST(WheelResponse, ItsDerivativesAreThoseOfTheDistance) {
  const WheelResponseParameters at{0.07, 0.03};
  const WheelTravel travel = travel_with(at);
  constexpr double kStep = 1e-6;
  const auto slope = [](const WheelTravel& high, const WheelTravel& low) {
    return (high.distance_m - low.distance_m) / (2.0 * kStep);
  };
  EXPECT_NEAR(travel.by_lag, slope(travel_with({0.07 + kStep, 0.03}), travel_with({0.07 - kStep, 0.03})), 1e-8);
  EXPECT_NEAR(travel.by_dead_zone, slope(travel_with({0.07, 0.03 + kStep}), travel_with({0.07, 0.03 - kStep})), 1e-8);
  EXPECT_NEAR(travel.by_delay, slope(travel_with(at, kStep), travel_with(at, -kStep)), 1e-8);
}

}  // namespace
}  // namespace touchline
