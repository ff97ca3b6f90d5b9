#include "tools/programs/calibrate/light/light_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/geometry/camera_model.h"
#include "core/parameter.h"
#include "firmware/config/light_writer.h"
#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/calibrate/light/paper_check.h"
#include "tools/programs/calibrate/venue/venue_draft.h"

namespace touchline::calibrate {
namespace {

constexpr std::array<Choice<LightSurface>, 4> kSurfaces{{{"grey", LightSurface::kGreyPaper},
                                                         {"field", LightSurface::kField},
                                                         {"moving", LightSurface::kMoving},
                                                         {"border", LightSurface::kBorder}}};

// Distance inside the border at which the mask ends; the border is 2 to 5 cm wide and has a blurred edge.
constexpr float kInsideBorder_m = 0.03f;

// Returns false if the venue has no camera model yet.
bool camera_of(const VenueDraft& draft, CameraModel& camera) {
  const CameraParameters& model = draft.file.camera_model;
  return (model.kind == CameraModelKind::kFull ? model.full.fx_px : model.paper.focal_px) > 0 &&
         camera.configure(model).ok();
}

// Marks the pixels that show the floor inside the border.
std::vector<std::uint8_t> floor_mask(const VenueDraft& draft, const CameraModel& camera, const hal::Picture& picture) {
  std::vector<std::uint8_t> mask;
  mask.reserve(std::size_t{picture.width_px} * picture.height_px);
  const float x = draft.file.field.length_m / 2 - kInsideBorder_m, y = draft.file.field.width_m / 2 - kInsideBorder_m;
  for (std::uint32_t v = 0; v < picture.height_px; ++v) {
    for (std::uint32_t u = 0; u < picture.width_px; ++u) {
      const FieldPoint p = camera.to_field({static_cast<float>(u), static_cast<float>(v)}, 0.0f);
      mask.push_back(std::abs(p.x_m) < x && std::abs(p.y_m) < y ? 1 : 0);
    }
  }
  return mask;
}

// Reads C of the map with which the venue's colors were learned.
Result<void> read_normal(const std::string& venue, const config::LightEntry& entry, const std::string& measured_on,
                         std::optional<std::array<double, 3>>& normal) {
  if (entry.normal.size() != 3) {
    return Error{ErrorCode::kNotFound,
                 venue + ": light.normal is missing: measure the light without --keep-normal, then learn the colors"};
  }
  // Treat both alike, because pictures of a game show the same floor as pictures of the empty field.
  const auto surface_of = [](const std::string& surface) { return surface == "moving" ? "field" : surface; };
  if (surface_of(entry.surface) != surface_of(measured_on)) {
    return Error{ErrorCode::kInconsistent,
                 venue + ": light.surface: the colors were learned with a map of surface " + entry.surface +
                     "; --keep-normal needs pictures of the same surface, not of " + measured_on};
  }
  normal = {static_cast<double>(entry.normal[0]), static_cast<double>(entry.normal[1]),
            static_cast<double>(entry.normal[2])};
  return {};
}

// Checks that the field is covered with paper; kOutOfRange otherwise. The message advises the surface that can be
// measured in these pictures.
Result<void> require_paper(const LightFitInput& input, std::vector<std::uint8_t> floor) {
  const hal::Picture& first = input.pictures.front();
  const std::vector<std::uint8_t> inside =
      inside_mask(input.region_of_interest, static_cast<int>(first.width_px), static_cast<int>(first.height_px));
  for (std::size_t i = 0; i < floor.size(); ++i) floor[i] = inside[i] != 0 ? floor[i] : std::uint8_t{0};
  for (const hal::Picture& picture : input.pictures) {
    // Fit_light() reports the difference.
    if (picture.width_px != first.width_px || picture.height_px != first.height_px) return {};
  }
  const PaperCheck paper = check_paper(input.pictures, floor);
  if (paper.other_share <= kMaxOtherShare) return {};
  LightFitInput uncovered = input;
  uncovered.surface = LightSurface::kField;
  uncovered.floor = std::move(floor);
  LightMap map;
  LightReport report;
  const bool shows_floor = fit_light(uncovered, map, report).ok();
  return failure(
      ErrorCode::kOutOfRange,
      "the field is not covered with grey paper: %.1f %% of it show something else in picture %zu, such as "
      "at %zu,%zu px (robots, lines, hands). Cover it and take everything off%s",
      100 * paper.other_share, paper.picture + 1, paper.u_px, paper.v_px,
      shows_floor ? ", or measure the light on what is there: surface field leaves out robots, lines and gaps of paper"
                  : "");
}

}  // namespace

Result<LightCalibration> calibrate_light(const std::string& venue, std::vector<hal::Picture> pictures,
                                         const std::string& surface, bool keep_normal) {
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  const auto known = std::find_if(kSurfaces.begin(), kSurfaces.end(),
                                  [&](const Choice<LightSurface>& choice) { return choice.word == surface; });
  if (known == kSurfaces.end()) {
    return Error{ErrorCode::kNotFound, "surface " + surface + " is unknown; known are grey, field, moving and border"};
  }
  LightFitInput input;
  input.surface = known->value;
  input.pictures = std::move(pictures);
  if (keep_normal) TOUCHLINE_TRY(read_normal(venue, draft.file.light, surface, input.normal));
  input.region_of_interest = draft.region_of_interest;
  CameraModel camera;
  const hal::Picture& first = input.pictures.front();
  const bool has_camera = camera_of(draft, camera);
  if (has_camera && input.surface == LightSurface::kGreyPaper) {
    TOUCHLINE_TRY(require_paper(input, floor_mask(draft, camera, first)));
  } else if (has_camera) {
    input.floor = floor_mask(draft, camera, first);
    input.border = border_places(camera, draft.file.field, first.width_px, first.height_px);
  } else if (input.surface == LightSurface::kBorder) {
    return Error{ErrorCode::kInconsistent,
                 venue + ": surface border needs the camera model: calibrate the field first"};
  }
  LightCalibration out;
  out.paper_checked = has_camera;
  TOUCHLINE_TRY(fit_light(input, out.map, out.report));
  config::LightEntry entry;
  entry.surface = surface;
  for (const double value : out.report.normal) entry.normal.push_back(static_cast<float>(value));
  Result<std::string> png = hal::encode_png(map_picture(out.map));
  if (!png.ok()) return prefixed(venue, std::move(png).error());
  TOUCHLINE_TRY_ASSIGN(out.map_path, config::write_light(venue, png.value(), entry));
  out.had_colors = !draft.file.color.empty();
  return out;
}

}  // namespace touchline::calibrate
