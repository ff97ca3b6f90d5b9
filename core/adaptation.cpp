#include "core/adaptation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/marker/surface_color.h"

namespace touchline {
namespace {

// Longest time step, so that lost frames do not speed up learning.
constexpr float kMaxStep_s = 0.1f;
// Boxes move more slowly than the light map, so that they do not follow changes of the light.
constexpr float kBoxSlowdown = 4.0f;
// Largest distance of a certain sighting from its track.
constexpr float kMaxDistance_m = 0.02f;
// Smallest probabilities of a certain id, in the sighting and in the track. A track reaches kCertainTrack after half a
// second of sightings with 0.99, and after two seconds of sightings with 0.97.
constexpr float kCertainSighting = 0.9f, kCertainTrack = 0.998f;
// Largest range of values among 3 x 3 uniform pixels. A larger range shows an edge, or an object on the patch.
constexpr int kMaxRange_levels = 48;
// Values from this one upwards count as saturated.
constexpr std::uint8_t kSaturated = 250;
// Expected value from which on a channel has full weight. The influence of noise and black level grows below this
// value.
constexpr float kFullWeight_levels = 100.0f;

// A picture of 480 rows is updated in eight frames.
constexpr int kTileRowsPerFrame = 8;
constexpr std::uint32_t kTables = 3 * kLightLevels;
constexpr std::uint32_t kTablesPerFrame = 2;
// A step of the tint that moves a box by this much is corrected in the same frame, for the light levels of the tiles
// and for kSpareLevels more on each side. The other tables follow over time.
constexpr int kUrgentShift_levels = 3, kSpareLevels = 4;

// Returns whether the robot has been seen with this id for some time, agrees with its track, and shows its id now. The
// adaptation must not learn from an inferred id (from the other robots' ids, or from pixels in no box), because it
// would confirm its own mistakes.
bool is_certain(const RobotSighting& robot, const Tracks& tracks) {
  if (robot.id == kUnknownId || !robot.has_heading || robot.confidence < kCertainSighting) return false;
  if (std::none_of(robot.patches.begin(), robot.patches.end(),
                   [](const PatchSighting& patch) { return patch.role == PatchRole::kIdentification; })) {
    return false;
  }
  return std::any_of(tracks.robots.begin(), tracks.robots.end(), [&](const RobotTrack& track) {
    return track.team == robot.team && track.id == robot.id && track.state == TrackState::kSeen &&
           track.confidence >= kCertainTrack &&
           std::hypot(track.pose.position.x_m - robot.pose.position.x_m,
                      track.pose.position.y_m - robot.pose.position.y_m) < kMaxDistance_m;
  });
}

bool is_certain(const BallSighting& ball, const BallTrack& track) {
  return ball.seen && track.state == TrackState::kSeen &&
         std::hypot(track.position.x_m - ball.position.x_m, track.position.y_m - ball.position.y_m) < kMaxDistance_m;
}

// Returns the change of a typical color in YUV if R, G and B change by these levels and luma is corrected. A saturated
// channel changes less.
std::array<float, 3> effect_of_tint(const std::array<std::uint8_t, 3>& yuv, ColorSpace space,
                                    const std::array<float, 3>& levels) {
  const float luma = 0.299f * levels[0] + 0.587f * levels[1] + 0.114f * levels[2];
  const float limit = 255.0f * std::exp2(-luma / kLevelsPerOctave);
  std::array<float, 3> rgb =
      to_rgb({static_cast<float>(yuv[0]), static_cast<float>(yuv[1]), static_cast<float>(yuv[2])}, space);
  for (std::size_t c = 0; c < 3; ++c) {
    const float changed = rgb[c] * std::exp2((levels[c] - luma) / kLevelsPerOctave);
    rgb[c] = std::min(changed, std::max(limit, rgb[c])) - rgb[c];
  }
  return rgb_to_yuv(rgb, space);
}

// Returns the largest distance between corresponding sides of the boxes.
int largest_shift(const ColorBoxes& a, const ColorBoxes& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      most = std::max({most, std::abs(a[i].low[c] - b[i].low[c]), std::abs(a[i].high[c] - b[i].high[c])});
    }
  }
  return most;
}

bool same(const ColorBoxes& a, const ColorBoxes& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ColorBox& one, const ColorBox& other) {
    return one.low == other.low && one.high == other.high;
  });
}

}  // namespace

