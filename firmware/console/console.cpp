#include "firmware/console/console.h"

#include <pwd.h>
#include <unistd.h>
#include <exception>

#include "firmware/console/login_link.h"
#include "firmware/console/page_files.h"

namespace touchline::console {

namespace {

// Number of further ports to try, for use beside a service and the programs of other clones.
constexpr std::uint16_t kFurtherPorts = 9;

Scene scene_of(const Session& session, const std::string& version) {
  Scene scene = console::scene_of(session.shared_configuration(), session.camera_info(), version);
  scene.is_draft = session.is_draft();
  scene.is_calibrated = session.is_calibrated();
  scene.order = session.order();
  return scene;
}

/// The user who runs this program, for a command that makes the token for it.
std::string user_name() {
  const passwd* const user = ::getpwuid(::geteuid());  // NOLINT(concurrency-mt-unsafe): before other threads ask
  return user != nullptr ? user->pw_name : std::to_string(::geteuid());
}

}  // namespace

void Console::attach(Session& session, SnapshotRing& snapshots) {
  snapshots_ = &snapshots;
  session.set_snapshots(&snapshots);
  session.set_console(&loop_, &pictures_);
  session.set_arena_objects(arena_objects_);
}

void Console::start(Session& session, AdaptationRequests* adaptation, const std::string& version, const Print& print) {
  const Result<void> opened = open(session, adaptation, version, print);
  if (!opened.ok()) {
    server_.reset();
    hub_.reset();
    print("console: not served: " + opened.text());
    return;
  }
  port_ = server_->port();
  if (!token_.empty()) listening_.write(plan_.token_file, {plan_.address, port_});
  thread_ = std::thread([this, print] { work(print); });
}

Result<void> Console::open(Session& session, AdaptationRequests* adaptation, const std::string& version,
                           const Print& print) {
  const hal::CameraInfo& camera = session.camera_info();
  pictures_.allocate(picture_layout(camera.format, camera.width_px, camera.height_px).bytes);
  WebServerSettings settings{plan_.address, plan_.port, find_page_folder(), {plan_.hosts, {}, plan_.origins}};
  if (!is_loopback(plan_.address)) {
    Result<std::string> token = plan_.is_interactive ? make_token(plan_.token_file) : read_token(plan_.token_file);
    if (!token.ok()) {
      return failure(token.code(),
                     "other computers need a token, which `sudo -u %s touchline console --token` makes: %s",
                     user_name().c_str(), token.error().text.c_str());
    }
    settings.access.token = token_ = std::move(token).value();
  }
  version_ = version;
  hub_ = std::make_unique<Hub>(HubLinks{*snapshots_, pictures_, loop_, reports_, adaptation, print, use_files_,
                                        arena_objects_.get(), recordings_},
                               scene_of(session, version), HubSettings{plan_.picture_rate_hz, plan_.setup_socket});
  for (const std::uint16_t first = plan_.port;; ++settings.port) {
    server_ = std::make_unique<WebServer>(*hub_, settings);
    Result<void> opened = server_->open();
    const bool may_try_next = plan_.is_interactive && first != 0 && settings.port < first + kFurtherPorts;
    if (opened.ok() || opened.code() != ErrorCode::kDeviceBusy || !may_try_next) return opened;
  }
}

void Console::work(const Print& print) {
  bool is_reported = false;
  while (!end_.load(std::memory_order_acquire)) {
    try {
      server_->serve();
      run_task();
    } catch (const std::exception& error) {  // out of memory: the game goes on without the console
      if (!std::exchange(is_reported, true)) print("console: failed: " + std::string(error.what()));
    }
  }
}

void Console::begin_session(const Session& session, const std::string& error) {
  if (!thread_.joinable()) return;
  Scene scene = scene_of(session, version_);
  std::unique_lock lock(task_mutex_);
  task_ = [&] {
    const hal::CameraInfo& camera = session.camera_info();
    pictures_.reallocate(picture_layout(camera.format, camera.width_px, camera.height_px).bytes);
    hub_->begin_session(std::move(scene), error);
  };
  server_->wake();
  task_done_.wait(lock, [this] { return !task_; });
}

void Console::run_task() {
  const std::scoped_lock lock(task_mutex_);
  if (!task_) return;
  const std::function<void()> task = std::exchange(task_, nullptr);
  task_done_.notify_all();  // the waiting thread continues when the lock is free
  task();
}

void Console::stop() {
  if (!thread_.joinable()) return;
  end_.store(true, std::memory_order_release);
  server_->wake();
  thread_.join();
  listening_.remove();
  server_.reset();
}

std::string Console::start_text(bool is_terminal) const {
  if (port_ == 0) return {};
  const bool is_open = plan_.address == "0.0.0.0";
  std::string text = "console: http://" + (is_open ? "127.0.0.1" : plan_.address) + ":" + std::to_string(port_) + "\n";
  if (token_.empty()) return text;
  return text + (is_terminal ? login_text(plan_.address, port_, token_)
                             : "from other computers with the login link that `touchline console --link` prints\n");
}

}  // namespace touchline::console
