#pragma once

#include <atomic>
#include <cstdint>

#include "core/adaptation.h"
#include "core/control/control_parameters.h"
#include "core/region/region_scanner.h"
#include "core/time.h"
#include "firmware/config/board_file.h"

namespace touchline {

/// What the loop is to work by from its next frame on, all of it made and checked before.
struct LiveSettings {
  ScanTables* tables = nullptr;      // null: those in use stay; after the loop has taken them: those that were in use
  Adaptation adaptation;             // goes with the tables
  bool keep_adaptation_mode = true;  // the one that a person may have set meanwhile
  ControlParameters control;
  config::FaultSettings faults;
  Duration radio_delay{};
  std::uint64_t taken_after = 0;  // the loop's answer: so many frames had been served
};

/// Hands a LiveSettings from one thread to the loop, which takes it between two frames without waiting for anybody.
class LiveUpdate {
 public:
  /// By the thread that made it, which may touch it again when it is not pending any more.
  void offer(LiveSettings& live_settings) { offered_.store(&live_settings, std::memory_order_release); }
  [[nodiscard]] bool is_pending() const { return offered_.load(std::memory_order_acquire) != nullptr; }

  /// By the loop: null when there is nothing; when it has been taken over, taken() gives it back.
  [[nodiscard]] LiveSettings* offered() const { return offered_.load(std::memory_order_acquire); }
  void taken() { offered_.store(nullptr, std::memory_order_release); }

 private:
  std::atomic<LiveSettings*> offered_{nullptr};
  static_assert(std::atomic<LiveSettings*>::is_always_lock_free, "the loop may not wait");
};

}  // namespace touchline
