#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "firmware/arena_places.h"
#include "firmware/config/configuration.h"
#include "firmware/network/messages.h"
#include "firmware/network/referee.h"
#include "hal/result.h"

namespace touchline::network {

/// Content of one message. `received` is not set.
struct DecodedMessage {
  CommandBatch batch;
  std::optional<RefereeMessage> referee;
  std::optional<ArenaRequest> arena;  // of a protocol that controls simulations
};

/// Reads the messages of one protocol, in fixed memory and bounded time. Messages may have any content.
class Decoder {
 public:
  virtual ~Decoder() = default;
  /// Decodes a message. `own`: present color of our team. On error the message is malformed and is ignored as a whole.
  virtual Result<DecodedMessage> decode(std::span<const std::byte> message, TeamColor own) = 0;
};

/// Makes the decoder of a protocol, which copies the parts of `configuration` that it needs.
std::unique_ptr<Decoder> make_decoder(config::InputProtocol protocol, const config::Configuration& configuration);

}  // namespace touchline::network
