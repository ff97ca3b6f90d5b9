#pragma once

#include <string>

#include "firmware/arena_objects.h"
#include "hal/linux/network/descriptor.h"
#include "hal/result.h"

namespace touchline::arena {

/// Takes the requests of docs/arena.md from other programs, one in each datagram, and answers with "ok" or with what is
/// wrong.
class ControlPort {
 public:
  /// `address`: udp://ADDRESS:PORT. Errors name it.
  Result<void> open(const std::string& address);
  /// Carries out all requests that have arrived.
  void serve(ArenaObjects& objects);

 private:
  hal::Descriptor socket_;
};

}  // namespace touchline::arena
