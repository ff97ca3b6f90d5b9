#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/time.h"

namespace touchline::console {

/// Asks drivers that may never answer, one after the other, each on a thread of its own with low priority. A thread
/// whose driver hangs is abandoned; the device is not asked again before it has answered, so there are no more such
/// threads than devices.
class DeviceQueries {
 public:
  enum class Outcome : std::uint8_t {
    kAnswered,
    kSilent,    // it does not answer in time, or still does not answer an earlier query
    kNotAsked,  // the time for all devices is over
  };

  /// `each`, `all`: longest waits for one device and for all together.
  DeviceQueries(Duration each, Duration all);

  /// `name`: of the device. `query` owns all that it uses, because it may outlive this object; its results count only
  /// after kAnswered. An exception ends it. `lowers_priority` false: its thread has the caller's priority. Throws
  /// std::system_error if there is no thread.
  Outcome ask(const std::string& name, std::function<void()> query, bool lowers_priority = true);

 private:
  const Duration each_;
  const Instant end_;
};

/// Returns whether a query for this device, of any object, has not ended.
bool is_being_queried(const std::string& name);

}  // namespace touchline::console
