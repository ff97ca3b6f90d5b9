#pragma once

#include <sys/types.h>

#include <cstdint>
#include <memory>

#include "firmware/console/console.h"
#include "hal/result.h"
#include "tools/programs/latency/latency_report.h"

namespace touchline::latency {

/// Serves the console during a measurement as `touchline run` does, at a free port, with clients that read it from a
/// process of their own.
class ConsoleClients {
 public:
  explicit ConsoleClients(unsigned clients) : clients_(clients) {}
  ~ConsoleClients() { end(); }
  ConsoleClients(const ConsoleClients&) = delete;
  ConsoleClients& operator=(const ConsoleClients&) = delete;

  /// Call it before Session::open(). `snapshots`: the session's ring. kOutOfRange: the board file's [console] is wrong.
  Result<void> attach(Session& session, SnapshotRing& snapshots);
  /// Starts to serve, and connects the clients. Call it after Session::open() and before the loop's thread gets its
  /// real-time priority. kIo: the console or the clients' process cannot be started, or the console refused a client.
  Result<void> start(Session& session);
  /// Disconnects the clients.
  ConsoleTraffic stop();
  /// Ends clients and console. Call it before the session and its ring are destroyed, because the console's thread
  /// reads them.
  void end();

 private:
  Result<void> start_reader();
  void end_reader();

  const unsigned clients_;
  std::unique_ptr<console::Console> console_;
  pid_t reader_ = -1;
  int to_reader_ = -1, from_reader_ = -1;
};

}  // namespace touchline::latency
