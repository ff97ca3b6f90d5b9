#pragma once

#include <cstdint>
#include <optional>

#include "hal/clock.h"
#include "hal/mock/arena_parameters.h"
#include "hal/radio.h"

namespace touchline::devices {

/// Moves the only robot of the arena back and forth, as a hand moves a lid in front of a camera.
class ArenaHand {
 public:
  /// `radio` must be open.
  ArenaHand(hal::Radio& radio, const hal::Clock& clock, const hal::mock::ArenaField& field);

  /// Replaces the teams by one large square robot (the lid) in a corner, which faces along the diagonal of the field.
  /// It therefore moves horizontally and vertically at once.
  static void put_lid(hal::mock::ArenaParameters& arena);

  /// Sends the wheel speeds for the present time. The motion begins with the first call.
  void move();

 private:
  hal::Radio& radio_;
  const hal::Clock& clock_;
  double way_to_middle_m_;
  std::optional<Instant> begin_;
  bool forward_ = true;
  double stroke_s_ = 0.4, next_turn_s_ = 0.2;
  std::uint8_t sequence_ = 0;
};

}  // namespace touchline::devices
