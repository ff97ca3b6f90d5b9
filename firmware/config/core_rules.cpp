#include "firmware/config/core_rules.h"

#include <array>
#include <memory>
#include <string>

#include "core/adaptation.h"
#include "core/control/controller.h"
#include "core/geometry/camera_model.h"
#include "core/marker/matcher.h"
#include "core/region/region_of_interest.h"
#include "core/region/region_scanner.h"
#include "core/track/tracker.h"

namespace touchline::config {
namespace {

// A rule of a stage of the pipeline: the section of a file that configures the stage, and the status with which the
// stage accepts or rejects it.
struct CoreRule {
  std::string_view stage;  // only the first broken rule of a stage is reported
  const Locations Configuration::*file;
  std::string (*key)(const PipelineParameters& parameters);
  std::string_view message;  // what to correct; empty: only the core's status is known
  Status (*check)(const PipelineParameters& parameters);
};

template <class Stage>
std::unique_ptr<Stage> make() {
  return std::make_unique<Stage>();  // on the heap, because stages are too large for the stack
}

std::string model_key(const PipelineParameters& p) {
  return p.camera.kind == CameraModelKind::kFull ? "camera_model.full" : "camera_model.paper";
}

Status above_zero(float value) { return value > 0.0f ? Status() : Status(ErrorCode::kOutOfRange); }

// The model that is not in use may be empty, so the declared ranges of its keys include 0.
Status check_focal_length(const PipelineParameters& p) {
  return above_zero(p.camera.kind == CameraModelKind::kFull ? p.camera.full.fx_px : p.camera.paper.focal_px);
}

Status check_focal_length_of_columns(const PipelineParameters& p) {
  return p.camera.kind == CameraModelKind::kFull ? above_zero(p.camera.full.fy_px) : Status();
}

Status check_camera_height(const PipelineParameters& p) {
  return above_zero(p.camera.kind == CameraModelKind::kFull ? p.camera.full.position_m[2]
                                                            : p.camera.paper.position_m[2]);
}

bool is_of_pictures(std::string_view stage) { return stage != "track" && stage != "control"; }

const std::array rules{
    CoreRule{"camera", &Configuration::venue_where,
             [](const PipelineParameters& p) {
               return model_key(p) + (p.camera.kind == CameraModelKind::kFull ? ".fx_px" : ".focal_px");
             },
             "must be above 0; run touchline-calibrate field", check_focal_length},
    CoreRule{"camera", &Configuration::venue_where, [](const PipelineParameters& p) { return model_key(p) + ".fy_px"; },
             "must be above 0; run touchline-calibrate field", check_focal_length_of_columns},
    CoreRule{"camera", &Configuration::venue_where,
             [](const PipelineParameters& p) { return model_key(p) + ".position_m"; },
             "the third value, the height of the camera above the floor, must be above 0", check_camera_height},
    CoreRule{"camera", &Configuration::venue_where,
             [](const PipelineParameters& p) {
               return p.camera.kind == CameraModelKind::kPaper ? model_key(p) + ".affine" : model_key(p);
             },
             "does not map the picture to the whole floor; run touchline-calibrate field",
             [](const PipelineParameters& p) { return CameraModel().configure(p.camera); }},
    CoreRule{"scan", &Configuration::venue_where,
             [](const PipelineParameters&) { return std::string("region_of_interest"); },
             "covers no pixel; give the corners of the area that the camera shows of the field",
             [](const PipelineParameters& p) {
               return make<RegionOfInterest>()->build(p.scan.region_of_interest, p.scan.width_px, p.scan.height_px);
             }},
    CoreRule{"scan", &Configuration::venue_where, [](const PipelineParameters&) { return std::string("color"); }, "",
             [](const PipelineParameters& p) { return make<ScanTables>()->configure(p.scan); }},
    CoreRule{"scan", &Configuration::venue_where, [](const PipelineParameters&) { return std::string("adaptation"); },
             "",
             [](const PipelineParameters& p) {
               return make<Adaptation>()->configure(p.adaptation, p.scan, p.marker.ball.color);
             }},
    CoreRule{"marker", &Configuration::team_where, [](const PipelineParameters&) { return std::string("own"); }, "",
             [](const PipelineParameters& p) {
               CameraModel camera;
               const Status status = camera.configure(p.camera);
               return status.ok() ? make<Matcher>()->configure(p.marker, camera) : Status();  // reported above
             }},
    CoreRule{"track", &Configuration::team_where, [](const PipelineParameters&) { return std::string("tracking"); }, "",
             [](const PipelineParameters& p) { return make<Tracker>()->configure(p.track); }},
    CoreRule{"control", &Configuration::team_where, [](const PipelineParameters&) { return std::string("control"); },
             "", [](const PipelineParameters& p) { return make<Controller>()->configure(p.control, p.marker.field); }},
};

}  // namespace

void add_core_refusals(const Configuration& configuration, ErrorList& errors) {
  const PipelineParameters& parameters = configuration.pipeline;
  std::string_view reported;
  for (const CoreRule& rule : rules) {
    if (rule.stage == reported || (!parameters.has_pictures && is_of_pictures(rule.stage))) continue;
    const Status status = rule.check(parameters);
    if (status.ok()) continue;
    reported = rule.stage;
    const std::string key = rule.key(parameters);
    const Locations& where = configuration.*rule.file;
    errors.add(where.of(key), key,
               rule.message.empty() ? std::string("its values cannot be used: ") + describe(status.code())
                                    : std::string(rule.message));
  }
}

}  // namespace touchline::config
