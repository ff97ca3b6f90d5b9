#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/arena_objects.h"
#include "firmware/console/bug_report.h"
#include "firmware/console/client.h"
#include "firmware/console/client_message.h"
#include "firmware/console/event_log.h"
#include "firmware/console/file_thread.h"
#include "firmware/console/files_use.h"
#include "firmware/console/findings_message.h"
#include "firmware/console/foxglove_messages.h"
#include "firmware/console/frame_feed.h"
#include "firmware/console/machine_monitor.h"
#include "firmware/console/messages.h"
#include "firmware/console/picture_source.h"
#include "firmware/console/recordings.h"
#include "firmware/console/setup_relay.h"
#include "firmware/network/reopening.h"
#include "firmware/signals.h"
#include "hal/linux/monotonic_clock.h"
#include "hal/mailbox.h"

namespace touchline::console {

// Largest number of clients: a team at the field and some viewers. Each may have a second connection, used only for
// Stop. Programs on this computer need no token, so some places are kept for clients with the token.
inline constexpr std::size_t kMaxClients = 16, kPlacesForToken = 4;

/// Passes reports from the printer's thread to the console.
class SharedReports {
 public:
  void set(const StatusReport& report) {
    const std::scoped_lock lock(mutex_);
    report_ = report;
    ++count_;
  }
  /// Replaces the reasons to halt, if they have changed since the last status.
  void set_halt(const HaltReport& halt) {
    const std::scoped_lock lock(mutex_);
    report_.halt = halt.halt;
    report_.stop_number = halt.stop_number;
    ++count_;
  }
  /// Returns the number of reports.
  [[nodiscard]] std::uint64_t count() const {
    const std::scoped_lock lock(mutex_);
    return count_;
  }
  [[nodiscard]] StatusReport get() const {
    const std::scoped_lock lock(mutex_);
    return report_;
  }
  EventLog events;

 private:
  mutable std::mutex mutex_;
  StatusReport report_;
  std::uint64_t count_ = 0;
};

/// A message for a client. `bytes` is preceded by kMessagePrefix free bytes and is valid until the next call of the
/// hub.
struct Outgoing {
  std::span<std::byte> bytes;
  bool is_binary = false;
};

template <class Integer>
void put_little_endian(std::byte*& to, Integer value) {
  for (std::size_t i = 0; i < sizeof(value); ++i) *to++ = static_cast<std::byte>(value >> (8 * i));
}

/// Protocol of a client: our own, with which it may drive; the part of our own that only stops robots; or Foxglove's,
/// with which it only watches.
enum class ClientProtocol : std::uint8_t { kTouchline, kStop, kFoxglove };

using network::Print;

/// Objects that the hub uses; all must outlive it.
struct HubLinks {
  SnapshotRing& snapshots;
  PictureExchange& pictures;
  ConsoleLink& loop;
  SharedReports& reports;
  AdaptationRequests* adaptation;            // null: there is no adaptation
  Print print;                               // prints a line of the log
  UseFiles use_files{};                      // empty: other files cannot be used
  ArenaObjects* arena = nullptr;             // null: the field is real
  std::shared_ptr<Recordings> recordings{};  // null: there is no folder for recordings
};

struct HubSettings {
  double picture_rate_hz = 15.0;  // highest rate of pictures
  std::string setup_socket;       // socket of the setup program; "": there is none
};

/// Returns the ids of the own team's robots.
std::vector<RobotId> own_robots(const Scene& scene);
/// Returns the period; zero if the rate is zero.
Duration period_of_rate(double rate_hz);

/// The console without its sockets: decides which client gets which message, and carries out the clients' requests.
/// Only one thread may use it.
class Hub {
 public:
  Hub(const HubLinks& links, Scene scene, const HubSettings& settings);

