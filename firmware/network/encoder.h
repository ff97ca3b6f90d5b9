#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "firmware/config/configuration.h"
#include "firmware/network/messages.h"
#include "hal/result.h"

namespace touchline::network {

/// Turns frames into messages of one protocol, in fixed memory.
class Encoder {
 public:
  virtual ~Encoder() = default;
  /// Writes the message of a frame and returns its size. `out` has kMaxDatagramBytes.
  virtual std::size_t encode_frame(const OutputFrame& frame, std::span<std::byte> out) = 0;
  /// Writes the message that describes field and cameras, sent once a second and when it changes. 0: the protocol has
  /// no such message.
  virtual std::size_t encode_geometry(std::span<std::byte> /*out*/) { return 0; }
};

/// Makes the encoder of a protocol, which copies the parts of `configuration` that it needs. kInconsistent,
/// kOutOfRange: the protocol cannot describe this camera.
Result<std::unique_ptr<Encoder>> make_encoder(config::OutputProtocol protocol,
                                              const config::Configuration& configuration);

}  // namespace touchline::network
