#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "tools/programs/calibrate/imaging/camera_picture.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/rectify/rectification.h"
#include "tools/programs/rectify/straightness.h"

namespace touchline::rectify {
namespace {

struct Options {
  std::string picture, venue, out, kind;
  double scale_px_per_m = 0, margin_m = 0.1, grid_m = 0;
};

// Returns the requested models that the file contains, the one in use first.
std::vector<CameraParameters> models_of(const CameraParameters& venue, const std::string& kind) {
  std::vector<CameraParameters> models;
  for (const bool other : {false, true}) {
    CameraParameters model = venue;
    if (other) {
      model.kind = venue.kind == CameraModelKind::kFull ? CameraModelKind::kPaper : CameraModelKind::kFull;
    }
    const bool wanted = kind.empty() || (kind == "full") == (model.kind == CameraModelKind::kFull);
    CameraModel camera;
    if (wanted && camera.configure(model).ok()) models.push_back(model);
  }
  return models;
}

void print_table(const char* kind, const std::array<SideStraightness, 4>& sides) {
  constexpr std::array<const char*, 4> kNames{"-y", "+x", "+y", "-x"};
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const SideStraightness& s = sides[i];
    if (s.points < 3) {
      std::printf("%-5s %s    not found\n", kind, kNames[i]);
      continue;
    }
    std::printf("%-5s %s %6zu %8zu %9.3f %7.3f %9.3f %7.3f %9.3f %7.3f %7.3f\n", kind, kNames[i], s.points, s.left_out,
                s.distorted.rms_px, s.distorted.rms_mm, s.straightened.rms_px, s.straightened.rms_mm,
                s.rectified.rms_px, s.rectified.rms_mm, s.rectified.max_mm);
  }
}

Result<void> run(const Options& options) {
  namespace fs = std::filesystem;
  TOUCHLINE_TRY_ASSIGN(const calibrate::VenueDraft draft, calibrate::read_draft(options.venue));
  if (!draft.exists)
    return Error{ErrorCode::kInconsistent, options.venue + ": no such file; touchline-calibrate field creates it"};
  const auto models = models_of(draft.file.camera_model, options.kind);
  if (models.empty()) {
    return Error{ErrorCode::kInconsistent, options.venue + ": [camera_model]" +
                                               (options.kind.empty() ? "" : "." + options.kind) +
                                               " has no camera model; run touchline-calibrate field"};
  }
  TOUCHLINE_TRY_ASSIGN(const hal::Picture picture, calibrate::load_rgb(options.picture));
  if (picture.width_px != draft.file.picture.width_px || picture.height_px != draft.file.picture.height_px) {
    return Error{ErrorCode::kInconsistent, options.picture + " is " + std::to_string(picture.width_px) + " x " +
                                               std::to_string(picture.height_px) + ", but " + options.venue +
                                               " is for " + std::to_string(draft.file.picture.width_px) + " x " +
                                               std::to_string(draft.file.picture.height_px)};
  }
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return Error{ErrorCode::kInconsistent, options.out + ": cannot be created: " + error.message()};
  const std::string stem = (fs::path(options.out) / fs::path(options.picture).stem()).string();
  std::vector<std::string> written;
  const auto write = [&](const std::string& name, const hal::Picture& figure) -> Result<void> {
    written.push_back(name + " (" + std::to_string(figure.width_px) + " x " + std::to_string(figure.height_px) + ")");
    return hal::write_picture(name, figure);
  };
  TOUCHLINE_TRY(write(stem + "-distorted.png", picture));

  CameraModel in_use;
  if (!in_use.configure(models[0]).ok())
    return Error{ErrorCode::kInconsistent, options.venue + ": the camera model is invalid"};
  std::array<std::size_t, 4> left_out{};
  const auto points = border_points(picture, in_use, draft.file.field, left_out);
  std::printf(
      "straightness of the border: deviation of each side from a line in the camera's picture (fig. 11),\n"
      "with radial distortion corrected (fig. 12 a), and with radial and perspective corrected (fig. 12 b)\n"
      "%-10s%7s%9s%10s%8s%10s%8s%10s%8s%8s\n%-10s%7s%9s%10s%8s%10s%8s%10s%8s%8s\n",
      "", "", "", "distorted", "", "radial", "", "both", "", "", "model side", "points", "left out", "RMS px", "RMS mm",
      "RMS px", "RMS mm", "RMS px", "RMS mm", "max mm");
  for (const CameraParameters& model : models) {
    CameraModel camera;
    if (!camera.configure(model).ok()) continue;
    const LensMap lens(model);
    const char* kind = model.kind == CameraModelKind::kFull ? "full" : "paper";
    const double scale =
        options.scale_px_per_m > 0 ? options.scale_px_per_m : static_cast<double>(camera.scale_px_per_m({0, 0}, 0.0f));
    Raster raster;
    hal::Picture figure = straighten(picture, lens, raster);
    if (options.grid_m > 0) draw_grid(camera, lens, draft.file.field, options.grid_m, raster, figure);
    TOUCHLINE_TRY(write(stem + "-" + kind + "-radial.png", figure));
    Result<hal::Picture> floor = rectify_floor(picture, camera, draft.file.field, options.margin_m, scale, raster);
    if (!floor.ok()) {
      return failure(floor.code(), "%s; give a smaller --scale or --margin", floor.error().text.c_str());
    }
    if (options.grid_m > 0) draw_grid(draft.file.field, options.grid_m, raster, floor.value());
    TOUCHLINE_TRY(write(stem + "-" + kind + "-both.png", floor.value()));
    print_table(kind, straightness(points, left_out, camera, lens, scale));
  }
  for (const std::string& name : written) std::printf("%s written\n", name.c_str());
  return {};
}

}  // namespace
}  // namespace touchline::rectify