  /// Shows another session, which has begun. `error` says why this is not the requested session, or is "".
  void begin_session(Scene scene, const std::string& error);
  /// Call it every few milliseconds while somebody watches, else a few times a second.
  void tick(Instant now);
  /// Adds a client. Returns null if there are too many clients.
  Client* connect(Instant now, ClientProtocol protocol, bool has_token);
  /// Returns the Stop connection that has been silent for the longest time if there is no room for another one;
  /// otherwise null.
  [[nodiscard]] const Client* surplus_stop_line() const;
  void disconnect(Client& client);
  /// Handles a message of a client. `arrived` is the time at which the message arrived at the socket, where it may have
  /// waited. Returns false if the client violates the rules so badly that it must be disconnected.
  bool receive(Client& client, std::string_view text, Instant arrived, Instant now);
  /// Returns whether there is a message for the client.
  [[nodiscard]] bool has_message(const Client& client, Instant now) const;
  /// Returns the next message, the most urgent one first. Empty if there is none.
  Outgoing next_message(Client& client, Instant now);

  /// Returns the longest permitted message of the client.
  [[nodiscard]] std::size_t max_message_bytes(const Client& client) const {
    return driving_.driver() == client.number ? kMaxDriverMessageBytes : kMaxClientMessageBytes;
  }
  /// Returns whether somebody watches states or pictures, so that tick() must be called often.
  [[nodiscard]] bool is_watched() const;
  /// Requests a picture, for HTTP requests without WebSocket.
  void request_picture(Instant now) { pictures_.request(now); }
  /// Returns the lowest number that the next picture can have.
  [[nodiscard]] std::uint64_t next_picture_number() const;
  /// Returns whether the current picture's number is at least `from`.
  [[nodiscard]] bool has_picture(std::uint64_t from) const {
    return pictures_.frame() != nullptr && pictures_.number() >= from;
  }
  /// Returns the JPEG of the current picture if has_picture(from); else an empty span. The kMessagePrefix +
  /// kPictureHeaderBytes bytes in front of it may be written. It is valid until the next call.
  std::span<std::byte> current_jpeg(std::uint64_t from);
  [[nodiscard]] std::uint64_t picture_number() const { return pictures_.number(); }
  [[nodiscard]] const config::BoardFile& board() const { return scene_.configuration->board; }
  std::string metrics();
  /// Returns the content for a bug report of this moment, with the current picture if has_picture(from). Copies up to 8
  /// MB and the picture.
  BugReportContent bug_report_content(std::uint64_t from, Instant now);

  /// Returns the number of clients, without Stop connections.
  [[nodiscard]] std::size_t clients() const { return count_clients(false); }
  [[nodiscard]] const Driving& driving() const { return driving_; }
  /// Thread for work that may wait for a disk. tick() uses the results of its jobs.
  [[nodiscard]] FileThread& file_thread() { return files_; }
  /// Null: there is no folder for recordings. What reads the disk is called on recordings_thread() only.
  [[nodiscard]] const std::shared_ptr<Recordings>& recordings() const { return links_.recordings; }
  [[nodiscard]] FileThread& recordings_thread() { return recordings_thread_; }

 private:
  [[nodiscard]] std::size_t count_clients(bool stop_lines) const;
  Result<void> obey(Client& client, const ClientMessage& message, Instant arrived, Instant now);
  void read_loop(Instant now);
  void watch(Client& client, const ClientMessage& message, Instant now);
  Result<void> change_adaptation(const Client& client, AdaptationMode wanted);
  void pass_on();
  void serve_setup(Instant now);
  void read_reports(Instant now);
  [[nodiscard]] Outgoing status_message(Instant now);
  void obey(const SetupOrder& order);
  Result<void> use(const SetupOrder& order);
  void end_use(std::uint64_t number, const Result<FilesUse>& used);
  void update_setup_wish(Instant now);
  void end_try(const char* reason);
  /// Returns why the order cannot be carried out, or "".
  const char* begin_test(const SetupOrder& order);
  void forget_test();
  /// Returns why robots cannot move with the draft, or "".
  [[nodiscard]] const char* reason_to_stand() const;
  void end_test(const char* reason);
  void serve_test(Instant now);
  Result<void> leave_setup(const Client& client, std::int64_t request);
  void answer(const SetupOrder& order, const std::string& error);
  [[nodiscard]] ConsoleInput input_now() const;
  /// Returns whether the setup program will answer; otherwise `answer` has the error.
  bool pass_to_setup(const Client& client, std::string_view text, const ClientMessage& message, Answer& answer);
  Outgoing setup_message(Client& client);
  void announce_driver();
  [[nodiscard]] bool is_picture_due(const Client& client, Instant now) const;
  [[nodiscard]] bool has_fresh_picture(const Client& client) const;
  [[nodiscard]] bool is_state_due(const Client& client, Instant now) const;
  /// Writes JSON after `header` bytes, which the caller fills.
  template <class Write>
  Outgoing text_message(const Write& write, std::size_t header = 0) {
    for (;;) {
      const auto room = std::span<std::byte>(text_).subspan(kMessagePrefix);
      report::JsonWriter json({reinterpret_cast<char*>(room.data()) + header, room.size() - header});
      write(json);
      if (json.fits()) return {room.first(header + json.size()), false};
      text_.resize(2 * text_.size());
    }
  }
  Outgoing state_message(Client& client, const Snapshot& snapshot);
  Outgoing picture_message(Client& client, Instant now);
  void put_header(std::byte* to, const Frame& frame, std::uint8_t kind, std::uint16_t width, std::uint16_t height,
                  std::uint32_t special) const;

