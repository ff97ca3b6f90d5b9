#include "tools/programs/setup/color_step.h"

#include <algorithm>
#include <filesystem>

#include "core/light/shading.h"
#include "hal/files/input_file.h"
#include "tools/programs/calibrate/colors/color_calibration.h"
#include "tools/programs/calibrate/colors/field_reference.h"
#include "tools/programs/calibrate/colors/other_light.h"
#include "tools/programs/command_line/formatted.h"
#include "tools/programs/setup/color_mask.h"
#include "tools/programs/setup/page_state.h"

namespace touchline::setup {
namespace {

namespace fs = std::filesystem;

using calibrate::Click;

// Two colors closer than this are confused if the light changes a little (the same limit as in the advice of
// touchline-calibrate colors).
constexpr int kCloseLevels = 20;

nlohmann::json note(const char* level, const std::string& text) { return {{"level", level}, {"text", text}}; }

// Returns the clicks of the draft and the click of the request.
std::vector<Click> clicks_of(const nlohmann::json& measured, const ColorRequest& request) {
  std::vector<Click> clicks;
  if (const auto known = measured.find("clicks"); known != measured.end()) {
    for (const nlohmann::json& one : *known) {
      Click& click = clicks.emplace_back();
      click.color = one.at("name").get_ref<const std::string&>();
      click.u_px = one.at("u_px").get<double>();
      click.v_px = one.at("v_px").get<double>();
      // A click that came with the first picture was stored before this picture had an id.
      const nlohmann::json& ids = measured.at("pictures");
      const auto id = std::find(ids.begin(), ids.end(), one.at("picture"));
      click.image = color_image(id == ids.end() ? 0 : static_cast<std::size_t>(id - ids.begin()));
    }
  }
  if (request.removed_click && *request.removed_click < clicks.size()) {
    clicks.erase(clicks.begin() + static_cast<std::ptrdiff_t>(*request.removed_click));
  }
  if (request.click) clicks.push_back(*request.click);
  return clicks;
}

std::size_t number_of(const std::string& image) {
  std::size_t number = 0;
  while (color_image(number) != image) ++number;
  return number;
}

// `pictures`: ids. The first click may come with the first picture, which has no id yet.
nlohmann::json clicks_json(const std::vector<Click>& clicks, const std::vector<calibrate::ClickUse>& uses,
                           const nlohmann::json& pictures) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < clicks.size(); ++i) {
    const std::size_t number = number_of(clicks[i].image);
    out.push_back({{"name", clicks[i].color},
                   {"u_px", clicks[i].u_px},
                   {"v_px", clicks[i].v_px},
                   {"picture", number < pictures.size() ? pictures[number] : nlohmann::json()},
                   {"used", i < uses.size() && uses[i].used},
                   {"reason", i < uses.size() ? uses[i].reason : std::string()}});
  }
  return out;
}

void add_fit(const calibrate::ColorFit& fit, nlohmann::json& measured) {
  measured["confusion"] = {{"names", fit.names}, {"rows", fit.confusion}};
  measured["margins"] = nlohmann::json::array();
  for (const calibrate::PairMargin& margin : fit.learned.margins) {
    measured["margins"].push_back(
        {{"a", fit.names[margin.first]}, {"b", fit.names[margin.second]}, {"levels", margin.levels}});
  }
  measured["advice"] = nlohmann::json::array();
  for (const calibrate::ColorReplacement& e : fit.advice.replacements) {
    measured["advice"].push_back(
        formatted("%s and %s are only %d levels apart: replace %s by %s, which would be %d levels "
                  "from all others",
                  fit.names[e.first].c_str(), fit.names[e.second].c_str(), e.levels, fit.names[e.replaced].c_str(),
                  e.suggestion.name.c_str(), e.suggestion.levels));
  }
  for (std::size_t c = 0; c < fit.names.size(); ++c) {
    if (fit.learned.cut_share[c] > 0.05) {
      measured["notes"].push_back(note("warning", formatted("%s lost %.0f %% of its pixels to other colors",
                                                            fit.names[c].c_str(), 100 * fit.learned.cut_share[c])));
    }
  }
}

