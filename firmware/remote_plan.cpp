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

}  // namespace touchline
