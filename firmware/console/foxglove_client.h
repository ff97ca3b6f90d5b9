#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/console/link_control.h"
#include "hal/result.h"

namespace touchline::console {

/// Subprotocol of Foxglove's WebSocket protocol, version 1, under its old and its new name. The parts that this server
/// uses are the same in both.
inline constexpr std::array kFoxgloveSubprotocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};
/// Maximum number of errors that wait for a client; further errors are lost.
inline constexpr std::size_t kMaxFoxgloveErrors = 16;

/// Channels to which a client can subscribe. The channel number in the protocol is this value plus 1.
enum class FoxgloveChannel : std::uint8_t { kState, kScene, kAnnotations, kPicture };
inline constexpr std::size_t kFoxgloveChannels = 4;
constexpr std::size_t index_of(FoxgloveChannel channel) { return static_cast<std::size_t>(channel); }

/// State of a client of Foxglove's protocol: its subscriptions, and the messages that it gets next.
class FoxgloveClient {
 public:
  /// Carries out a message: subscribe or unsubscribe. kCorruptFrame: the text is not a JSON object; kInconsistent: a
  /// member is missing or of the wrong kind; kNotFound: there is no such channel; kUnsupported: any other message,
  /// because these clients may only watch.
  Result<void> receive(std::string_view text);

  [[nodiscard]] bool has(FoxgloveChannel channel) const { return subscriptions_[index_of(channel)].has_value(); }
  /// Returns the client's number for its subscription; requires has().
  [[nodiscard]] std::uint32_t subscription(FoxgloveChannel channel) const {
    return subscriptions_[index_of(channel)].value_or(0);
  }

  bool wants_server_info = true, wants_channels = true;
  bool wants_field = true;  // lines of the field, which are sent once after each subscription
  std::deque<std::string> errors;

  // Frame whose messages are being sent, one after the other.
  std::uint64_t frame = 0;
  std::array<bool, kFoxgloveChannels> due{};
  PictureLevel level;  // level of the frame's picture, which also applies to the annotations

 private:
  Result<void> subscribe(std::uint32_t id, std::uint32_t channel);
  void unsubscribe(std::uint32_t id);

  std::array<std::optional<std::uint32_t>, kFoxgloveChannels> subscriptions_;
};

}  // namespace touchline::console