// Shows the page the pictures that a calibration has written into its folder, in the order of the images.
Result<void> show_files(const std::string& folder, const std::string& ending, const char* member, const JobInput& input,
                        const JobOutput& output) {
  for (std::size_t i = 0; i < input.state.color_frames.size(); ++i) {
    const std::string path =
        formatted("%s/%s%s", folder.c_str(), fs::path(color_image(i)).stem().c_str(), ending.c_str());
    const Result<std::string> png = hal::read_file(path, hal::kMaxDataFileBytes);
    if (png.code() == ErrorCode::kNotFound) continue;
    if (!png.ok()) return png.error();
    const Frame frame = input.state.color_frames[i]->frame();
    output.encoded_picture(member, frame.width_px, frame.height_px, png.value(), true);
  }
  return {};
}

// Returns the mask of pixels whose class the new colors change, in the last picture (the picture of the click).
Result<std::string> mask_of(const calibrate::VenueDraft& venue, const std::string& venue_path, const Frame& frame) {
  TOUCHLINE_TRY_ASSIGN(const calibrate::VenueDraft learned, calibrate::read_draft(venue_path));
  const auto shading = std::make_unique<Shading>();
  if (const Status built = shading->build(venue.light, frame.width_px, frame.height_px, color_space(frame.format));
      !built.ok()) {
    return failure(built.code(), "the light map does not fit (%s)", describe(built.code()));
  }
  return color_change_mask(calibrate::corrected_channels(frame, *shading), venue.file.color, learned.file.color);
}

}  // namespace

std::string color_image(std::size_t number) { return formatted("picture-%zu.png", number + 1); }

Result<void> show_color_picture(const JobInput& input, const JobOutput& output) {
  return output.picture("pictures", calibrate::picture_of(input.state.color_frames.back()->frame()), true);
}

