#include "firmware/network/publisher.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "hal/linux/monotonic_clock.h"

namespace touchline::network {
namespace {

using namespace std::chrono_literals;

// Period at which the geometry is sent. The leagues' programs expect it at least every few seconds, and a program that
// starts later waits for it.
constexpr Duration kGeometryPeriod = 1s;
// Period at which the geometry is encoded to detect changes; this costs some microseconds.
constexpr Duration kGeometryCheckPeriod = 100ms;
// Period at which the offset to Unix time is measured. A clock that is being synchronized changes by at most 0.5 ms a
// second.
constexpr Duration kTimePeriod = 1s;

Duration period_of(double rate_hz) { return rate_hz > 0.0 ? from_seconds(1.0 / rate_hz) : Duration::zero(); }

}  // namespace

PublisherOutput::PublisherOutput(std::string name, std::unique_ptr<Encoder> encoder,
                                 std::unique_ptr<hal::NetworkOutput> socket, double rate_hz)
    : name_(std::move(name)),
      encoder_(std::move(encoder)),
      socket_(std::move(socket)),
      reopening_(name_),
      period_(period_of(rate_hz)) {}

bool PublisherOutput::make_ready(Instant now, const Print& print) {
  if (is_open_ || !reopening_.is_due(now)) return is_open_;
  if (const Result<void> opened = socket_->open(); opened.ok()) {
    is_open_ = true;
  } else {
    reopening_.on_failure(opened.error(), now, print);
  }
  return is_open_;
}

void PublisherOutput::send(std::span<const std::byte> message, Instant now, const Print& print) {
  if (!make_ready(now, print)) {
    ++failed_;
  } else if (const Result<void> sent = socket_->send(message); sent.ok()) {
    sent_.fetch_add(1, std::memory_order_relaxed);
    reopening_.on_success(print);
  } else {
    ++failed_;
    socket_->close();
    is_open_ = false;
    reopening_.on_failure(sent.error(), now, print);
  }
  not_sent_.store(failed_ + socket_->dropped(), std::memory_order_relaxed);
}

bool PublisherOutput::is_frame_due(Instant sent) {
  // Allow for a tolerance, because frames do not arrive exactly on time.
  const Duration tolerance = period_ / 10;
  if (sent + tolerance < next_frame_) return false;
  next_frame_ = std::max(next_frame_ + period_, sent);
  return true;
}

void PublisherOutput::send_frame(const OutputFrame& frame, Instant now, std::span<std::byte> buffer,
                                 const Print& print) {
  if (!is_frame_due(frame.snapshot.machine_sent)) return;
  const std::size_t size = encoder_->encode_frame(frame, buffer);
  if (size > 0) send(buffer.first(size), now, print);
}

void PublisherOutput::send_geometry_if_due(Instant now, std::span<std::byte> buffer, const Print& print) {
  if (now < next_geometry_check_) return;
  next_geometry_check_ = now + kGeometryCheckPeriod;
  const std::span<const std::byte> message = buffer.first(encoder_->encode_geometry(buffer));
  if (message.empty()) return;
  const bool is_new = !std::equal(message.begin(), message.end(), geometry_.begin(), geometry_.end());
  if (!is_new && now < next_geometry_) return;
  geometry_.assign(message.begin(), message.end());
  next_geometry_ = now + kGeometryPeriod;
  send(message, now, print);
}

PublisherOutputs make_outputs(const NetworkPlan& plan, const config::Configuration& configuration, const Print& print) {
  PublisherOutputs out;
  for (const PlannedOutput& planned : plan.outputs) {
    Result<std::unique_ptr<Encoder>> encoder = make_encoder(planned.protocol, configuration);
    if (!encoder.ok()) {
      print("network: " + name_of(planned) + ": " + encoder.text());
      continue;
    }
    out.push_back(std::make_unique<PublisherOutput>(name_of(planned), std::move(encoder).value(),
                                                    hal::make_network_output(planned.address), planned.rate_hz));
  }
  return out;
}

std::optional<TeamColor> own_color(const config::TeamFile& team) {
  const std::optional<bool> is_yellow = config::own_is_yellow(team);
  if (!is_yellow) return std::nullopt;
  return *is_yellow ? TeamColor::kYellow : TeamColor::kBlue;
}

PublishedScene published_scene(const config::Configuration& configuration) {
  PublishedScene scene;
  scene.own = own_color(configuration.team).value_or(TeamColor::kBlue);
  scene.camera_id = configuration.board.network.camera_id;
  for (std::size_t i = 0; i < scene.robot_height_m.size(); ++i) {
    scene.robot_height_m[i] = configuration.pipeline.marker.teams[i].layout.height_m;
  }
  return scene;
}

Publisher::Publisher(SnapshotRing& ring, PublisherOutputs outputs, const PublishedScene& scene, Print print)
    : ring_(ring),
      outputs_(std::move(outputs)),
      scene_(scene),
      print_(std::move(print)),
      reader_(ring),
      buffer_(kMaxDatagramBytes) {
  const Instant now = hal::MonotonicClock::read();
  measure_time(now);
  for (const auto& output : outputs_) output->open(now, print_);
  thread_ = std::thread([this] { work(); });
}

void Publisher::end() {
  end_.store(true, std::memory_order_release);
  ring_.wake_readers();
  if (thread_.joinable()) thread_.join();
}

void Publisher::work() {
  bool last_turn = false;
  while (!last_turn) {
    last_turn = end_.load(std::memory_order_acquire);
    try {
      publish_waiting();
    } catch (const std::exception& error) {  // out of memory: messages are missing, but the game goes on
      if (!std::exchange(reported_, true)) print_("network: the publisher failed: " + std::string(error.what()));
    }
    if (!last_turn) reader_.wait(kGeometryCheckPeriod);
  }
}

void Publisher::publish_waiting() {
  const Instant now = hal::MonotonicClock::read();
  measure_time(now);
  for (const auto& output : outputs_) output->send_geometry_if_due(now, buffer_, print_);
  while (reader_.read(snapshot_)) publish(snapshot_, now);
  lost_.store(reader_.lost(), std::memory_order_relaxed);
}

void Publisher::publish(const Snapshot& snapshot, Instant now) {
  const auto unix_s = [this](Instant monotonic) { return seconds(time_.to_unix(monotonic)); };
  // For simulated time, convert the capture to the machine's clock: on both clocks, the capture is equally long before
  // the packet.
  const Instant captured = snapshot.machine_sent - (snapshot.sent - snapshot.captured);
  OutputFrame frame{snapshot, unix_s(captured), unix_s(now), scene_.own, scene_.camera_id, scene_.robot_height_m};
  const RefereeState& referee = snapshot.referee;
  if (referee.own_is_yellow) frame.own = *referee.own_is_yellow ? TeamColor::kYellow : TeamColor::kBlue;
  if (referee.own_height_m > 0.0f) frame.robot_height_m[0] = referee.own_height_m;
  if (referee.opponent_height_m > 0.0f) frame.robot_height_m[1] = referee.opponent_height_m;
  for (const auto& output : outputs_) output->send_frame(frame, now, buffer_, print_);
}

void Publisher::measure_time(Instant now) {
  if (now < next_time_) return;
  next_time_ = now + kTimePeriod;
  const hal::UnixTimeOffset measured = hal::measure_unix_time_offset();
  const bool is_new = is_time_known_ && hal::differ(time_, measured);
  {
    const std::scoped_lock lock(time_mutex_);
    time_ = measured;
  }
  is_time_known_ = true;
  if (is_new) print_("time: " + hal::describe(measured));
}

hal::UnixTimeOffset Publisher::unix_time() const {
  const std::scoped_lock lock(time_mutex_);
  return time_;
}

}  // namespace touchline::network
