#include "firmware/console/console_plan.h"

#include <unistd.h>
#include <charconv>
#include <filesystem>

#include "firmware/config/user_files.h"
#include "hal/linux/network/network_address.h"

namespace touchline::console {

std::string usable_token_file(const config::ConsoleSettings& board) {
  const std::string folder = std::filesystem::path(board.token_file).parent_path();
  const bool is_usable = ::access(board.token_file.c_str(), F_OK) == 0
                             ? ::access(board.token_file.c_str(), R_OK) == 0
                             : ::access(folder.empty() ? "." : folder.c_str(), W_OK) == 0;
  return is_usable ? board.token_file : config::user_state_file("console-token");
}

Result<ConsolePlan> plan_console(const config::ConsoleSettings& board, const config::Locations& where,
                                 const ConsoleOptions& options) {
  ConsolePlan plan;
  plan.is_enabled = board.enabled || options.is_requested;
  plan.token_file = board.token_file;
  plan.hosts = board.hosts;
  plan.origins = board.origins;
  plan.picture_rate_hz = board.picture_rate_hz;
  plan.setup_socket = board.setup_socket;
  const bool is_of_board = options.address.empty();
  const std::string& text = is_of_board ? board.address : options.address;
  const std::string place = is_of_board ? where.of("console.address") + ": console.address" : std::string("--console");
  const std::size_t colon = text.rfind(':');
  const std::string address = text.substr(0, colon) == "localhost" ? "127.0.0.1" : text.substr(0, colon);
  const char* const port = text.c_str() + (colon == std::string::npos ? text.size() : colon + 1);
  const char* const end = text.c_str() + text.size();
  const auto [read_until, error] = std::from_chars(port, end, plan.port);
  const bool is_address = hal::parse_network_range(address).ok() && address.find('/') == std::string::npos;
  if (!is_address || port == end || error != std::errc() || read_until != end) {
    return failure(ErrorCode::kOutOfRange, "%s = \"%s\" is not ADDRESS:PORT, such as 127.0.0.1:8642 or 0.0.0.0:8642",
                   place.c_str(), text.c_str());
  }
  plan.address = address;
  plan.is_interactive = options.is_requested;
  if (plan.is_interactive) plan.token_file = usable_token_file(board);
  return plan;
}

}  // namespace touchline::console
