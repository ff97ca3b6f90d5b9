#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "firmware/console/console_plan.h"
#include "firmware/console/files_use.h"
#include "firmware/console/hub.h"
#include "firmware/console/listening_file.h"
#include "firmware/console/web_server.h"
#include "firmware/session.h"

namespace touchline::console {

/// The console of one run: its connections to the loop, and its thread. A failure in it does not reach the loop: if the
/// thread ends, robots driven from the console stop, because their commands become too old.
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
  /// real-time priority, which the thread would inherit. `print` is called on this and on the console's thread.
  /// Failures are printed. `adaptation` may be null.
  void start(Session& session, AdaptationRequests* adaptation, const std::string& version, const Print& print);
  /// Replaces the session that the console shows; call it after the next one's Session::open() and before its loop
  /// runs. `error` says why the next session is not the requested one, or is "".
  void begin_session(const Session& session, const std::string& error);
  /// Call it before start().
  void set_use_files(UseFiles use) { use_files_ = std::move(use); }
  /// Call it before start().
  void set_recordings(std::shared_ptr<Recordings> recordings) { recordings_ = std::move(recordings); }
  /// Ends the thread.
  void stop();

  /// Returns "console: http://127.0.0.1:8642\n"; "" if the console is not served. If other computers may use it and
  /// `is_terminal` is true, the text also contains their login links. The links contain the token, so they are printed
  /// only to a terminal, which only its user reads.
  [[nodiscard]] std::string start_text(bool is_terminal) const;
  /// Returns the object with which the console and other programs control an arena.
  [[nodiscard]] const std::shared_ptr<ArenaObjects>& arena_objects() const { return arena_objects_; }
  [[nodiscard]] SharedReports& reports() { return reports_; }
  /// Returns the port; 0 if the console is not served.
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  Result<void> open(Session& session, AdaptationRequests* adaptation, const std::string& version, const Print& print);
  void work(const Print& print);
  void run_task();

  const ConsolePlan plan_;
  PictureExchange pictures_;
  ConsoleLink loop_;
  SharedReports reports_;
  // The session shares this object, because it may outlive the console.
  const std::shared_ptr<ArenaObjects> arena_objects_ = std::make_shared<ArenaObjects>();
  SnapshotRing* snapshots_ = nullptr;
  std::unique_ptr<Hub> hub_;
  std::unique_ptr<WebServer> server_;
  UseFiles use_files_;
  std::shared_ptr<Recordings> recordings_;
  std::string version_, token_;
  std::mutex task_mutex_;
  std::condition_variable task_done_;
  std::function<void()> task_;  // task for the console's thread
  std::uint16_t port_ = 0;
  ListeningFile listening_;  // if other computers may use the console
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
