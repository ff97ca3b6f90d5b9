#pragma once

#include <string>

#include "firmware/arena_objects.h"
#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"
#include "hal/result.h"

namespace touchline::arena {

/// Takes the requests of docs/arena.md from other programs, one in each datagram, and answers with "ok" or with what is
/// wrong.
class ControlPort {
 public:
  /// Errors name the address.
  Result<void> open(const hal::NetworkAddress& address);
  /// Carries out all requests that have arrived.
  void serve(ArenaObjects& objects);

 private:
  hal::Descriptor socket_;
};

}  // namespace touchline::arena