  // Function in hub_recordings.cpp.
  Result<void> control_recording(const Client& client, const ClientMessage& message);

  // Functions in hub_findings.cpp.
  Result<void> accept_probe(Client& client, const ClientMessage& message, Instant now);
  /// Answers questions about pixels with an error if no picture has answered them in time.
  void expire_probes(Instant now);
  [[nodiscard]] bool has_probe_answer(const Client& client) const;
  Outgoing probe_message(Client& client);
  /// Returns the next message with findings of the current picture. Empty if all were sent.
  Outgoing findings_message(Client& client);
  Outgoing classes_message(const Frame& frame, const PixelClassifier& classifier, int divisor);
  Outgoing light_message(const Frame& frame, const PixelClassifier& classifier);

  // Functions in hub_foxglove.cpp.
  bool receive_foxglove(Client& client, std::string_view text, Instant now);
  [[nodiscard]] bool has_foxglove_picture(const Client& client, Instant now) const;
  [[nodiscard]] bool has_foxglove_message(const Client& client, Instant now) const;
  void begin_foxglove_frame(Client& client, Instant now);
  Outgoing next_foxglove_message(Client& client, Instant now);
  Outgoing foxglove_data(Client& client, FoxgloveChannel channel, const Snapshot& snapshot, Instant now);
  template <class Write>
  Outgoing data_message(const Client& client, FoxgloveChannel channel, const FoxgloveFrame& frame, const Write& write);

  [[nodiscard]] double unix_s(Instant now) const { return seconds(unix_time_.to_unix(now)); }

  HubLinks links_;
  Scene scene_;
  Duration picture_period_;
  FrameFeed feed_;
  PictureSource pictures_;
  Driving driving_;
  FileThread files_;
  FileThread recordings_thread_{FileThread::Priority::kLowest};
  bool is_recording_ = false;  // as the clients know it
  MachineMonitor monitor_{files_};
  hal::UnixTimeOffset unix_time_ = hal::measure_unix_time_offset();
  const std::string session_name_;  // name for Foxglove, which differs after a restart
  Instant next_second_{};
  std::list<Client> clients_;
  SetupRelay setup_;
  std::optional<SetupOrder> order_;  // in progress: its files are being loaded, or its session is about to begin
  std::uint64_t last_order_ = 0;     // number of the newest one
  bool is_held_ = false;             // a draft is or was in use, and the saved files are not in use again
  bool is_trying_ = false;           // robots play with the draft
  // A robot that the setup program drives to test or measure it.
  struct Test {
    RobotId robot = kUnknownId;
    std::optional<ClientNumber> driver;  // who has asked for it
    std::uint64_t next = 0;              // number of the next snapshot to send
  };
  std::optional<Test> test_;
  SetupWish wish_ = SetupWish::kNone;
  ClientNumber last_number_ = 0, last_stop_line_ = ClientNumber{1} << 31;
  StatusReport report_;  // newest report
  std::uint64_t reports_read_ = 0;
  Instant heard_from_loop_{};  // arrival time of the newest report
  bool is_picture_failure_reported_ = false;
  std::optional<Score> told_score_;  // score told by a client, used if no referee tells it
  std::vector<std::byte> text_, binary_;
  std::shared_ptr<Parcel> parcel_;  // message of the setup program that is being sent
};

}  // namespace touchline::console
