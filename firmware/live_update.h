#pragma once

#include <atomic>
#include <cstdint>

#include "core/adaptation.h"
#include "core/control/control_parameters.h"
#include "core/region/region_scanner.h"
#include "core/time.h"
#include "firmware/config/board_file.h"

namespace touchline {

/// Settings, prepared and checked in advance, that the loop uses from its next frame on.
struct LiveSettings {
  ScanTables* tables = nullptr;      // null: unchanged. The loop stores the address of its previous tables here
  Adaptation adaptation;             // belongs to the tables
  bool keep_adaptation_mode = true;  // a signal may have changed the mode
  ControlParameters control;
  config::FaultSettings faults;
  Duration radio_delay{};
  std::uint64_t taken_after = 0;  // set by the loop: number of frames processed before
};

/// Passes LiveSettings from another thread to the loop, which applies them between two frames without waiting.
class LiveUpdate {
 public:
  /// Called by the thread that owns the settings. It must not access them while they are pending.
  void offer(LiveSettings& live_settings) { offered_.store(&live_settings, std::memory_order_release); }
  [[nodiscard]] bool is_pending() const { return offered_.load(std::memory_order_acquire) != nullptr; }

  /// Called by the loop; null if nothing is pending. After applying the settings, the loop calls taken().
  [[nodiscard]] LiveSettings* offered() const { return offered_.load(std::memory_order_acquire); }
  void taken() { offered_.store(nullptr, std::memory_order_release); }

 private:
  std::atomic<LiveSettings*> offered_{nullptr};
  static_assert(std::atomic<LiveSettings*>::is_always_lock_free, "the loop must not wait");
};

}  // namespace touchline
