#include "hal/mock/arena.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchline::hal::mock {
namespace {

// Exposure time and gain for which the lamps of `parameters` give the brightness that they describe: the default of
// camera.exposure_us, and the middle of the gains of cameras with 8-bit gain.
constexpr int kNominalExposure_us = 5000, kNominalGain = 128;

// Ratio of the radius in which an object can be grasped to the object's size. It is above 1, because a finger covers
// small objects.
constexpr double kReach = 1.5;

// Returns the point at which the viewing ray of a pixel meets the plane at this height; empty if the ray does not
// descend to it.
std::optional<Vector2> seen_at(const Lens& lens, const PixelPoint& pixel, double height_m) {
  const Vec3 ray = lens.unproject(static_cast<double>(pixel.u_px), static_cast<double>(pixel.v_px));
  if (ray[2] >= 0.0) return std::nullopt;
  const Vec3 eye = lens.position_m();
  const double t = (height_m - eye[2]) / ray[2];
  return Vector2{eye[0] + t * ray[0], eye[1] + t * ray[1]};
}

}  // namespace

Arena::Arena(const ArenaParameters& parameters, const CameraSettings& camera, const RadioSettings& radio,
             std::uint64_t seed, Instant begin)
    : parameters_(parameters),
      camera_(camera),
      faults_(parameters.fault),
      game_(parameters, radio, seed, begin),
      renderer_(parameters, camera.width_px, camera.height_px),
      sensor_(parameters.sensor, pixel_format(camera.format), camera.width_px, camera.height_px, seed),
      picture_faults_(parameters, camera, seed),
      now_(begin),
      led_picture_(parameters.led.radius_px > 0.0 ? std::size_t{3} * camera.width_px * camera.height_px : 0) {
  adjust_camera(camera);
}

bool Arena::fault_active(FaultKind kind, Instant at) const {
  const double t = seconds(at - game_.begin());
  return std::any_of(faults_.begin(), faults_.end(),
                     [&](const ArenaFault& fault) { return fault.kind == kind && fault.is_active(t); });
}

std::uint32_t Arena::hidden_robots(Instant at) const {
  return mock::hidden_robots(faults_, parameters_, seconds(at - game_.begin()));
}

void Arena::advance_to(Instant instant) {
  while (game_.now() + Game::kStep <= instant) {
    game_.step();
    now_ = std::max(now_, game_.now());
    if (streaming_) update_shutter();
  }
  now_ = std::max(now_, instant);
}

void Arena::inject(const ArenaFault& fault) {
  picture_faults_.prepare(fault.kind);
  faults_.push_back(fault);
}

void Arena::start_camera() {
  streaming_ = true;
  first_exposure_ = now_;
  next_frame_ = 0;
  shutters_.clear();
  waiting_.clear();
  held_ = 0;
}

Instant Arena::exposure_begin(std::uint64_t frame) const {
  return first_exposure_ + from_seconds(static_cast<double>(frame) / camera_.rate_hz);
}

void Arena::open_shutter() {
  const auto sequence = static_cast<std::uint32_t>(next_frame_++);
  if (fault_active(FaultKind::kCameraStall) || fault_active(FaultKind::kCameraLost)) return;
  if (held_ + static_cast<int>(waiting_.size() + shutters_.size()) >= camera_.buffers) return;
  OpenShutter shutter;
  shutter.exposure.begin = game_.world().snapshot();
  shutter.exposure.sequence = sequence;
  shutter.since = game_.now();
  shutters_.push_back(shutter);
}

void Arena::watch_led(OpenShutter& shutter) const {
  const double row = std::clamp(parameters_.led.v_px / std::max(1, camera_.height_px - 1), 0.0, 1.0);
  const Instant begin = shutter.since + from_seconds(row * parameters_.sensor.readout_s);
  if (!shutter.led_on_before && game_.now() >= begin) shutter.led_on_before = led_on_until(game_.now());
  const Duration open = game_.now() - begin;
  if (shutter.led_known || !shutter.led_on_before || open < from_seconds(parameters_.sensor.exposure_s)) return;
  shutter.led_known = true;
  if (open > Duration::zero()) {
    shutter.exposure.led = seconds(led_on_until(game_.now()) - *shutter.led_on_before) / seconds(open);
  }
}

