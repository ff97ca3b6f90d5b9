#include "tools/programs/arena/arena_server.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline::arena {
namespace {

using hal::mock::Arena;
using hal::mock::Exposure;
using std::chrono::milliseconds;

// How often the stop flag is looked at.
constexpr int kStopPoll_ms = 50;
// The bytes of a line follow each other faster; an adapter passes them on every 16 ms at the latest.
constexpr int kLineQuiet_ms = 20;
// Packets take effect on steps of the arena's world.
constexpr Duration kStep = milliseconds(1);

bool wait_readable(int file, Duration patience) {
  pollfd watched{file, POLLIN, 0};
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(patience);
  const timespec timeout{static_cast<std::time_t>(whole.count()), static_cast<long>((patience - whole).count())};
  return ::ppoll(&watched, 1, &timeout, nullptr) > 0;
}

// Takes the packets that followed the last picture, and waits for the first one.
Result<void> take_packets_of_frame(ServedGame& game, RobotPort& robots, Duration patience) {
  const std::uint64_t before = game.counters().packets;
  const Instant end = hal::MonotonicClock::read() + patience;
  for (;;) {
    TOUCHLINE_TRY(game.take_packets(robots));
    if (game.counters().packets != before) break;
    const Duration left = end - hal::MonotonicClock::read();
    if (left <= Duration{}) {
      game.count_silent_frame();
      return {};
    }
    wait_readable(robots.descriptor(), left);
  }
  while (!robots.keeps_packets() && wait_readable(robots.descriptor(), milliseconds(kLineQuiet_ms))) {
    TOUCHLINE_TRY(game.take_packets(robots));
  }
  return {};
}

bool is_over(const ServedArena& served) {
  const Arena& arena = served.game.arena();
  return served.stop.load() || (served.duration > Duration{} && arena.now() - arena.begin() >= served.duration);
}

/// Renders on a thread of its own. A picture that is not begun when the next one is taken is skipped.
class RenderThread {
 public:
  RenderThread(PictureOutputs& outputs, Arena& arena) : outputs_(outputs), arena_(arena), thread_([this] { run(); }) {}
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;
  ~RenderThread() {
    {
      const std::scoped_lock lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  /// Returns the error that ended the output.
  Result<void> offer(const Exposure& exposure) {
    const std::scoped_lock lock(mutex_);
    if (error_) return *error_;
    if (next_) ++skipped_;
    next_ = exposure;
    changed_.notify_all();
    return {};
  }
  [[nodiscard]] std::uint64_t skipped() {
    const std::scoped_lock lock(mutex_);
    return skipped_;
  }

 private:
  void run() {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ends_ || next_; });
      if (ends_) return;
      const Exposure exposure = *std::exchange(next_, std::nullopt);
      lock.unlock();
      outputs_.sender().accept(0);
      Result<void> written = outputs_.write(arena_, exposure);
      if (written.ok()) continue;
      lock.lock();
      error_ = std::move(written).error();
      return;
    }
  }

  PictureOutputs& outputs_;
  Arena& arena_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Exposure> next_;
  std::optional<Error> error_;
  std::uint64_t skipped_ = 0;
  bool ends_ = false;
  std::thread thread_;  // last, because it uses the others
};

}  // namespace

Result<void> serve_in_lockstep(const ServedArena& served) {
  ServedGame& game = served.game;
  Arena& arena = game.arena();
  PictureSender& sender = served.pictures.sender();
  bool is_first = true;  // no packet follows a picture before the first one
  while (!is_over(served)) {
    game.take_requests(served.control);
    sender.accept(sender.is_connected() ? 0 : kStopPoll_ms);
    if (!sender.is_connected()) {
      is_first = true;
      continue;
    }
    if (!sender.wait_for_request(kStopPoll_ms)) continue;
    TOUCHLINE_TRY(is_first ? game.take_packets(served.robots)
                           : take_packets_of_frame(game, served.robots, served.patience));
    is_first = false;
    std::optional<Exposure> exposure;
    while (!(exposure = arena.take_exposure())) arena.advance_to(*arena.next_frame_ready());
    game.count_frame();
    game.send_telemetry(served.robots);
    TOUCHLINE_TRY(served.pictures.write(arena, *exposure));
  }
  // The stop packets at the end of the receiver.
  return game.take_packets(served.robots);
}

Result<RealTimeStatistics> serve_in_real_time(const ServedArena& served) {
  ServedGame& game = served.game;
  Arena& arena = game.arena();
  const Duration offset = hal::MonotonicClock::read() - arena.now();
  served.pictures.set_clock_offset(offset);
  RenderThread rendering(served.pictures, arena);
  while (!is_over(served)) {
    arena.advance_to(hal::MonotonicClock::read() - offset);
    game.take_requests(served.control);
    TOUCHLINE_TRY(game.take_packets(served.robots));
    game.send_telemetry(served.robots);
    while (const std::optional<Exposure> exposure = arena.take_exposure()) {
      game.count_frame();
      TOUCHLINE_TRY(rendering.offer(*exposure));
    }
    const Instant due = std::min(arena.next_frame_ready().value_or(arena.now() + kStep), arena.now() + kStep);
    const Duration left = due + offset - hal::MonotonicClock::read();
    if (left > Duration{}) wait_readable(served.robots.descriptor(), left);
  }
  return RealTimeStatistics{rendering.skipped()};
}

}  // namespace touchline::arena