Status Adaptation::configure(const AdaptationParameters& parameters, const ScanParameters& scan, ColorId ball_color) {
  const float max_levels = kLevelsPerOctave * std::log2(static_cast<float>(parameters.max_light));
  if (Status s = field_.configure(parameters.reference, scan.format, scan.width_px, scan.height_px); !s.ok()) return s;
  if (Status s = light_.configure(scan.width_px, scan.height_px, max_levels); !s.ok()) return s;
  const float max_shift = std::min(static_cast<float>(parameters.max_shift), static_cast<float>(scan.box_shift_limit));
  if (Status s = shift_.configure(scan.boxes, max_shift); !s.ok()) return s;
  mode_ = parameters.mode;
  space_ = color_space(scan.format);
  time_constant_s_ = static_cast<float>(parameters.time_constant_s);
  typical_ = parameters.typical;
  ball_color_ = ball_color;
  last_ = {};
  target_ = scan.boxes;
  changed_ = false;
  next_row_ = 0;
  rows_due_ = 0;
  next_table_ = kTables;
  return {};
}

void Adaptation::set_mode(AdaptationMode mode) {
  mode_ = mode;
  if (mode != AdaptationMode::kOff) return;
  field_.reset();
  light_.reset();
  shift_.reset();
  changed_ = true;
}

void Adaptation::measure(const Frame& frame, RegionScanner& scanner) {
  const Shading& shading = scanner.shading();
  if (mode_ != AdaptationMode::kFollow || !shading.active() || !scanner.accepts(frame).ok()) return;
  if (!field_.measure(frame)) return;
  for (std::uint16_t row = 0; row < shading.rows(); ++row) {
    if (field_.changed(row)) scanner.apply_light_change(light_, field_, row);
  }
  if (is_yuv(space_)) follow_tint(scanner);
}

// In YUV, a tile has one level for all three channels, which a tint does not change. Instead, the boxes move by the
// tint's effect on each color.
void Adaptation::follow_tint(RegionScanner& scanner) {
  for (std::size_t color = 1; color <= kMaxColors; ++color) {
    if (!typical_.measured[color]) continue;
    shift_.set_known(static_cast<ColorId>(color), effect_of_tint(typical_[color], space_, field_.channel_means()));
  }
  changed_ = true;
  const ColorBoxes wanted = shift_.moved();
  if (largest_shift(wanted, target_) < kUrgentShift_levels) return;
  target_ = wanted;
  next_table_ = 0;
  const Shading& shading = scanner.shading();
  int lowest = kLightLevels, highest = 0;
  for (std::uint16_t row = 0; row < shading.rows(); ++row) {
    for (std::uint16_t column = 0; column < shading.columns(); ++column) {
      const int level = shading.levels(light_, column, row, field_.at(column, row))[0];
      lowest = std::min(lowest, level);
      highest = std::max(highest, level);
    }
  }
  lowest = std::max(lowest - kSpareLevels, 0);
  highest = std::min(highest + kSpareLevels, kLightLevels - 1);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (int level = lowest; level <= highest; ++level) {
      scanner.rebuild_tables(target_, channel, static_cast<std::uint8_t>(level));
    }
  }
}

ExpectedGain Adaptation::expected_gain(const RegionScanner& scanner) const {
  return mode_ == AdaptationMode::kFollow ? ExpectedGain(scanner.shading(), field_) : ExpectedGain();
}

void Adaptation::update(RegionScanner& scanner, StepTrace& trace) {
  const Instant now = trace.frame.capture_time;
  const auto elapsed_s = static_cast<float>(seconds(now - last_));
  last_ = now;
  trace.light = {};
  if (mode_ == AdaptationMode::kFollow && trace.status.ok() && elapsed_s > 0.0f) {
    learn(scanner.shading(), trace, std::min(elapsed_s, kMaxStep_s) / time_constant_s_);
  }
  apply(scanner);
  trace.light.brightness = std::exp2((light_.mean() + field_.mean()) / kLevelsPerOctave);
}