void Arena::close_shutter(Exposure& exposure, Instant since) {
  exposure.end = game_.world().snapshot();
  const double all_rows_s = seconds(game_.now() - since), readout_s = parameters_.sensor.readout_s;
  if (readout_s > 0.0) {
    exposure.rows.begin_per_row = static_cast<float>(readout_s / all_rows_s / std::max(1, camera_.height_px - 1));
    exposure.rows.exposure = static_cast<float>((all_rows_s - readout_s) / all_rows_s);
  }
  exposure.capture_time = since + (game_.now() - since - from_seconds(readout_s)) / 2;
  exposure.ready = game_.now() + from_seconds(parameters_.sensor.transfer_s);
  waiting_.push_back(exposure);
}

void Arena::update_shutter() {
  const SensorParameters& sensor = parameters_.sensor;
  const Duration exposure = from_seconds(sensor.exposure_s), readout = from_seconds(sensor.readout_s);
  const bool is_busy = !shutters_.empty() && game_.now() <= shutters_.back().since + std::max(exposure, readout);
  if (!is_busy && game_.now() >= exposure_begin(next_frame_)) open_shutter();
  for (OpenShutter& shutter : shutters_) watch_led(shutter);
  if (shutters_.empty() || game_.now() < shutters_[0].since + exposure + readout) return;
  close_shutter(shutters_[0].exposure, shutters_[0].since);
  std::copy(shutters_.begin() + 1, shutters_.end(), shutters_.begin());
  shutters_.pop_back();
}

std::optional<Instant> Arena::next_frame_ready() const {
  if (!streaming_) return std::nullopt;
  if (!waiting_.empty()) return waiting_[0].ready;
  const Instant begin = shutters_.empty() ? std::max(exposure_begin(next_frame_), game_.now()) : shutters_[0].since;
  const SensorParameters& sensor = parameters_.sensor;
  // The shutter opens and closes at steps of the world, so the times at which it opens and closes are rounded up.
  return begin + from_seconds(sensor.exposure_s) + from_seconds(sensor.readout_s) + from_seconds(sensor.transfer_s) +
         2 * Game::kStep;
}

std::optional<Exposure> Arena::take_exposure() {
  if (waiting_.empty() || waiting_[0].ready > now_) return std::nullopt;
  const Exposure exposure = waiting_[0];
  std::copy(waiting_.begin() + 1, waiting_.end(), waiting_.begin());
  waiting_.pop_back();
  return exposure;
}

TruePlaces Arena::places_at_capture(const Exposure& exposure) const {
  const auto place = [&](const Placement& begin, const Placement& end) {
    const Placement middle = between(begin, end, 0.5 * static_cast<double>(exposure.rows.exposure));
    return Pose{{static_cast<float>(middle.x_m), static_cast<float>(middle.y_m)}, static_cast<float>(middle.theta_rad)};
  };
  TruePlaces truth;
  truth.is_known = true;
  truth.ball = place(exposure.begin.ball, exposure.end.ball).position;
  for (std::size_t i = 0; i < exposure.begin.robots.size(); ++i) {
    const ArenaRobot& robot = parameters_.robot[i];
    truth.robots.push_back({robot.team == Side::kOwn ? Team::kOwn : Team::kOpponent, static_cast<RobotId>(robot.id),
                            place(exposure.begin.robots[i], exposure.end.robots[i])});
  }
  return truth;
}

void Arena::adjust_camera(const CameraSettings& settings) {
  const auto ratio = [](int value, int nominal) { return value > 0 ? static_cast<double>(value) / nominal : 1.0; };
  sensor_.set_brightness(ratio(settings.exposure_us, kNominalExposure_us) * ratio(settings.gain, kNominalGain));
}

