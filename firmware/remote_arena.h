#pragma once

#include <string>

#include "hal/linux/network/descriptor.h"
#include "hal/linux/network/network_address.h"
#include "hal/result.h"

namespace touchline {

/// An arena in another process (`touchline-arena serve --control`), as far as it takes requests: a datagram for each
/// request, which it answers with "ok" or with what was wrong.
class RemoteArena {
 public:
  /// `address`: UDP.
  explicit RemoteArena(const hal::NetworkAddress& address) : address_(address), name_(address.text()) {}

  /// Sends the request (docs/arena.md, as JSON) and waits for the answer, at most 0.1 s. kTimeout: there was none;
  /// kInconsistent: the arena refuses it.
  Result<void> ask(const std::string& request);

 private:
  Result<void> connect();

  const hal::NetworkAddress address_;
  const std::string name_;
  hal::Descriptor socket_;
};

}  // namespace touchline
