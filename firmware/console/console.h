#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "firmware/console/console_plan.h"
#include "firmware/console/hub.h"
#include "firmware/console/web_server.h"
#include "firmware/session.h"

namespace touchline::console {

/// The console of one run: what it exchanges with the loop, and its thread. Nothing that goes wrong here reaches the
/// loop: robots driven from the console stop when the thread ends, because their commands become too old.
class Console {
 public:
  explicit Console(ConsolePlan plan) : plan_(std::move(plan)) {}
  ~Console() { stop(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  [[nodiscard]] const ConsolePlan& plan() const { return plan_; }
  /// Passes mailbox and pictures to the session; call it before Session::open(). `snapshots` is the session's ring.
  void attach(Session& session, SnapshotRing& snapshots);
  /// Opens the port and starts the thread; call it after Session::open(), and before the loop's thread gets its
  /// real-time priority, which the thread would inherit. `print` is called on this and on the console's thread. What
  /// fails is printed. `adaptation`: may be null.
  void start(Session& session, AdaptationRequests* adaptation, const std::string& version, const Print& print);
  /// Ends the thread.
  void stop();

  /// "console: http://127.0.0.1:8642\n"; "" if it is not served.
  [[nodiscard]] std::string start_text() const;
  [[nodiscard]] SharedReports& reports() { return reports_; }
  /// 0: it is not served.
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  Result<void> open(Session& session, AdaptationRequests* adaptation, const std::string& version, const Print& print);
  void work(const Print& print);

  const ConsolePlan plan_;
  PictureExchange pictures_;
  Mailbox<ConsoleInput> input_;
  SharedReports reports_;
  SnapshotRing* snapshots_ = nullptr;
  std::unique_ptr<Hub> hub_;
  std::unique_ptr<WebServer> server_;
  std::uint16_t port_ = 0;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// Runs the console's thread while it exists.
class ConsoleThread {
 public:
  /// Arguments of Console::start().
  ConsoleThread(Console& console, Session& session, AdaptationRequests* adaptation, const std::string& version,
                const Print& print)
      : console_(console) {
    console_.start(session, adaptation, version, print);
  }
  ~ConsoleThread() { console_.stop(); }
  ConsoleThread(const ConsoleThread&) = delete;
  ConsoleThread& operator=(const ConsoleThread&) = delete;

 private:
  Console& console_;
};

}  // namespace touchline::console
