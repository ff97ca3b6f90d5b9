#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "firmware/config/configuration.h"
#include "firmware/live_update.h"
#include "hal/camera.h"

namespace touchline {

namespace config {
struct ReloadChanges;
}

/// Reads the three files again while the loop runs and applies the keys that may change then (config/reload.h): camera
/// controls to the open device, everything else by a LiveUpdate. Call it on a separate thread, because it reads files,
/// allocates, and waits for the camera and the loop.
class ConfigReloader {
 public:
  /// `paths`: those that the program was started with. `running`: the configuration in use; copied. `camera` and
  /// `live_update` must outlive the reloader, and the reloader the loop that uses its tables.
  ConfigReloader(config::FilePaths paths, const config::Configuration& running, hal::Camera& camera,
                 LiveUpdate& live_update);
  ~ConfigReloader();
  ConfigReloader(const ConfigReloader&) = delete;
  ConfigReloader& operator=(const ConfigReloader&) = delete;

  /// Whether `paths` are those that the program was started with.
  [[nodiscard]] bool reads(const config::FilePaths& paths) const {
    return paths.board == paths_.board && paths.venue == paths_.venue && paths.team == paths_.team;
  }
  /// Returns messages for a person: which keys have changed and from which frame on, which need a restart, and errors
  /// in the files (then nothing changes). Returns when the loop has taken the settings or `cancelled` is set.
  std::vector<std::string> reload(const std::atomic<bool>& cancelled);
  /// Gives the camera its new controls if `next` differs from the configuration in use by nothing else. False: it
  /// differs otherwise, or not at all, or the camera refuses; then `next` needs a restart.
  bool adjust_camera_only(const config::Configuration& next);
  /// The configuration in use.
  [[nodiscard]] const config::Configuration& running() const { return *running_; }

 private:
  void adjust_camera(config::Configuration& next, config::ReloadChanges& changes, std::vector<std::string>& messages);
  Result<void> prepare(const config::Configuration& next, const config::ReloadChanges& changes);

  const config::FilePaths paths_;
  hal::Camera& camera_;
  LiveUpdate& live_update_;
  // On the heap because it takes megabytes.
  std::unique_ptr<config::Configuration> running_;
  std::unique_ptr<ScanTables> second_;  // made at the first reload that needs them
  ScanTables* unused_ = nullptr;        // `second_` or the scanner's own tables
  std::unique_ptr<LiveSettings> live_settings_ = std::make_unique<LiveSettings>();
};

/// Lets several threads use the reloader of the session that runs at the moment.
class SharedReloader {
 public:
  /// `reloader` is used until detach().
  void attach(ConfigReloader& reloader) {
    const std::scoped_lock lock(mutex_);
    reloader_ = &reloader;
  }
  void detach() {
    const std::scoped_lock lock(mutex_);
    reloader_ = nullptr;
  }
  /// As ConfigReloader::reload().
  std::vector<std::string> reload(const std::atomic<bool>& cancelled) {
    const std::scoped_lock lock(mutex_);
    return reloader_ != nullptr ? reloader_->reload(cancelled) : std::vector<std::string>{};
  }
  /// As ConfigReloader::adjust_camera_only(); false also if no session runs, or one with other files, or if a reload
  /// runs: the console's thread, which passes on every stop, does not wait for it.
  bool adjust_camera_only(const config::FilePaths& paths, const config::Configuration& next) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    return lock.owns_lock() && reloader_ != nullptr && reloader_->reads(paths) && reloader_->adjust_camera_only(next);
  }

 private:
  std::mutex mutex_;
  ConfigReloader* reloader_ = nullptr;
};

/// A thread that reloads on request. Start it before the loop's thread gets its real-time priority, which it would
/// inherit. An exception ends only the reload that threw it.
class ReloadThread {
 public:
  /// ConfigReloader::reload.
  using Reload = std::function<std::vector<std::string>(const std::atomic<bool>& cancelled)>;
  using Print = std::function<void(const std::string& line)>;
  /// `requests` is incremented for each request. `reload` and `print` are called on the new thread.
  ReloadThread(Reload reload, const std::atomic<std::uint32_t>& requests, Print print);
  /// Cancels a reload that waits for the loop.
  ~ReloadThread();
  ReloadThread(const ReloadThread&) = delete;
  ReloadThread& operator=(const ReloadThread&) = delete;

 private:
  void work();

  void reload_and_print();

  const Reload reload_;
  const std::atomic<std::uint32_t>& requests_;
  const Print print_;
  std::uint32_t served_ = 0;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace touchline
