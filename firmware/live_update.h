#pragma once

#include <atomic>
#include <cstdint>

#include "core/adaptation.h"
#include "core/control/control_parameters.h"
#include "core/region/region_scanner.h"
#include "core/time.h"
#include "firmware/config/board_file.h"

namespace touchline {

/// Settings that the loop uses from its next frame on, prepared and checked in advance.
struct LiveSettings {
  ScanTables* tables = nullptr;      // null: keep those in use. The loop puts its former ones here
  Adaptation adaptation;             // belongs to the tables
  bool keep_adaptation_mode = true;  // a person may have changed it since
  ControlParameters control;
  config::FaultSettings faults;
  Duration radio_delay{};
  std::uint64_t taken_after = 0;  // set by the loop: frames processed before
};

/// Passes LiveSettings from one thread to the loop, which takes them between two frames without waiting.
class LiveUpdate {
 public:
  /// Called by the thread that made the settings. It must not touch them while they are pending.
  void offer(LiveSettings& live_settings) { offered_.store(&live_settings, std::memory_order_release); }
  [[nodiscard]] bool is_pending() const { return offered_.load(std::memory_order_acquire) != nullptr; }

  /// Called by the loop. nullptr: nothing is pending. After it has applied the settings, it calls taken().
  [[nodiscard]] LiveSettings* offered() const { return offered_.load(std::memory_order_acquire); }
  void taken() { offered_.store(nullptr, std::memory_order_release); }

 private:
  std::atomic<LiveSettings*> offered_{nullptr};
  static_assert(std::atomic<LiveSettings*>::is_always_lock_free, "the loop must not wait");
};

}  // namespace touchline
