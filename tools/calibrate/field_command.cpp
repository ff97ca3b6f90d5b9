#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "tools/calibrate/border_search.h"
#include "tools/calibrate/camera_picture.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/field_fit.h"
#include "tools/calibrate/field_refinement.h"
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

Status load_photographs(const std::vector<std::string>& paths, std::vector<hal::Picture>& out, std::string& reason) {
  for (const std::string& path : paths) {
    hal::Picture picture;
    if (Status s = load_rgb(path, picture, reason); !s.ok()) return s;
    if (!out.empty() && (picture.width_px != out[0].width_px || picture.height_px != out[0].height_px)) {
      reason = text("%s is %u x %u, but %s is %u x %u", path.c_str(), picture.width_px, picture.height_px,
                    paths[0].c_str(), out[0].width_px, out[0].height_px);
      return ErrorCode::kInconsistent;
    }
    out.push_back(std::move(picture));
  }
  return {};
}

// x runs along the longer sides; in the picture to the right, or upwards.
Corners along_the_field(const Corners& corners, const FieldParameters& field) {
  const auto distance = [&](std::size_t a, std::size_t b) {
    return std::hypot(static_cast<double>(corners[a].u_px - corners[b].u_px),
                      static_cast<double>(corners[a].v_px - corners[b].v_px));
  };
  const bool lies = distance(0, 1) + distance(2, 3) >= distance(1, 2) + distance(3, 0);
  if (lies == (field.length_m >= field.width_m)) return corners;
  return {corners[1], corners[2], corners[3], corners[0]};
}

// What was found without a click, in the order of Klancar's section 6.2.
std::string describe_steps(const BorderSearch& border) {
  std::string steps =
      text("border: brighter than %d of 255, %zu pixels along it\n", border.threshold, border.outline.size());
  steps += text("Hough transform: sides of %zu, %zu, %zu and %zu pixels (bottom, right, top, left)\n",
                border.sides[0].votes, border.sides[1].votes, border.sides[2].votes, border.sides[3].votes);
  steps += border.h_px < kLargestH_px ? text("three points on each side: H %.0f px\n", border.h_px)
                                      : std::string("three points on each side: straight, no H\n");
  steps += "corners at";
  for (const PixelPoint& corner : border.corners) {
    steps += text(" %.1f,%.1f", static_cast<double>(corner.u_px), static_cast<double>(corner.v_px));
  }
  return steps + " px\n";
}

// Few enough that a person sees the photograph below.
std::vector<FloorPoint> points_of(const RefinementReport& refinement) {
  std::vector<FloorPoint> points;
  for (std::size_t i = 0; i < refinement.found.size(); i += 10) {
    const MarkPoint& p = refinement.found[i];
    points.push_back({p.x_m, p.y_m, p.u_px, p.v_px});
  }
  return points;
}

}  // namespace

void FieldCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures, "Picture of the field as the camera delivers it; several are averaged")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; made when it does not exist")->required();
  app.add_option("--corners", corners,
                 "Pixels u,v of the field's corners: -x-y +x-y +x+y -x+y (x along the field); without corners\n"
                 "and points the bright border is looked for, and x runs to the right or upwards in the picture")
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
  app.add_flag("!--no-refine", refine, "Keep to the points given: do not look for the field's border in the picture");
  app.add_option("--roi", region, "Pixels u,v of the region of interest's corners, three or more");
  app.add_option("--preview", preview, "PNG to write: the field's border as the model sees it");
}

