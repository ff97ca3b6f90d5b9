#pragma once

#include <memory>

#include "core/region/region_scanner.h"
#include "firmware/live_update.h"
#include "hal/result.h"

namespace touchline {

namespace config {
struct Configuration;
struct ReloadChanges;
}  // namespace config

/// Makes the settings that a reload passes to the loop. Its tables alternate with those of the pipeline.
class LiveSettingsBuilder {
 public:
  /// `next`: the running configuration with the new values, and `changes` how it differs from the former one
  /// (config::apply_reloadable). Errors name the venue file. The former settings must have been taken.
  Result<void> build(const config::Configuration& next, const config::ReloadChanges& changes);
  [[nodiscard]] LiveSettings& settings() { return *settings_; }
  /// Call it when the pipeline uses the settings, and LiveSettings::tables are those that it used before.
  void on_taken() {
    if (settings_->tables != nullptr) unused_ = settings_->tables;
  }

 private:
  // On the heap, because they take megabytes.
  std::unique_ptr<ScanTables> second_;  // made for the first reload that needs them
  ScanTables* unused_ = nullptr;        // `second_` or the scanner's own tables
  std::unique_ptr<LiveSettings> settings_ = std::make_unique<LiveSettings>();
};

}  // namespace touchline
