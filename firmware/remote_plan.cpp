#include "firmware/remote_plan.h"

#include <algorithm>
#include <string>

#include "firmware/config/error_list.h"

namespace touchline {

Result<hal::TcpAddress> plan_remote(const config::Configuration& configuration) {
  const config::BoardFile& board = configuration.board;
  config::ErrorList errors;
  const auto refuse = [&](const char* key, const std::string& message) {
    errors.add(configuration.board_where.of(key), key, message);
    return errors.result().error();
  };
  if (board.camera.address.empty()) {
    return refuse("camera.address", "is missing: tcp://ADDRESS:PORT of the program that sends the pictures");
  }
  Result<hal::TcpAddress> address = hal::parse_tcp_address(board.camera.address);
  if (!address.ok()) return refuse("camera.address", address.text());
  const bool has_mock_radio =
      board.radio.backend == hal::RadioBackend::kMock ||
      std::any_of(board.radio.more.begin(), board.radio.more.end(),
                  [](const hal::RadioPortSettings& radio) { return radio.backend == hal::RadioBackend::kMock; });
  if (board.camera.lockstep && (has_mock_radio || board.gpio.backend == hal::GpioBackend::kMock)) {
    return refuse("camera.lockstep",
                  "the time passes with the pictures, but radio or GPIO of the backend \"mock\" have an arena of their "
                  "own; use \"udp\", \"serial\" or \"none\"");
  }
  return address;
}

Result<std::optional<hal::NetworkAddress>> plan_arena_control(const config::Configuration& configuration) {
  const std::string& text = configuration.board.camera.control;
  if (text.empty()) return std::optional<hal::NetworkAddress>();
  Result<hal::NetworkAddress> address = hal::parse_network_address(text);
  if (address.ok() && address.value().kind == hal::NetworkAddress::Kind::kUdp && !address.value().is_multicast()) {
    return std::optional(std::move(address).value());
  }
  config::ErrorList errors;
  errors.add(configuration.board_where.of("camera.control"), "camera.control",
             address.ok() ? "has to be udp://ADDRESS:PORT of one program" : address.text());
  return errors.result().error();
}

}  // namespace touchline
