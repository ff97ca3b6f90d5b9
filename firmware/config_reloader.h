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
#include "firmware/live_settings_builder.h"
#include "firmware/live_update.h"
#include "hal/camera.h"

namespace touchline {

namespace config {
struct ReloadChanges;
}

/// Reads the three files again while the loop runs and applies the keys that may change during a game
/// (config/reload.h): camera controls to the open device, everything else by a LiveUpdate. Call it on a separate
/// thread, because it reads files, allocates, and waits for the camera and the loop.
class ConfigReloader {
 public:
  /// `paths`: the paths with which the program was started. `running`: the configuration in use; copied. `camera` and
  /// `live_update` must outlive the reloader, and the reloader the loop that uses its tables.
  ConfigReloader(config::FilePaths paths, const config::Configuration& running, hal::Camera& camera,
                 LiveUpdate& live_update);
  ~ConfigReloader();
  ConfigReloader(const ConfigReloader&) = delete;
  ConfigReloader& operator=(const ConfigReloader&) = delete;

  /// Returns whether the program was started with `paths`.
  [[nodiscard]] bool reads(const config::FilePaths& paths) const {
    return paths.board == paths_.board && paths.venue == paths_.venue && paths.team == paths_.team;
  }
  /// Returns messages for a person: which keys have changed and from which frame on, which keys need a restart, and
  /// errors in the files. After an error nothing changes. Returns when the loop has taken the settings or `cancelled`
  /// is set.
  std::vector<std::string> reload(const std::atomic<bool>& cancelled);
  /// Calls `on_offer` with the new files before the loop gets their settings, each time. Call it before reload().
  void set_on_offer(std::function<void(const config::Configuration&)> on_offer) { on_offer_ = std::move(on_offer); }
  /// Sets the controls of the camera if `next` differs from the configuration in use only in them. Returns false if
  /// `next` needs a restart, because it differs in other keys or not at all, or because the camera refuses the
  /// controls.
  bool adjust_camera_only(const config::Configuration& next);
  /// The configuration in use.
  [[nodiscard]] const config::Configuration& running() const { return *running_; }

 private:
  void adjust_camera(config::Configuration& next, config::ReloadChanges& changes, std::vector<std::string>& messages);

  const config::FilePaths paths_;
  hal::Camera& camera_;
  LiveUpdate& live_update_;
  std::function<void(const config::Configuration&)> on_offer_;
  // On the heap, because a configuration takes megabytes.
  std::unique_ptr<config::Configuration> running_;
  LiveSettingsBuilder live_settings_;
};

/// Gives several threads access to the reloader of the current session.
class SharedReloader {
 public:
  /// `reloader` must exist until detach().
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
  /// As ConfigReloader::adjust_camera_only(). Also returns false if no session runs, if the session has other files, or
  /// if a reload is in progress: the console's thread passes on every stop and must not wait for a reload.
  bool adjust_camera_only(const config::FilePaths& paths, const config::Configuration& next) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    return lock.owns_lock() && reloader_ != nullptr && reloader_->reads(paths) && reloader_->adjust_camera_only(next);
  }

 private:
  std::mutex mutex_;
  ConfigReloader* reloader_ = nullptr;
};

/// A thread that reloads on request. Start it before the loop's thread gets its real-time priority, because a new
/// thread inherits the priority. An exception ends only the reload that threw it.
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