int FieldCommand::run() const {
  std::string reason;
  VenueDraft draft;
  if (!read_draft(venue, draft, reason).ok()) return refuse(reason);
  std::vector<hal::Picture> photographs;
  if (!load_photographs(pictures, photographs, reason).ok()) return refuse(reason);
  const hal::Picture& photograph = photographs[0];

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
  input.width_px = static_cast<int>(photograph.width_px);
  input.height_px = static_cast<int>(photograph.height_px);
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
  std::string steps;
  if (input.points.empty()) {
    BorderSearch border;
    if (!find_border(photograph, border, reason).ok()) {
      return refuse("no --corners and no --point are given, and in " + pictures[0] + " " + reason);
    }
    steps = describe_steps(border);
    const Corners corners_found = along_the_field(border.corners, field);
    input.points =
        corner_points(corners_found, static_cast<double>(field.length_m), static_cast<double>(field.width_m));
  } else if (input.points.size() < 4) {
    return refuse("of corners and points there must be four, or none");
  }
  const bool clicked = steps.empty();

  std::vector<PixelPoint> polygon;
  if (!read_pixels(region, "--roi", polygon, reason).ok()) return refuse(reason);
  if (!polygon.empty() && (polygon.size() < 3 || polygon.size() > kMaxPolygonPoints)) {
    return refuse(text("--roi: %zu corners; from 3 to %zu are possible", polygon.size(), kMaxPolygonPoints));
  }

  FieldFit fit;
  RefinementReport refinement;
  std::string unrefined;
  input.start_only = refine;
  if (!fit_field(input, fit, reason).ok()) {
    return refuse(
        clicked ? reason : "what looks like a border in " + pictures[0] + " is none: " + reason + " (--corners helps)");
  }
  if (refine &&
      !refine_field(LightPicture(photographs), field, input.camera_height_m, fit, refinement, unrefined).ok()) {
    // What nobody clicked on must prove itself.
    if (!clicked) return refuse("a border is seen in " + pictures[0] + ", but " + unrefined + "; give --corners");
    refinement = {};
    input.start_only = false;
    if (!fit_field(input, fit, reason).ok()) return refuse(reason + "; and " + unrefined);
  }
  fit.camera.kind = kind == "paper" ? CameraModelKind::kPaper : CameraModelKind::kFull;

  const std::string height =
      text("camera %.3f m (+- %.3f) above the floor, %.1f degrees off the vertical%s", fit.height_m, fit.height_sigma_m,
           fit.tilt_rad * 180.0 / 3.14159265358979, camera_height_m > 0 ? ", height given" : "");
  const std::string residual =
      refinement.points == 0
          ? text("%zu points: %.2f px RMS, %.2f px max; %.2f mm RMS, %.2f mm max", input.points.size(),
                 fit.residual_px.rms, fit.residual_px.max, fit.residual_mm.rms, fit.residual_mm.max)
          : text(
                "%zu points of border and center line: %.2f px RMS, p95 %.2f, max %.2f; %.2f mm RMS, p95 %.2f, max "
                "%.2f "
                "(%zu left out)",
                refinement.points, refinement.rms_px, refinement.p95_px, refinement.max_px, refinement.rms_mm,
                refinement.p95_mm, refinement.max_mm, refinement.outliers);
  config::PictureEntry entry = draft.file.picture;
  entry.width_px = static_cast<std::uint16_t>(photograph.width_px);
  entry.height_px = static_cast<std::uint16_t>(photograph.height_px);
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
    hal::Picture drawn = photograph;
    CameraModel camera;
    if (!camera.configure(fit.camera).ok()) return refuse("the model found cannot be used");
    draw_field(camera, field, refinement.points == 0 ? input.points : points_of(refinement), drawn);
    if (!hal::write_picture(preview, drawn, reason).ok()) return refuse(reason);
  }
  if (!write_sections(venue, sections, reason).ok()) return refuse(reason);

  std::printf("%s%s\n%s\n", steps.c_str(), height.c_str(), residual.c_str());
  if (!unrefined.empty()) std::printf("not refined along the border: %s\n", unrefined.c_str());
  const FullModelParameters& full = fit.camera.full;
  if (fit.has_distortion) {
    std::printf("lens: focal lengths %.1f and %.1f px, center %.1f, %.1f px, k %.4f %.4f %.4f, p %.5f %.5f\n",
                static_cast<double>(full.fx_px), static_cast<double>(full.fy_px), static_cast<double>(full.cx_px),
                static_cast<double>(full.cy_px), static_cast<double>(full.k1), static_cast<double>(full.k2),
                static_cast<double>(full.k3), static_cast<double>(full.p1), static_cast<double>(full.p2));
  } else {
    std::printf("lens: focal length %.1f px; its distortion needs the border, or two more points than the corners\n",
                static_cast<double>(full.fx_px));
  }
  std::printf("paper's model, eq. (12)-(15): H %.0f px, p %.3g, q %.3g per px; %.2f mm RMS, %.2f mm max\n",
              static_cast<double>(fit.camera.paper.focal_px), static_cast<double>(fit.camera.paper.p_per_px),
              static_cast<double>(fit.camera.paper.q_per_px), fit.paper_residual_mm.rms, fit.paper_residual_mm.max);
  std::printf("%s: [picture], [field], [camera_model]%s written\n", venue.c_str(),
              polygon.empty() ? "" : ", [region_of_interest]");
  return 0;
}

}  // namespace touchline::calibrate