int main(int argc, char** argv) {
  touchline::rectify::Options options;
  CLI::App app(
      "Figures 11 and 12 of Klancar et al. for any picture: NAME-distorted.png as the camera shows it,\n"
      "NAME-MODEL-radial.png with the lens corrected, NAME-MODEL-both.png with lens and perspective corrected\n"
      "(the floor to scale, x to the right, y up). MODEL is full or paper. Prints how straight the border is in each",
      "touchline-rectify");
  app.add_option("picture", options.picture, "A picture, or a video (its first frame)")->required()->type_name("FILE");
  app.add_option("--venue", options.venue, "Venue file with the camera model")->required()->type_name("FILE");
  app.add_option("--out", options.out, "Folder for the pictures; created if it does not exist")
      ->required()
      ->type_name("DIR");
  app.add_option("--kind", options.kind, "Camera model: full, or paper (eq. 12-15) (default: all in the venue file)")
      ->check(touchline::one_of({"full", "paper"}));
  app.add_option("--scale", options.scale_px_per_m,
                 "Pixels per meter of the floor (default: as in the center of the field)")
      ->check(touchline::number_range(10.0, 10000.0));
  app.add_option("--margin", options.margin_m, "Floor shown around the field and its goals, m")
      ->check(touchline::number_range(0.0, 5.0))
      ->capture_default_str();
  app.add_option("--grid", options.grid_m, "Draw lines this far apart (m) and the field's outline over the figures 12")
      ->check(touchline::number_range(0.01, 10.0));
  touchline::add_examples(
      app,
      {{"touchline-rectify empty.png --venue venue.toml --out rectified", "draw the figures with every camera model"},
       {"touchline-rectify empty.png --venue venue.toml --out rectified --kind full --grid 0.1",
        "draw lines 0.1 m apart over them"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;
  const touchline::Result<void> done = touchline::rectify::run(options);
  return done.ok() ? touchline::kExitOk : touchline::fail("touchline-rectify", done.text());
}