void Adaptation::learn(const Shading& shading, StepTrace& trace, float step) {
  if (!shading.active()) return;
  for (const RobotSighting& robot : trace.sightings.robots) {
    if (!is_certain(robot, trace.tracks)) continue;
    for (const PatchSighting& patch : robot.patches) {
      trace.light.patches += learn_patch(shading, trace.frame, patch, step) ? 1u : 0u;
    }
  }
  if (trace.light.patches > 0) light_.relax(step);
  // The top of a ball reflects the lamps above it. Its color is adapted, but the light map does not learn from it.
  const BallSighting& ball = trace.sightings.ball;
  Sample sample;
  if (is_certain(ball, trace.tracks.ball) && sample_at(trace.frame, ball.center, sample)) {
    learn_color(shading, color_space(trace.frame.format), ball_color_, ball.center, sample, step);
  }
}

bool Adaptation::sample_at(const Frame& frame, const PixelPoint& center, Sample& out) {
  const auto u = static_cast<int>(std::lround(center.u_px)), v = static_cast<int>(std::lround(center.v_px));
  if (u < 1 || v < 1 || u + 1 >= frame.width_px || v + 1 >= frame.height_px) return false;
  std::array<int, 3> sum{}, least{255, 255, 255}, most{};
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const int column = u + du, row = v + dv;
      const auto pixel = pixel_at(frame, static_cast<std::size_t>(column), static_cast<std::size_t>(row));
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += pixel[c];
        least[c] = std::min(least[c], int{pixel[c]});
        most[c] = std::max(most[c], int{pixel[c]});
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    if (most[c] - least[c] > kMaxRange_levels) return false;
    out.mean[c] = static_cast<float>(sum[c]) / 9.0f;
    out.saturated[c] = most[c] >= kSaturated;
  }
  return true;
}

bool Adaptation::learn_patch(const Shading& shading, const Frame& frame, const PatchSighting& patch, float step) {
  Sample sample;
  if (!sample_at(frame, patch.center, sample)) return false;
  const ColorSpace space = color_space(frame.format);
  const std::array<std::uint8_t, 3>& typical = typical_[patch.color];
  const ExpectedGain gain(shading, field_);
  std::array<float, 3> brighter{}, weight{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto black = static_cast<float>(black_value(space, c));
    const float expected = static_cast<float>(typical[c]) - black, measured = sample.mean[c] - black;
    if (expected <= 0.0f || measured <= 0.0f || sample.saturated[c]) continue;
    const float reliability = std::min(1.0f, expected / kFullWeight_levels);
    brighter[c] = kLevelsPerOctave * std::log2(measured / expected) - gain.levels_at(c, patch.center);
    weight[c] = reliability * reliability;
  }
  if (is_yuv(space)) {
    // Chroma does not measure light, so luma is used for all channels.
    brighter.fill(brighter[0]);
    weight.fill(weight[0]);
  }
  light_.observe(patch.center, brighter, weight, step);
  changed_ = true;
  learn_color(shading, space, patch.color, patch.center, sample, step);
  return true;
}

void Adaptation::learn_color(const Shading& shading, ColorSpace space, ColorId color, const PixelPoint& center,
                             const Sample& sample, float step) {
  if (sample.saturated[0] || sample.saturated[1] || sample.saturated[2]) return;
  const ExpectedGain gain(shading, field_);
  std::array<float, 3> deviation{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto black = static_cast<float>(black_value(space, c));
    const float levels = gain.levels_at(c, center) + light_.at(c, center);
    const float corrected = black + (sample.mean[c] - black) * std::exp2(-levels / kLevelsPerOctave);
    deviation[c] = corrected - static_cast<float>(typical_[color][c]);
  }
  shift_.observe(color, deviation, step / kBoxSlowdown);
  changed_ = true;
}

void Adaptation::apply(RegionScanner& scanner) {
  const Shading& shading = scanner.shading();
  if (changed_ && shading.active()) rows_due_ = shading.rows();
  for (int i = 0; i < kTileRowsPerFrame && rows_due_ > 0; ++i, --rows_due_) {
    scanner.apply_light_change(light_, field_, next_row_);
    next_row_ = static_cast<std::uint16_t>((next_row_ + 1) % shading.rows());
  }
  if (next_table_ == kTables) {
    if (!std::exchange(changed_, false)) return;
    const ColorBoxes wanted = shift_.moved();
    if (same(wanted, target_)) return;
    target_ = wanted;
    next_table_ = 0;
  }
  for (std::uint32_t i = 0; i < kTablesPerFrame && next_table_ < kTables; ++i, ++next_table_) {
    scanner.rebuild_tables(target_, next_table_ / kLightLevels, static_cast<std::uint8_t>(next_table_ % kLightLevels));
  }
}

}  // namespace touchline
