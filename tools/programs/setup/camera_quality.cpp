#include "tools/programs/setup/camera_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/camera_model.h"
#include "firmware/config/configuration.h"
#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/setup/page_state.h"

namespace touchline::setup {
namespace {

constexpr std::size_t kBins = 32;
constexpr std::uint8_t kClipped = 254, kBlack = 1;
// Largest share of clipped pixels: reflections of lamps in the floor clip some, and more of them hide patches.
constexpr double kMaxClipped = 0.02;
// Largest step between neighboring pixels in an edge, relative to the edge's height: 0.38 for a Gaussian blur of 1 px,
// 0.2 for 2 px.
constexpr double kSharp = 0.3, kBlurred = 0.2;
constexpr double kMaxBlur_px = 1.0;
// Smallest difference over an edge that is judged.
constexpr int kClearEdge = 40;
// A picture without clear edges is dark if even its brightest parts, such as the lines of a black field, are below
// twice the smallest edge: then paper of half the brightness of white is no edge.
constexpr std::size_t kDarkValue = std::size_t{2} * kClearEdge;
constexpr double kAlmostAll = 0.999;

// Returns the largest step between neighboring pixels relative to the whole edge, as the median over the clear
// horizontal edges.
std::optional<double> focus_of(const hal::Picture& picture) {
  constexpr int kReach = 3;
  constexpr std::size_t kEnough = 100;
  const auto luma = [&](std::size_t u, std::size_t v) {
    const std::uint8_t* rgb = &picture.rgb8[3 * (v * picture.width_px + u)];
    return (rgb[0] + 2 * rgb[1] + rgb[2]) / 4;
  };
  std::vector<double> steps;
  for (std::size_t v = 0; v < picture.height_px; ++v) {
    for (std::size_t u = kReach; u + kReach < picture.width_px; ++u) {
      const int height = std::abs(luma(u + kReach, v) - luma(u - kReach, v));
      if (height < kClearEdge) continue;
      int largest = 0;
      for (std::size_t i = u - kReach; i < u + kReach; ++i)
        largest = std::max(largest, std::abs(luma(i + 1, v) - luma(i, v)));
      // In texture and thin lines, a step can be larger than the whole edge.
      if (largest <= height) steps.push_back(static_cast<double>(largest) / height);
    }
  }
  if (steps.size() < kEnough) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

// Returns the meters on the floor per pixel in the middle of the picture.
double scale_m(const calibrate::VenueDraft& venue, const Frame& frame) {
  CameraModel camera;
  if (calibrate::has_camera_model(venue) && camera.configure(venue.file.camera_model).ok()) {
    const float u = static_cast<float>(frame.width_px) / 2, v = static_cast<float>(frame.height_px) / 2;
    const FieldPoint a = camera.to_field({u, v}, 0.0f), b = camera.to_field({u + 1, v}, 0.0f);
    return static_cast<double>(std::hypot(b.x_m - a.x_m, b.y_m - a.y_m));
  }
  return static_cast<double>(venue.file.field.length_m) / frame.width_px;
}

// Returns the picture as it would be with another exposure, assuming a linear sensor.
hal::Picture exposed(hal::Picture picture, double share) {
  for (std::uint8_t& value : picture.rgb8) value = static_cast<std::uint8_t>(std::min(255.0, value * share));
  return picture;
}

// Judges the blur of the fastest robot; all exposures are judged by this function, including those that are advised.
const char* blur_level(double exposure_us, double limit_us) {
  return exposure_us > 2 * limit_us ? "bad" : exposure_us > limit_us ? "warning" : "ok";
}

bool is_dark(const hal::Picture& picture) {
  std::array<std::size_t, 256> count{};
  for (const std::uint8_t value : picture.rgb8) ++count[value];
  std::size_t below = 0;
  for (std::size_t value = 0; value < kDarkValue; ++value) below += count[value];
  return static_cast<double>(below) >= kAlmostAll * static_cast<double>(picture.rgb8.size());
}

// What to do about an exposure that is too long. `has_edges`: this picture has edges that can be judged.
std::string exposure_advice(const hal::Picture& picture, const ExposureState& state, bool has_edges) {
  if (state.longest_us < 1) return "no exposure is short enough";
  const std::string advice = formatted("expose at most %.0f us", state.longest_us);
  const bool gets_dark = has_edges && !focus_of(exposed(picture, state.longest_us / state.exposure_us));
  return gets_dark ? advice + ", with more light or more gain: the picture would be too dark otherwise" : advice;
}

}  // namespace

ExposureState exposure_state(const Frame& frame, const std::string& board, const std::string& venue,
                             const std::string& team) {
  const auto configuration = std::make_unique<config::Configuration>();
  static_cast<void>(config::load_board(board, {}, *configuration).ok());
  static_cast<void>(config::read_toml(team, "", {}, configuration->team, configuration->team_where).ok());
  const Result<calibrate::VenueDraft> draft = calibrate::read_draft(venue);
  const double scale = scale_m(draft.ok() ? draft.value() : calibrate::VenueDraft{}, frame);
  ExposureState state;
  const hal::CameraSettings& camera = configuration->board.camera;
  state.exposure_us = camera.exposure_us;
  state.speed_mps = static_cast<double>(configuration->team.control.drive.max_speed_mps);
  state.blur_us = state.speed_mps > 0 ? 1e6 * kMaxBlur_px * scale / state.speed_mps : 1e6;
  const double picture_us = camera.rate_hz > 0 ? 1e6 / camera.rate_hz : 1e6;
  const double longest_us = std::floor(std::min(state.blur_us, picture_us));  // the key takes whole numbers
  state.longest_us = std::string_view(blur_level(longest_us, state.blur_us)) == "ok" ? longest_us : 0;
  return state;
}

std::string brighter_advice(const ExposureState& state) {
  if (state.exposure_us < state.longest_us)
    return formatted("expose longer, up to %.0f us, raise the gain, or use more light", state.longest_us);
  return "raise the gain, or use more light: the exposure is at its limit";
}

nlohmann::json camera_quality(const Frame& frame, const SetupFiles& files, const std::string& folder) {
  const hal::Picture picture = calibrate::picture_of(frame);
  std::array<std::array<double, kBins>, 3> histogram{};
  std::array<double, 3> clipped{}, black{}, mean{};
  const std::size_t pixels = std::size_t{picture.width_px} * picture.height_px;
  const double share = 1.0 / static_cast<double>(pixels);
  for (std::size_t i = 0; i < 3 * pixels; ++i) {
    const std::uint8_t value = picture.rgb8[i];
    histogram[i % 3][value * kBins / 256] += share;
    clipped[i % 3] += value >= kClipped ? share : 0.0;
    black[i % 3] += value <= kBlack ? share : 0.0;
    mean[i % 3] += value * share;
  }
  nlohmann::json out = {
      {"histogram", histogram}, {"clipped", clipped}, {"black", black}, {"mean", mean}, {"focus", nullptr}};
  const char* level = "ok";
  nlohmann::json notes = nlohmann::json::array();
  const auto note = [&](const char* text_level, const std::string& text) {
    notes.push_back({{"level", text_level}, {"text", text}});
    if (std::string_view(level) != "bad") level = text_level;
  };
  const std::optional<double> focus = focus_of(picture);
  if (focus) out["focus"] = *focus;
  const ExposureState exposure =
      exposure_state(frame, folder + "/" + files.board, folder + "/" + files.venue, folder + "/" + files.team);
  if (!focus && is_dark(picture)) {
    note("warning", "the picture is too dark, or the lens is covered: " + brighter_advice(exposure));
  } else if (!focus) {
    note("warning", "the picture has no clear edge: is the lens covered, or far out of focus?");
  }
  if (focus && *focus < kSharp) note(*focus < kBlurred ? "bad" : "warning", "the picture is blurred: turn the lens");
  if (*std::max_element(clipped.begin(), clipped.end()) > kMaxClipped) {
    note("warning", "bright parts are clipped: use a shorter exposure or less gain");
  }

  out["exposure_limit_us"] = exposure.blur_us;
  const double blur_px = exposure.exposure_us * kMaxBlur_px / exposure.blur_us;
  out["blur_px"] = blur_px;
  if (const char* blur = blur_level(exposure.exposure_us, exposure.blur_us); std::string_view(blur) != "ok") {
    note(blur, formatted("robots at %.1f m/s are blurred by %.2f pixels: ", exposure.speed_mps, blur_px) +
                   exposure_advice(picture, exposure, focus.has_value()));
  }
  out["notes"] = notes;
  out["quality"] =
      quality(level, notes.empty() ? "exposure and focus are good" : notes[0]["text"].get_ref<const std::string&>(),
              100 * focus.value_or(0), "% sharp");
  return out;
}

}  // namespace touchline::setup
