#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/time.h"
#include "firmware/console/client_message.h"
#include "firmware/console/driving.h"
#include "firmware/console/foxglove_client.h"
#include "firmware/console/link_control.h"
#include "firmware/console/messages.h"
#include "firmware/network/message_limit.h"

namespace touchline::console {

// Limit of a client's messages. A page sends commands at 20 Hz, acknowledges 15 pictures a second and pings, and
// several keys may change at once.
inline constexpr double kMaxMessagesPerSecond = 100.0;
// Messages of this time may arrive at once, as they do after a link stood still.
inline constexpr double kMessageBurstS = 2.0;
// A client with more unread answers is dropped, because it sends requests without reading.
inline constexpr std::size_t kMaxWaitingAnswers = 64;

/// A message of the setup program for one or several clients.
struct Parcel {
  std::vector<std::byte> bytes;  // kMessagePrefix bytes of space, then the message
  bool is_binary = false;
  bool is_answer = false;  // answer to a request, which must not be lost
};
// Limit of the setup program's messages that wait for a client. Pictures arrive one at a time, and a client that is too
// slow misses some.
inline constexpr std::size_t kMaxWaitingParcels = 16;

/// A pixel that a client asked about.
struct Probe {
  std::int64_t request = 0;
  PixelPoint pixel;
  std::uint64_t from = 0;  // number of the first picture that can answer the question
  Instant deadline{};
};
// Limit of a client's open questions about pixels. A page asks about the next pixel after the answer to the last one.
inline constexpr std::size_t kMaxWaitingProbes = 4;

/// State of a client: what it watches, and what was sent to it.
struct Client {
  explicit Client(ClientNumber its_number) : number(its_number) {}

  const ClientNumber number;
  network::MessageLimit limit{kMaxMessagesPerSecond, kMessageBurstS};
  LinkControl link;
  std::uint64_t written = 0;  // number of bytes sent to the client

  // Periods that the last `watch` set; zero: the client does not watch.
  Duration state_period{}, picture_period{};
  std::uint16_t picture_width_px = 0;
  Instant next_state{}, next_picture{};

  Instant heard{};            // time of its last message, or of its connection
  bool is_stop_line = false;  // the client may only stop robots, and gets only answers
  bool wants_hello = true, wants_driver = true, wants_status = true;
  std::deque<Answer> answers;
  std::uint64_t last_event = 0;
  std::uint64_t states_until = 0;                // number of the newest snapshot sent, plus 1
  std::uint64_t pictures_until = 0;              // number of the newest picture sent, plus 1
  std::optional<std::uint64_t> picture_follows;  // number of the picture whose state was sent and which is sent next
  WatchedFindings findings, findings_left;  // findings that it watches, and those still to be sent before the picture
  std::size_t findings_bytes = 0;           // bytes of findings sent with the next picture
  std::deque<Probe> probes;

  std::unique_ptr<FoxgloveClient> foxglove;  // null: the client speaks our own protocol
  bool watches_setup = false;
  bool wants_setup_program = false;             // whether to tell the client that the setup program runs
  std::shared_ptr<Parcel> setup_state;          // newest state of the setup, until it is sent
  std::deque<std::shared_ptr<Parcel>> parcels;  // other messages of the setup program
};

/// Computes the next due time. The mean rate is kept even if frames do not arrive exactly on time.
inline void advance(Instant& next, Duration period, Instant now) { next = std::max(next + period, now - period / 2); }

}  // namespace touchline::console
