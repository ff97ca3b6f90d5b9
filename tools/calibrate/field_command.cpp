#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "tools/calibrate/camera_picture.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/field_fit.h"
#include "tools/calibrate/preview.h"
#include "tools/calibrate/text.h"
#include "tools/calibrate/venue_draft.h"

namespace touchline::calibrate {
namespace {

struct Preset {
  float length_m, width_m, goal_width_m, goal_depth_m;
};
// The leagues' rules: FIRA MiroSot middle league, IEEE very small size, RoboCup small size divisions A and B.
const std::map<std::string, Preset>& presets() {
  static const std::map<std::string, Preset> all = {{"mirosot-middle", {2.2f, 1.8f, 0.4f, 0.15f}},
                                                    {"vsss", {1.5f, 1.3f, 0.4f, 0.1f}},
                                                    {"ssl-a", {12.0f, 9.0f, 1.8f, 0.18f}},
                                                    {"ssl-b", {9.0f, 6.0f, 1.0f, 0.18f}}};
  return all;
}

Status read_pixels(const std::vector<std::string>& words, const char* option, std::vector<PixelPoint>& out,
                   std::string& reason) {
  for (const std::string& word : words) {
    const auto numbers = numbers_of(word, 2);
    if (!numbers) {
      reason = text("%s: \"%s\" is not u,v", option, word.c_str());
      return ErrorCode::kOutOfRange;
    }
    out.push_back({static_cast<float>((*numbers)[0]), static_cast<float>((*numbers)[1])});
  }
  return {};
}

}  // namespace

void FieldCommand::add_options(CLI::App& app) {
  app.add_option("--picture", picture, "Picture of the field as the camera delivers it")->required();
  app.add_option("--venue", venue, "Venue file; made when it does not exist")->required();
  app.add_option("--corners", corners, "Pixels u,v of the field's corners: -x-y +x-y +x+y -x+y (x along the field)")
      ->expected(4);
  app.add_option("--point", points, "x,y,u,v: a point of the floor (m) and its pixel; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--field-preset", preset, "mirosot-middle, vsss, ssl-a, ssl-b: size of field and goals");
  app.add_option("--length", length_m, "Length of the field, m")->check(CLI::Range(0.3, 30.0));
  app.add_option("--width", width_m, "Width of the field, m")->check(CLI::Range(0.3, 30.0));
  app.add_option("--camera-height", camera_height_m, "Height of the lens above the floor, m, measured")
      ->check(CLI::Range(0.3, 20.0));
  app.add_option("--kind", kind, "Which camera model the firmware uses: full, or paper (Klancar eq. 12-15)")
      ->check(CLI::IsMember({"full", "paper"}));
  app.add_option("--roi", region, "Pixels u,v of the region of interest's corners, three or more");
  app.add_option("--preview", preview, "PNG to write: the field's border as the model sees it");
}

int FieldCommand::run() const {
  std::string reason;
  VenueDraft draft;
  if (!read_draft(venue, draft, reason).ok()) return refuse(reason);
  CameraPicture photograph;
  if (!CameraPicture::load(picture, PixelFormat::kRgb24, photograph, reason).ok()) return refuse(reason);
  const Frame frame = photograph.frame();

  FieldParameters field = draft.file.field;
  if (!preset.empty()) {
    const auto known = presets().find(preset);
    if (known == presets().end())
      return refuse("--field-preset: " + preset + " is none of mirosot-middle, vsss, ssl-a, ssl-b");
    field.length_m = known->second.length_m;
    field.width_m = known->second.width_m;
    field.goal_width_m = known->second.goal_width_m;
    field.goal_depth_m = known->second.goal_depth_m;
  } else if (!draft.exists && (length_m <= 0 || width_m <= 0)) {
    return refuse("the size of the field is needed: --field-preset, or --length and --width");
  }
  if (length_m > 0) field.length_m = static_cast<float>(length_m);
  if (width_m > 0) field.width_m = static_cast<float>(width_m);

  FieldFitInput input;
  input.width_px = frame.width_px;
  input.height_px = frame.height_px;
  if (camera_height_m > 0) input.camera_height_m = camera_height_m;
  if (!corners.empty()) {
    std::vector<PixelPoint> pixels;
    if (!read_pixels(corners, "--corners", pixels, reason).ok()) return refuse(reason);
    const Corners four = {pixels[0], pixels[1], pixels[2], pixels[3]};
    if (!check_corners(four, reason).ok()) return refuse("--corners: " + reason);
    input.points = corner_points(four, static_cast<double>(field.length_m), static_cast<double>(field.width_m));
  }
  for (const std::string& word : points) {
    const auto n = numbers_of(word, 4);
    if (!n) return refuse("--point: \"" + word + "\" is not x,y,u,v");
    input.points.push_back({(*n)[0], (*n)[1], (*n)[2], (*n)[3]});
  }
  if (input.points.size() < 4) return refuse("--corners, or four times --point, is needed");

  std::vector<PixelPoint> polygon;
  if (!read_pixels(region, "--roi", polygon, reason).ok()) return refuse(reason);
  if (!polygon.empty() && (polygon.size() < 3 || polygon.size() > kMaxPolygonPoints)) {
    return refuse(text("--roi: %zu corners; from 3 to %zu are possible", polygon.size(), kMaxPolygonPoints));
  }

  FieldFit fit;
  if (!fit_field(input, fit, reason).ok()) return refuse(reason);
  fit.camera.kind = kind == "paper" ? CameraModelKind::kPaper : CameraModelKind::kFull;

  const std::string height =
      text("camera %.3f m (+- %.3f) above the floor, %.1f degrees off the vertical%s", fit.height_m, fit.height_sigma_m,
           fit.tilt_rad * 180.0 / 3.14159265358979, camera_height_m > 0 ? ", height given" : "");
  const std::string residual =
      text("%zu points: %.2f px RMS, %.2f px max; %.2f mm RMS, %.2f mm max", input.points.size(), fit.residual_px.rms,
           fit.residual_px.max, fit.residual_mm.rms, fit.residual_mm.max);
  config::PictureEntry entry = draft.file.picture;
  entry.width_px = frame.width_px;
  entry.height_px = frame.height_px;
  std::vector<Section> sections = {section_of("picture", entry, ""), section_of("field", field, ""),
                                   section_of("camera_model", fit.camera, residual)};
  if (!polygon.empty()) {
    config::RegionOfInterestEntry roi;
    for (const PixelPoint& p : polygon) {
      roi.u_px.push_back(p.u_px);
      roi.v_px.push_back(p.v_px);
    }
    sections.push_back(section_of("region_of_interest", roi, ""));
  }
  if (!preview.empty()) {
    hal::Picture drawn;
    drawn.width_px = frame.width_px;
    drawn.height_px = frame.height_px;
    for (std::size_t v = 0; v < frame.height_px; ++v) {
      const std::uint8_t* row = frame.plane[0] + v * frame.stride_bytes[0];
      drawn.rgb8.insert(drawn.rgb8.end(), row, row + 3 * std::size_t{frame.width_px});
    }
    CameraModel camera;
    if (!camera.configure(fit.camera).ok()) return refuse("the model found cannot be used");
    draw_field(camera, field, input.points, drawn);
    if (!hal::write_picture(preview, drawn, reason).ok()) return refuse(reason);
  }
  if (!write_sections(venue, sections, reason).ok()) return refuse(reason);

  std::printf("%s\n%s\n", height.c_str(), residual.c_str());
  std::printf("lens: focal lengths %.1f and %.1f px, k1 %s\n", static_cast<double>(fit.camera.full.fx_px),
              static_cast<double>(fit.camera.full.fy_px),
              fit.has_distortion ? text("%.4f", static_cast<double>(fit.camera.full.k1)).c_str()
                                 : "0 (two more points than the corners, --point, are needed to find it)");
  std::printf("paper's model, eq. (12)-(15): H %.0f px, p %.3g, q %.3g per px; %.2f mm RMS, %.2f mm max\n",
              static_cast<double>(fit.camera.paper.focal_px), static_cast<double>(fit.camera.paper.p_per_px),
              static_cast<double>(fit.camera.paper.q_per_px), fit.paper_residual_mm.rms, fit.paper_residual_mm.max);
  std::printf("%s: [picture], [field], [camera_model]%s written\n", venue.c_str(),
              polygon.empty() ? "" : ", [region_of_interest]");
  return 0;
}

}  // namespace touchline::calibrate
