#include "tools/programs/calibrate/venue/venue_draft.h"

#include <filesystem>

#include "firmware/config/file_backup.h"
#include "firmware/config/light_map_file.h"
#include "firmware/config/section_writer.h"
#include "firmware/config/toml_file.h"

namespace touchline::calibrate {
namespace {

// Checks all keys that are present and requires none.
struct DraftFile : config::VenueFile {
  static constexpr std::array<std::string_view, 0> kRequired{};
};

}  // namespace

bool has_camera_model(const VenueDraft& draft) {
  const CameraParameters& model = draft.file.camera_model;
  return (model.kind == CameraModelKind::kFull ? model.full.fx_px : model.paper.focal_px) > 0;
}

Result<VenueDraft> read_draft(const std::string& path) {
  VenueDraft out;
  std::error_code error;
  out.exists = std::filesystem::exists(path, error);
  if (!out.exists) return out;
  DraftFile file;
  config::Locations where;
  TOUCHLINE_TRY(config::read_toml(path, "", {}, file, where));
  out.file = file;
  const auto& roi = file.region_of_interest;
  if (roi.u_px.size() != roi.v_px.size() || roi.u_px.size() > kMaxPolygonPoints) {
    return failure(ErrorCode::kInconsistent,
                   "%s: region_of_interest: u_px and v_px need one value per corner, at most %zu",
                   where.of("region_of_interest").c_str(), kMaxPolygonPoints);
  }
  for (std::size_t i = 0; i < roi.u_px.size(); ++i) out.region_of_interest.push_back({roi.u_px[i], roi.v_px[i]});
  if (file.light.map.empty()) return out;
  const std::string map = (std::filesystem::path(path).parent_path() / file.light.map).string();
  Result<void> light = config::read_light_map(map, out.light);
  if (!light.ok()) return prefixed(where.of("light.map") + ": light.map", std::move(light).error());
  return out;
}

Result<void> write_sections(const std::string& path, const std::vector<Section>& sections) {
  TOUCHLINE_TRY_ASSIGN(const std::optional<std::string> text, config::read_text(path));
  std::string content = text.value_or(config::kNewFile);
  for (const Section& section : sections) {
    Result<std::string> changed = config::replace_section(content, section.name, section.toml);
    if (!changed.ok()) return prefixed(path, std::move(changed).error());
    content = std::move(changed).value();
  }
  return config::replace_file(path, content);
}

}  // namespace touchline::calibrate