Result<void> learn_colors(const ColorRequest& request, const JobInput& input, const JobOutput& output) {
  const std::string venue = input.path(input.state.files.venue), team = input.path(input.state.files.team);
  const std::string folder = input.folder + "/colors";
  TOUCHLINE_TRY_ASSIGN(const calibrate::VenueDraft draft, calibrate::read_draft(venue));
  TOUCHLINE_TRY_ASSIGN(calibrate::TeamColors wanted, calibrate::read_team_colors(team));
  const calibrate::ColorFiles files{venue, team, draft, std::move(wanted)};
  const auto former = input.state.measured.find("colors");
  nlohmann::json measured = {
      {"notes", nlohmann::json::array()}, {"self_check", ""}, {"pictures", nlohmann::json::array()}};
  if (former != input.state.measured.end() && former->contains("pictures"))
    measured["pictures"] = former->at("pictures");

  calibrate::ColorFitInput fit_input;
  for (std::size_t i = 0; i < input.state.color_frames.size(); ++i) {
    fit_input.pictures[color_image(i)] = *input.state.color_frames[i];
  }
  if (fit_input.pictures.empty()) return Error{ErrorCode::kNotFound, "there is no picture of robots and ball"};
  std::vector<Click> clicks =
      clicks_of(former != input.state.measured.end() ? *former : nlohmann::json::object(), request);
  // Drop clicks on colors that the robots no longer have.
  std::erase_if(clicks, [&](const Click& click) {
    return std::find(files.colors.names.begin(), files.colors.names.end(), click.color) == files.colors.names.end();
  });
  fit_input.light = draft.light;
  fit_input.region_of_interest = draft.region_of_interest;
  output.progress("patches and robots are being searched", 0.1);
  fit_input.clicks = clicks;
  TOUCHLINE_TRY_ASSIGN(const calibrate::DetectedColors found, calibrate::detect_with_clicks(files, fit_input));
  if (const std::string left_out = calibrate::describe_left_out(found, fit_input); !left_out.empty()) {
    measured["notes"].push_back(note("warning", left_out));
  }
  if (const std::string scales = calibrate::describe_scales(found.scales); !scales.empty())
    measured["notes"].push_back(note("warning", scales));
  if (!found.unlisted.empty()) measured["notes"].push_back(note("warning", found.unlisted));
  measured["clicks"] = clicks_json(clicks, found.uses, measured["pictures"]);
  std::error_code error;
  fs::create_directories(folder, error);
  for (const auto& [image, picture] : fit_input.pictures) {
    const std::string path = folder + "/" + fs::path(image).stem().string() + "-found.png";
    TOUCHLINE_TRY(calibrate::write_detection_picture(path, found, image, picture));
  }
  Result<calibrate::VisibleByPicture> visible = calibrate::take_detected(found, fit_input);
  if (!visible.ok()) {
    for (const calibrate::DetectionDoubt& doubt : found.doubts) {
      measured["notes"].push_back(note("bad", doubt.text));
    }
    measured["quality"] = quality("bad", "the colors are not certain: click on what is named below");
    output.measured(measured);
    return show_files(folder, "-found.png", "found", input, output);
  }
  TOUCHLINE_TRY(calibrate::check_all_colors(input.state.files.team, files.colors, fit_input.clicks));
  output.progress("the colors are being learned", 0.5);
  TOUCHLINE_TRY_ASSIGN(const calibrate::ColorFit fit, calibrate::fit_colors(fit_input));
  add_fit(fit, measured);
  for (const calibrate::OddColor& odd : calibrate::find_odd_colors(fit, request.odd_colors)) {
    measured["notes"].push_back(note("warning", odd.name + ": the patches found look " + odd.looks));
  }
  std::vector<calibrate::Section> sections = calibrate::color_sections(draft, fit);
  TOUCHLINE_TRY(calibrate::write_sections(venue, sections));
  output.progress("the result is being checked", 0.8);
  TOUCHLINE_TRY_ASSIGN(calibrate::SelfCheck check,
                       calibrate::self_check(venue, team, fit_input.pictures, visible.value(), folder));
  TOUCHLINE_TRY(calibrate::check_other_light(venue, team, fit_input.pictures, visible.value(), check));
  if (const calibrate::OtherLightResult* const other = check.fragile_in(); other != nullptr) {
    measured["notes"].push_back(
        note("bad", formatted("only %zu of %zu robots are recognized %s: add a picture in other light, or replace "
                              "colors that are close to others",
                              other->robots, check.robots_explained(), other->light.c_str())));
  }
  measured["self_check"] = check.text();
  TOUCHLINE_TRY_ASSIGN(const calibrate::Section light, calibrate::write_field_reference(venue, draft, fit_input, fit));
  TOUCHLINE_TRY(calibrate::write_sections(venue, {light}));
  const std::size_t recognized = check.robots.size() - check.missing().size();
  const bool is_close = !fit.learned.margins.empty() && fit.learned.margins.front().levels < kCloseLevels;
  measured["quality"] =
      quality(!check.passed()                          ? "bad"
              : is_close || !measured["notes"].empty() ? "warning"
                                                       : "ok",
              formatted("%zu of %zu robots recognized in the pictures", recognized, check.robots.size()),
              fit.learned.margins.empty() ? 0 : fit.learned.margins.front().levels, "levels");
  output.measured(measured);
  TOUCHLINE_TRY(show_files(folder, "-found.png", "found", input, output));
  TOUCHLINE_TRY(show_files(folder, "-check.png", "checks", input, output));
  if (draft.file.color.empty()) return {};
  const std::size_t number = request.click ? number_of(request.click->image) : input.state.color_frames.size() - 1;
  const Frame frame = input.state.color_frames[number]->frame();
  TOUCHLINE_TRY_ASSIGN(const std::string mask, mask_of(draft, venue, frame));
  output.encoded_picture("mask", frame.width_px, frame.height_px, mask);
  return {};
}

}  // namespace touchline::setup
