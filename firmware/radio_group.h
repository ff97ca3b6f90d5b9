#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/fixed_vector.h"
#include "firmware/device_reconnector.h"
#include "hal/clock.h"
#include "hal/radio.h"

namespace touchline {

/// A radio of a RadioGroup.
struct GroupMember {
  std::unique_ptr<hal::Radio> radio;
  std::bitset<kMaxReceivers> reaches;  // by receiver
};

/// Several radios that are used as one. A packet for a robot is sent by the radios that reach it, a packet for all
/// robots by all of them. A radio that is lost is reopened on a thread of its own while the others go on, so that the
/// robots that can still be reached get stop packets; partly_lost_since() tells the loop that robots must stop.
class RadioGroup final : public hal::Radio {
 public:
  /// `first_pause`, `wait_for_driver`: see DeviceReconnector.
  RadioGroup(std::vector<GroupMember> members, hal::Clock& clock, Duration first_pause, bool wait_for_driver);
  ~RadioGroup() override { RadioGroup::do_close(); }
  RadioGroup(const RadioGroup&) = delete;
  RadioGroup& operator=(const RadioGroup&) = delete;

  [[nodiscard]] const std::string& description() const override { return description_; }
  void add_routes(std::size_t receiver, hal::RadioRoutes& out) const override;
  [[nodiscard]] std::optional<Instant> partly_lost_since() const override;
  std::optional<Error> take_port_event() override;

 private:
  struct Port {
    GroupMember member;
    std::unique_ptr<DeviceReconnector> reconnector;  // while the group is open
    Instant lost_at{};
    std::uint64_t unreachable = 0;  // of the radio's counters, that the group has counted
    std::optional<Error> event;     // the newest one that was not taken yet
  };

  Result<void> do_open() override;
  Result<void> do_send(const Packet& packet, std::size_t receiver) override;
  Result<Duration> do_serve() override;
  Result<std::size_t> do_receive(std::span<std::byte> into, std::size_t& sender) override;
  Result<void> do_drain(Instant deadline) override;
  void do_close() override;

  [[nodiscard]] static bool is_open(const Port& port) { return port.reconnector && port.reconnector->is_open(); }
  /// Passes on an error of an open port. kOk: the port was lost by it, which the loop learns from partly_lost_since().
  Result<void> lose_if_broken(Port& port, Error error);
  void mark_lost(Port& port, Error error);

  std::vector<Port> ports_;
  std::size_t next_port_ = 0;  // from which bytes are received first
  hal::Clock& clock_;
  const Duration first_pause_;
  const bool wait_for_driver_;
  bool was_open_ = false;
  std::string description_;
};

}  // namespace touchline
