#include "tools/programs/setup/light_step.h"

#include <algorithm>
#include <cmath>

#include "firmware/config/light_map_file.h"
#include "tools/programs/calibrate/light/light_calibration.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/setup/page_state.h"

namespace touchline::setup {
namespace {

// Largest ratio of the brightest to the darkest place of a well-lit field. Above it, the dark side has too few levels
// to distinguish the colors.
constexpr double kUneven = 3.0;

// Returns the picture as it would be under even light (Klancar eq. 17), using the map's nearest cell.
hal::Picture corrected(const hal::Picture& picture, const LightMap& map) {
  constexpr double kHalf = 0.5;
  const hal::Picture cells = calibrate::map_picture(map);
  hal::Picture out = picture;
  for (std::size_t v = 0; v < picture.height_px; ++v) {
    const std::size_t row = v * cells.height_px / picture.height_px;
    for (std::size_t u = 0; u < picture.width_px; ++u) {
      const std::size_t cell = row * cells.width_px + u * cells.width_px / picture.width_px;
      for (std::size_t c = 0; c < 3; ++c) {
        std::uint8_t& value = out.rgb8[3 * (v * picture.width_px + u) + c];
        const double light = cells.rgb16[3 * cell + c] / config::kUnitIllumination;
        value = static_cast<std::uint8_t>(std::clamp(value / std::max(light, 0.25) + kHalf, 0.0, 255.0));
      }
    }
  }
  return out;
}

nlohmann::json measured_light(const calibrate::LightCalibration& light, const std::string& surface, bool relearn) {
  const calibrate::LightReport& report = light.report;
  nlohmann::json out = {{"surface", surface},
                        {"least", report.least},
                        {"most", report.most},
                        {"known_cells", report.known_cells},
                        {"saturated_cells", report.saturated_cells},
                        {"dark_cells", report.dark_cells},
                        {"spots", report.spots.size()},
                        {"notes", nlohmann::json::array()}};
  const auto note = [&out](const char* level, const std::string& text) {
    out["notes"].push_back({{"level", level}, {"text", text}});
  };
  double uneven = 1;
  for (std::size_t c = 0; c < 3; ++c) uneven = std::max(uneven, report.most[c] / std::max(report.least[c], 1e-3));
  const bool is_unchecked = surface == "grey" && !light.paper_checked;
  if (is_unchecked) {
    note("warning", "whether the field is covered with paper was not checked: the field is not calibrated yet");
  }
  const bool has_spots = report.saturated_cells + report.dark_cells + report.clamped_cells > 0;
  if (report.saturated_cells > 0) note("warning", "parts of the field are saturated: use a shorter exposure");
  if (report.dark_cells > 0) note("warning", "parts of the field are too dark: use a longer exposure or more light");
  if (uneven > kUneven) note("warning", "the light is very uneven: add a lamp above the dark side");
  if (relearn) note("warning", "the colors were learned with another light map: learn them again");
  out["quality"] = quality(has_spots || is_unchecked || uneven > kUneven ? "warning" : "ok",
                           formatted("brightest to darkest place of the field %.1f : 1", uneven), uneven, ": 1");
  return out;
}

}  // namespace

Result<void> measure_light(const std::string& surface, bool keep_normal, const JobInput& input,
                           const JobOutput& output) {
  std::vector<hal::Picture> pictures;
  for (const CameraFrame& frame : input.frames) pictures.push_back(calibrate::picture_of(frame->frame()));
  const hal::Picture before = pictures.front();
  output.progress("the light is being measured");
  TOUCHLINE_TRY_ASSIGN(
      const calibrate::LightCalibration light,
      calibrate::calibrate_light(input.path(input.state.files.venue), std::move(pictures), surface, keep_normal));
  output.measured(measured_light(light, surface, light.had_colors && !keep_normal));
  TOUCHLINE_TRY(output.picture("before", before));
  return output.picture("after", corrected(before, light.map));
}

}  // namespace touchline::setup
