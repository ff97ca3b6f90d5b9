#include "firmware/console/device_queries.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "firmware/console/file_thread.h"
#include "hal/linux/monotonic_clock.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Interval at which the clock is read while a query runs; its end is noticed at once.
constexpr auto kClockPeriod = 10ms;

struct Running {
  std::mutex mutex;
  std::condition_variable ended;
  std::set<std::string> names;
};

// Shared with abandoned threads, which may outlive static objects at the end of the program.
const std::shared_ptr<Running>& running() {
  static const auto shared = std::make_shared<Running>();
  return shared;
}

void answer(const std::shared_ptr<Running>& shared, const std::string& name, std::function<void()> query,
            bool lowers_priority) {
  // On Linux, this concerns this thread only.
  if (lowers_priority) static_cast<void>(::setpriority(PRIO_PROCESS, 0, kLowestNice));
  try {
    query();
  } catch (...) {  // out of memory, or a failure in a driver's library: the result stays empty
  }
  query = nullptr;
  const std::scoped_lock lock(shared->mutex);
  shared->names.erase(name);
  shared->ended.notify_all();
}

}  // namespace

DeviceQueries::DeviceQueries(Duration each, Duration all) : each_(each), end_(hal::MonotonicClock::read() + all) {}

DeviceQueries::Outcome DeviceQueries::ask(const std::string& name, std::function<void()> query, bool lowers_priority) {
  const std::shared_ptr<Running>& shared = running();
  const Instant now = hal::MonotonicClock::read(), deadline = std::min(now + each_, end_);
  std::unique_lock lock(shared->mutex);
  if (shared->names.contains(name)) return Outcome::kSilent;
  if (now >= end_) return Outcome::kNotAsked;
  std::thread(answer, shared, name, std::move(query), lowers_priority).detach();
  shared->names.insert(name);  // the thread needs the lock to end
  while (shared->names.contains(name)) {
    shared->ended.wait_for(lock, kClockPeriod);
    if (shared->names.contains(name) && hal::MonotonicClock::read() >= deadline) return Outcome::kSilent;
  }
  return Outcome::kAnswered;
}

bool is_being_queried(const std::string& name) {
  const std::shared_ptr<Running>& shared = running();
  const std::scoped_lock lock(shared->mutex);
  return shared->names.contains(name);
}

}  // namespace touchline::console
