#include "tests/console/server_fixture.h"

#include <random>

#include "firmware/external_input.h"

namespace touchline::console {
namespace {

constexpr std::uint16_t kWidth = 320, kHeight = 240;
constexpr Duration kFramePeriod = std::chrono::milliseconds(10);

}  // namespace

std::string text_of(std::string_view type, std::string_view members) {
  return "{\"type\":\"" + std::string(type) + "\"" + (members.empty() ? "" : ",") + std::string(members) + "}";
}

ConsoleServer::ConsoleServer() {
  config::FilePaths files;
  files.board = std::string(TOUCHLINE_SOURCE_DIR) + "/boards/mock/board.toml";
  const Result<void> loaded = config::load(files, *configuration_);
  EXPECT_TRUE(loaded.ok()) << loaded.text();
}

void ConsoleServer::start() {
  hal::CameraInfo camera;
  camera.width_px = kWidth;
  camera.height_px = kHeight;
  camera.rate_hz = 100.0;
  pictures_.allocate(std::size_t{3} * kWidth * kHeight);
  const Print print = [this](const std::string& line) { reports.events.add("info", line); };
  hub_ = std::make_unique<Hub>(
      HubLinks{*snapshots_, pictures_, link_, reports, &adaptation, print, use_files, nullptr, recordings},
      scene_of(configuration_, camera, "1.2.3"), HubSettings{picture_rate_hz, setup_socket});
  server_ = std::make_unique<WebServer>(*hub_, settings);
  const Result<void> opened = server_->open();
  ASSERT_TRUE(opened.ok()) << opened.text();
  loop_ = std::thread([this] { run_loop(); });
  console_ = std::thread([this] {
    while (!end_) {
      server_->serve();
      std::function<void()> task;
      {
        const std::scoped_lock lock(mutex_);
        task.swap(task_);
      }
      if (task) task();
    }
  });
}

std::array<std::uint8_t, 3> ConsoleServer::patch_value() const {
  for (const ColorBox& box : configuration_->pipeline.scan.boxes) {
    if (box.color != patch_color()) continue;
    std::array<std::uint8_t, 3> middle{};
    for (std::size_t c = 0; c < 3; ++c) middle[c] = static_cast<std::uint8_t>((box.low[c] + box.high[c]) / 2);
    return middle;
  }
  return {};
}

void ConsoleServer::begin_session_later(bool is_draft, bool is_calibrated, std::string error, std::uint64_t order) {
  const std::scoped_lock lock(mutex_);
  task_ = [this, is_draft, is_calibrated, order, error = std::move(error)] {
    hal::CameraInfo camera;
    camera.width_px = kWidth;
    camera.height_px = kHeight;
    Scene scene = scene_of(configuration_, camera, "1.2.3");
    scene.is_draft = is_draft;
    scene.is_calibrated = is_calibrated;
    scene.order = order;
    hub_->begin_session(std::move(scene), error);
  };
}

void ConsoleServer::end() {
  end_ = true;
  if (console_.joinable()) {
    server_->wake();
    console_.join();
  }
  if (loop_.joinable()) loop_.join();
  server_.reset();
}

void ConsoleServer::run_loop() {
  std::vector<std::uint8_t> pixels(std::size_t{3} * kWidth * kHeight);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i / 7);
  std::minstd_rand random(1);
  if (is_crowded) std::generate(pixels.begin(), pixels.end(), [&] { return random() >> 8 & 255U; });
  if (is_examined) {
    std::fill(pixels.begin(), pixels.end(), std::uint8_t{0});
    const std::array<std::uint8_t, 3> value = patch_value();
    for (std::size_t v = kPatch.top; v <= kPatch.bottom; ++v) {
      for (std::size_t u = kPatch.left; u <= kPatch.right; ++u) {
        std::copy(value.begin(), value.end(), pixels.begin() + static_cast<std::ptrdiff_t>(3 * (v * kWidth + u)));
      }
    }
    auto parameters = std::make_unique<PipelineParameters>(configuration_->pipeline);
    parameters->scan.format = PixelFormat::kRgb24;
    parameters->scan.width_px = kWidth;
    parameters->scan.height_px = kHeight;
    parameters->scan.light = {};
    parameters->scan.region_of_interest.clear();
    for (const PixelPoint corner : {PixelPoint{40.0f, -1.0f}, {400.0f, -1.0f}, {400.0f, 300.0f}, {40.0f, 300.0f}}) {
      static_cast<void>(parameters->scan.region_of_interest.push_back(corner));
    }
    parameters->adaptation.reference = {};
    pipeline_ = std::make_unique<Pipeline>();
    EXPECT_TRUE(pipeline_->configure(*parameters).ok());
  }
  Frame frame;
  frame.width_px = kWidth;
  frame.height_px = kHeight;
  frame.plane[0] = pixels.data();
  frame.stride_bytes[0] = 3U * kWidth;
  const auto snapshot = std::make_unique<Snapshot>();
  for (int id = 0; is_crowded && id < 22; ++id) {
    RobotTrack track;
    track.id = static_cast<RobotId>(id);
    static_cast<void>(snapshot->tracks.robots.push_back(track));
  }
  ExternalInputSettings external;
  external.console = &link_;
  ExternalInput input(external);
  StopRules rules({.stop_after = std::chrono::hours(1)});
  const Instant begin = hal::MonotonicClock::read();
  rules.accept_frame(begin, begin);
  rules.check_last_frame(begin);
  while (!end_) {
    std::this_thread::sleep_for(kFramePeriod);
    const Instant now = hal::MonotonicClock::read();
    input.take(now, now);
    input.apply_to(rules, now, std::chrono::seconds(1));
    halt_ = rules.halt();
    stop_number_ = input.stop_number(rules);
    {
      const std::scoped_lock lock(mutex_);
      input_ = input.console();
    }
    if (!camera_delivers) continue;
    snapshot->number = frames;
    snapshot->frame_sequence = static_cast<std::uint32_t>(snapshot->number);
    snapshot->captured = snapshot->received = now - std::chrono::milliseconds(5);
    snapshot->sent = snapshot->machine_sent = now;
    snapshot->latency = std::chrono::milliseconds(5);
    snapshot->halt = rules.halt();
    snapshot->stop_number = stop_number_;
    snapshot->is_held = rules.is_held();
    snapshots_->write(*snapshot);
    if (pictures_.is_wanted()) {
      if (pipeline_) pictures_.put_findings(*pipeline_, pipeline_->step(frame));
      pictures_.put(frame, snapshot->number);
      ++pictures_copied;
    }
    ++frames;
  }
}

}  // namespace touchline::console
