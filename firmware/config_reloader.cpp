#include "firmware/config_reloader.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "firmware/config/reload.h"

namespace touchline {
namespace {

// Interval at which requests are polled. A person does not notice the delay, and a signal handler needs no system call
// to wake this thread.
constexpr auto kRequestPollPeriod = std::chrono::milliseconds(20);
// Interval at which the thread checks whether the loop has taken the settings: a fraction of a frame's period.
constexpr auto kTakenPollPeriod = std::chrono::milliseconds(2);

std::string listed(const std::vector<config::Change>& changes, std::string (*text)(const config::Change&)) {
  std::string list;
  for (const config::Change& change : changes) list.append(list.empty() ? "" : ", ").append(text(change));
  return list;
}

std::string key_of(const config::Change& change) { return change.key; }

}  // namespace

ConfigReloader::ConfigReloader(config::FilePaths paths, const config::Configuration& running, hal::Camera& camera,
                               LiveUpdate& live_update)
    : paths_(std::move(paths)),
      camera_(camera),
      live_update_(live_update),
      running_(std::make_unique<config::Configuration>(running)) {}

ConfigReloader::~ConfigReloader() = default;

std::vector<std::string> ConfigReloader::reload(const std::atomic<bool>& cancelled) {
  std::vector<std::string> messages;
  const auto refused = [](const std::string& text) {
    return std::vector<std::string>{text, "reload: nothing was changed"};
  };
  const auto files = std::make_unique<config::Configuration>();
  if (const Result<void> loaded = config::load(paths_, *files); !loaded.ok()) return refused(loaded.text());
  auto next = std::make_unique<config::Configuration>(*running_);
  Result<config::ReloadChanges> applied = config::apply_reloadable(*files, *next);
  if (!applied.ok()) return refused(applied.text());
  config::ReloadChanges& changes = applied.value();
  if (changes.empty()) return {"reload: nothing has changed"};
  if (const Result<void> prepared = live_settings_.build(*next, changes); !prepared.ok())
    return refused(prepared.text());
  if (changes.concern(Reload::kCamera)) adjust_camera(*next, changes, messages);
  if (on_offer_) on_offer_(*files);
  live_update_.offer(live_settings_.settings());
  while (live_update_.is_pending()) {
    if (cancelled.load(std::memory_order_acquire)) return messages;
    std::this_thread::sleep_for(kTakenPollPeriod);
  }
  live_settings_.on_taken();
  running_ = std::move(next);
  if (!changes.applied.empty()) {
    messages.push_back("reload: from frame " + std::to_string(live_settings_.settings().taken_after + 1) +
                       " on: " + listed(changes.applied, config::text_of));
  }
  if (!changes.need_restart.empty()) {
    messages.push_back("reload: needs a restart: " + listed(changes.need_restart, key_of));
  }
  return messages;
}

bool ConfigReloader::adjust_camera_only(const config::Configuration& next) {
  const std::vector<config::Change> changes = config::difference(*running_, next);
  const bool is_possible = !changes.empty() && std::all_of(changes.begin(), changes.end(), [](const auto& change) {
    return change.reload == Reload::kCamera;
  });
  if (!is_possible || !camera_.adjust(next.board.camera).ok()) return false;
  running_->board.camera = next.board.camera;
  return true;
}

void ConfigReloader::adjust_camera(config::Configuration& next, config::ReloadChanges& changes,
                                   std::vector<std::string>& messages) {
  const Result<std::string> adjusted = camera_.adjust(next.board.camera);
  const std::string text = adjusted.ok() ? adjusted.value() : adjusted.text();
  if (!text.empty()) messages.push_back("reload: camera: " + text);
  if (adjusted.ok()) return;
  next.board.camera = running_->board.camera;
  const auto of_camera = [](const config::Change& change) {
    return change.file == config::FileKind::kBoard && change.key.starts_with("camera.");
  };
  const auto refused = std::stable_partition(changes.applied.begin(), changes.applied.end(),
                                             [&](const config::Change& change) { return !of_camera(change); });
  changes.need_restart.insert(changes.need_restart.begin(), refused, changes.applied.end());
  changes.applied.erase(refused, changes.applied.end());
}

ReloadThread::ReloadThread(Reload reload, const std::atomic<std::uint32_t>& requests, Print print)
    : reload_(std::move(reload)), requests_(requests), print_(std::move(print)) {
  thread_ = std::thread([this] { work(); });
}

ReloadThread::~ReloadThread() {
  end_.store(true, std::memory_order_release);
  thread_.join();
}

void ReloadThread::work() {
  while (!end_.load(std::memory_order_acquire)) {
    const std::uint32_t requests = requests_.load(std::memory_order_relaxed);
    if (std::exchange(served_, requests) != requests) reload_and_print();
    std::this_thread::sleep_for(kRequestPollPeriod);
  }
}

void ReloadThread::reload_and_print() {
  try {
    try {
      for (const std::string& line : reload_(end_)) print_(line);
    } catch (const std::exception& error) {
      print_(std::string("reload: failed: ") + error.what() + "; nothing was changed");
    }
  } catch (...) {  // out of memory for a message: the game continues without the message
  }
}

}  // namespace touchline
