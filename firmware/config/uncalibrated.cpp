#include "firmware/config/uncalibrated.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>

#include "core/geometry/camera_model.h"
#include "firmware/config/poses.h"

namespace touchline::config {
namespace {

namespace fs = std::filesystem;

// Size of the field and height of the camera in most teams' rooms.
constexpr float kUsualLengthM = 1.5f, kUsualWidthM = 1.3f, kUsualHeightM = 2.0f;
// Focal length relative to the picture width at which the field fills most of the picture.
constexpr float kFocalOfWidth = 0.9f;

// Compares the sizes as resolve_venue() does.
bool has_other_size(const Configuration& configuration) {
  const PictureEntry& calibrated = configuration.venue.picture;
  const hal::CameraSettings& camera = configuration.board.camera;
  return calibrated.width_px != camera.width_px || calibrated.height_px != camera.height_px;
}

bool has_other_colors(const Configuration& configuration) {
  return configuration.venue.colors.space != color_space(hal::pixel_format(configuration.board.camera.format));
}

}  // namespace

bool has_camera_model(const Configuration& configuration) {
  if (has_other_size(configuration)) return false;
  const CameraParameters& camera = configuration.venue.camera_model;
  const char* const model = camera.kind == CameraModelKind::kFull ? "camera_model.full" : "camera_model.paper";
  return configuration.venue_where.has(model) && CameraModel().configure(camera).ok();
}

bool lacks_calibration(const Configuration& configuration) {
  if (takes_poses(configuration.board)) return false;  // there is nothing to calibrate
  const Locations& where = configuration.venue_where;
  std::error_code unknown;
  if (!where.file().empty() && fs::status(where.file(), unknown).type() == fs::file_type::not_found) return true;
  const bool was_read = where.has("picture") || where.has("field") || where.has("version");
  if (!was_read) return false;
  if (configuration.venue.color.empty() || !where.has("camera_model")) return true;
  return configuration.board_where.has("camera.backend") &&
         (has_other_size(configuration) || has_other_colors(configuration));
}

void do_without_calibration(Configuration& configuration) {
  const hal::CameraSettings& picture = configuration.board.camera;
  PipelineParameters& out = configuration.pipeline;
  const KernelChoice kernel = out.scan.kernel;
  const float low_battery_v = out.low_battery_v;
  out = *std::make_unique<PipelineParameters>();  // on the heap, because it is too large for the stack
  out.scan.kernel = kernel;
  out.low_battery_v = low_battery_v;
  out.scan.format = hal::pixel_format(picture.format);
  out.scan.width_px = picture.width_px;
  out.scan.height_px = picture.height_px;
  out.adaptation.mode = AdaptationMode::kOff;
  FieldParameters& field = out.marker.field;
  field = configuration.venue.field;
  if (!(field.length_m > 0.0f)) field.length_m = kUsualLengthM;
  if (!(field.width_m > 0.0f)) field.width_m = kUsualWidthM;
  if (has_camera_model(configuration)) {
    out.camera = configuration.venue.camera_model;
    return;
  }
  FullModelParameters model;
  model.fx_px = model.fy_px = kFocalOfWidth * static_cast<float>(picture.width_px);
  model.cx_px = static_cast<float>(picture.width_px) / 2;
  model.cy_px = static_cast<float>(picture.height_px) / 2;
  model.rotation_rad = {std::numbers::pi_v<float>, 0.0f, 0.0f};  // the camera looks down
  model.position_m = {0.0f, 0.0f, std::max(kUsualHeightM, field.length_m)};
  out.camera = {};
  out.camera.kind = CameraModelKind::kFull;
  out.camera.full = model;
}

}  // namespace touchline::config
