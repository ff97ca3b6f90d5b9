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
#include <utility>
#include <vector>

#include "core/types.h"
#include "firmware/config/configuration.h"
#include "firmware/console/client.h"
#include "firmware/console/setup_link.h"
#include "firmware/network/reopening.h"
#include "firmware/snapshot.h"

namespace touchline::console {

/// A request of the setup program to the firmware itself.
struct SetupOrder {
  enum class Kind : std::uint8_t { kUseSaved, kUseDraft, kTry, kEndTry, kTest, kEndTest } kind = Kind::kUseSaved;
  RobotId robot = kUnknownId;  // of kTest
  std::int64_t request = 0;
  config::FilePaths files;     // of kUseDraft
  ClientNumber client = 0;     // client that gave the order; 0: the setup program gave it
  std::int64_t to_client = 0;  // number of its request; 0: it is told errors only
  std::uint64_t number = 0;    // of the orders to use files, from 1
};

/// Passes messages between the clients of the console and the setup program (docs/console-protocol.md). Requests of the
/// setup program to the firmware itself are not passed on: the relay keeps them, for example as orders (next_order(),
/// answer()). Only the console's thread may use it.
class SetupRelay {
 public:
  /// `socket`: socket of the setup program; "": there is none. `clients` must outlive the relay.
  SetupRelay(std::string socket, std::list<Client>& clients, network::Print print, FileThread& files);

  /// Sets the first message to the program; "{}" until it is set.
  void set_hello(std::string text);
  /// Reads and writes as much as is possible without waiting.
  void serve(Instant now);
  /// Passes on a command of a client, with the client's number. `request` is 0 if the client wants no answer.
  /// kDisconnected: the program does not run; kBusy: it does not read; kCorruptFrame: `text` is not a JSON object.
  Result<void> pass_command(const Client& client, std::string_view text, std::int64_t request);
  /// Records that the client begins or ends to watch.
  void watch(Client& client, bool watches);
  /// Returns the next order of the program; empty if there is none.
  std::optional<SetupOrder> next_order();
  /// Answers an order. `error` is "" if the order was carried out.
  void answer(const SetupOrder& order, const std::string& error, bool is_calibrated);
  void tell_driver(std::optional<ClientNumber> driver);
  /// Sends what a frame shows of the robot that is tested. Returns false if the program does not read.
  bool send_step(const Snapshot& snapshot, RobotId robot);
  /// Returns the newest speeds for the wheels of the robot that is tested; empty if none have arrived.
  std::optional<WheelSpeeds> take_wheels() { return std::exchange(wheels_, std::nullopt); }
  void forget(ClientNumber client);

  /// Returns whether the program has sent a message since it was connected.
  [[nodiscard]] bool is_running() const { return link_.is_running(); }
  /// Returns whether serve() must be called often.
  [[nodiscard]] bool is_busy() const;
  /// Returns whether the program waits for a picture that may be sent now.
  [[nodiscard]] bool wants_frame(Instant now) const;
  /// Returns the lowest number that the next picture can have.
  [[nodiscard]] std::uint64_t next_frame() const { return next_frame_; }
  /// Sends a picture without padding, in the form of PictureExchange.
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
  std::uint64_t begun_ = 0;  // value of SetupLink::connections() for which begin() was called
  bool was_running_ = false;
  std::string reported_;  // last error that was logged
  std::shared_ptr<Parcel> state_;
  std::deque<SetupOrder> orders_;
  std::optional<WheelSpeeds> wheels_;
  std::vector<Request> requests_;  // requests that the program has not answered
  int frames_wanted_ = 0;
  Instant next_frame_time_{};
  std::uint64_t next_frame_ = 0;
};

}  // namespace touchline::console
