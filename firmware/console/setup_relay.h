#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "firmware/config/configuration.h"
#include "firmware/console/client.h"
#include "firmware/console/setup_link.h"
#include "firmware/network/reopening.h"

namespace touchline::console {

/// A request of the setup program to the firmware itself.
struct SetupOrder {
  enum class Kind : std::uint8_t { kUseSaved, kUseDraft, kTry, kEndTry } kind = Kind::kUseSaved;
  std::int64_t request = 0;
  config::FilePaths files;     // of kUseDraft
  ClientNumber client = 0;     // client that gave the order; 0: the setup program gave it
  std::int64_t to_client = 0;  // number of its request; 0: it is told errors only
  std::uint64_t number = 0;    // of the orders to use files, from 1
};

/// Passes messages between the clients of the console and the setup program (docs/console-protocol.md). Requests of the
/// setup program to the firmware itself are not passed on: the relay keeps them, for example as orders (next_order(),
/// answer()). For the console's thread.
class SetupRelay {
 public:
  /// `socket`: of the setup program; "": there is none. `clients` outlives the relay.
  SetupRelay(std::string socket, std::list<Client>& clients, network::Print print, FileThread& files);

  /// Sets the first message to the program; "{}" until it is set.
  void set_hello(std::string text);
  /// Exchanges what can be exchanged at the moment.
  void serve(Instant now);
  /// Passes a command of a client on with the client's number. `request`: 0 if it wants no answer. kDisconnected: the
  /// program is not there; kBusy: it does not read; kCorruptFrame: `text` is not a JSON object.
  Result<void> pass_command(const Client& client, std::string_view text, std::int64_t request);
  /// The client begins or ends to watch.
  void watch(Client& client, bool watches);
  /// Returns the next order of the program; empty if there is none.
  std::optional<SetupOrder> next_order();
  /// The answer to an order. `error`: "" if it was obeyed.
  void answer(const SetupOrder& order, const std::string& error, bool is_calibrated);
  void tell_driver(std::optional<ClientNumber> driver);
  void forget(ClientNumber client);

  /// Whether the program has said something since it was connected.
  [[nodiscard]] bool is_running() const { return link_.is_running(); }
  /// Whether serve() has to be called often.
  [[nodiscard]] bool is_busy() const;
  /// Whether the program waits for a picture, which may be sent now.
  [[nodiscard]] bool wants_frame(Instant now) const;
  /// The number that the next picture has at least.
  [[nodiscard]] std::uint64_t next_frame() const { return next_frame_; }
  /// Sends a picture without padding, as PictureExchange has it.
  void send_frame(const Frame& frame, std::uint64_t number, double captured_unix_s, Instant now);

 private:
  struct Request {
    ClientNumber client;
    std::int64_t number;
  };

  void begin();
  void end(const Error& error);
  void announce();
  Result<void> obey(SetupMessage&& message);
  Result<void> take_order(const nlohmann::json& object);
  Result<void> pass_binary(std::vector<std::byte> binary, ClientNumber only);
  void pass_answer(SetupMessage&& message, ClientNumber to, std::int64_t request);
  Client* find(ClientNumber number);

  SetupLink link_;
  std::list<Client>& clients_;
  const network::Print print_;
  std::string hello_ = "{}";
  std::optional<ClientNumber> driver_;
  std::uint64_t begun_ = 0;  // SetupLink::connections() for which begin() was called
  bool was_running_ = false;
  std::string reported_;  // the last error in the log
  std::shared_ptr<Parcel> state_;
  std::deque<SetupOrder> orders_;
  std::vector<Request> requests_;  // that the program has not answered
  int frames_wanted_ = 0;
  Instant next_frame_time_{};
  std::uint64_t next_frame_ = 0;
};

}  // namespace touchline::console
