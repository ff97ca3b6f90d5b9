#pragma once

#include "core/control/strategy.h"

namespace touchline::hal::mock {

/// No robot moves.
class Stand final : public Strategy {
 public:
  virtual ~Stand() = default;

  void configure(const ControlParameters& /*parameters*/, const FieldParameters& /*field*/) override {}
  void reset() override {}
  void decide(const Tracks& /*tracks*/, const Players& /*players*/, Twists& wanted) override { wanted = {}; }
  [[nodiscard]] PlayRole role_of(RobotId /*id*/) const override { return PlayRole::kNone; }
};

}  // namespace touchline::hal::mock