Result<void> Arena::move_object(const PixelPoint& from, const PixelPoint& to) {
  const Snapshot objects = game_.world().snapshot();
  const std::size_t ball = objects.robots.size();
  const auto place_of = [&](std::size_t i) -> const Placement& { return i == ball ? objects.ball : objects.robots[i]; };
  const double robot_reach = 0.5 * std::numbers::sqrt2 * parameters_.robot_side_m;
  const auto reach_of = [&](std::size_t i) { return i == ball ? parameters_.ball_radius_m : robot_reach; };
  const auto height_of = [&](std::size_t i) {
    return i == ball ? parameters_.ball_radius_m : parameters_.robot_height_m;
  };
  std::optional<std::size_t> moved;
  double least = kReach;
  for (std::size_t i = 0; i <= ball; ++i) {
    const auto at = seen_at(renderer_.lens(), from, height_of(i));
    if (!at) continue;
    const double share = std::hypot(at->x - place_of(i).x_m, at->y - place_of(i).y_m) / reach_of(i);
    if (share >= least) continue;
    least = share;
    moved = i;
  }
  if (!moved) {
    return failure(ErrorCode::kNotFound, "there is neither a robot nor the ball at %.0f,%.0f",
                   static_cast<double>(from.u_px), static_cast<double>(from.v_px));
  }
  const auto begin = seen_at(renderer_.lens(), from, height_of(*moved));
  const auto end = seen_at(renderer_.lens(), to, height_of(*moved));
  if (!end) return Error{ErrorCode::kOutOfRange, "this is not on the field"};
  Placement placed = place_of(*moved);
  const double reach = reach_of(*moved);
  const double most_x = 0.5 * parameters_.field.length_m - reach, most_y = 0.5 * parameters_.field.width_m - reach;
  placed.x_m = std::clamp(placed.x_m + end->x - begin->x, -most_x, most_x);
  placed.y_m = std::clamp(placed.y_m + end->y - begin->y, -most_y, most_y);
  for (std::size_t i = 0; i <= ball; ++i) {
    const double distance = std::hypot(placed.x_m - place_of(i).x_m, placed.y_m - place_of(i).y_m);
    if (i != *moved && distance < reach + reach_of(i)) {
      return failure(ErrorCode::kBusy, "%s is there: choose a free place", i == ball ? "the ball" : "another robot");
    }
  }
  if (*moved == ball) {
    game_.rules().place_ball(placed);
  } else {
    game_.rules().place_robot(*moved, placed);
  }
  return {};
}

void Arena::set_led(bool on) {
  led_on_time_ = led_on_until(now_);
  led_changed_ = now_;
  led_on_ = on;
}

std::span<const std::uint16_t> Arena::with_led(std::span<const std::uint16_t> picture, double share) {
  if (led_picture_.empty()) return picture;
  std::copy(picture.begin(), picture.end(), led_picture_.begin());
  const ArenaLed& led = parameters_.led;
  // Brightness of the LED: below the sensor's full scale, like a lamp behind paper.
  constexpr double kLight = 0.8 * kLinearScale;
  for (std::size_t v = 0; v < camera_.height_px; ++v) {
    for (std::size_t u = 0; u < camera_.width_px; ++u) {
      if (std::hypot(static_cast<double>(u) - led.u_px, static_cast<double>(v) - led.v_px) > led.radius_px) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint16_t& value = led_picture_[3 * (v * camera_.width_px + u) + c];
        value = static_cast<std::uint16_t>(std::min<double>(kLinearScale, 0.1 * value + kLight * share));
      }
    }
  }
  return led_picture_;
}

void Arena::render(const Exposure& exposure, std::span<std::uint8_t> out) {
  const std::span<const std::uint16_t> light =
      fault_active(FaultKind::kDark, exposure.ready)
          ? renderer_.render_dark()
          : renderer_.render(exposure.begin, exposure.end, exposure.rows, hidden_robots(exposure.capture_time));
  const auto is_active = [&](FaultKind kind) { return fault_active(kind, exposure.capture_time); };
  sensor_.expose(picture_faults_.change_scene(with_led(light, exposure.led), is_active), out);
  picture_faults_.change_bytes(out, exposure.capture_time, is_active);
}

}  // namespace touchline::hal::mock
