#include "firmware/console/console.h"

#include <exception>

#include "firmware/console/page_files.h"

namespace touchline::console {

void Console::attach(Session& session, SnapshotRing& snapshots) {
  snapshots_ = &snapshots;
  session.set_snapshots(&snapshots);
  session.set_console(&input_, &pictures_);
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
  thread_ = std::thread([this, print] { work(print); });
}

Result<void> Console::open(Session& session, AdaptationRequests* adaptation, const std::string& version,
                           const Print& print) {
  const hal::CameraInfo& camera = session.camera_info();
  pictures_.allocate(picture_layout(camera.format, camera.width_px, camera.height_px).bytes);
  WebServerSettings settings{plan_.address, plan_.port, find_page_folder(), {plan_.hosts, {}, plan_.origins}};
  if (!is_loopback(plan_.address)) {
    Result<std::string> token = read_token(plan_.token_file);
    if (!token.ok()) {
      return failure(token.code(), "other computers need a token, which `touchline console --token` makes: %s",
                     token.error().text.c_str());
    }
    settings.access.token = std::move(token).value();
  }
  hub_ = std::make_unique<Hub>(HubLinks{*snapshots_, pictures_, input_, reports_, adaptation, print},
                               scene_of(session.configuration(), camera, version),
                               HubSettings{plan_.picture_rate_hz, plan_.setup_socket});
  server_ = std::make_unique<WebServer>(*hub_, std::move(settings));
  return server_->open();
}

void Console::work(const Print& print) {
  bool is_reported = false;
  while (!end_.load(std::memory_order_acquire)) {
    try {
      server_->serve();
    } catch (const std::exception& error) {  // memory is short: the game goes on
      if (!std::exchange(is_reported, true)) print("console: failed: " + std::string(error.what()));
    }
  }
}

void Console::stop() {
  if (!thread_.joinable()) return;
  end_.store(true, std::memory_order_release);
  server_->wake();
  thread_.join();
  server_.reset();
}

std::string Console::start_text() const {
  return port_ == 0 ? std::string() : "console: http://" + plan_.address + ":" + std::to_string(port_) + "\n";
}

}  // namespace touchline::console
