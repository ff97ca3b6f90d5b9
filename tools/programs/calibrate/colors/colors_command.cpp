#include "tools/programs/calibrate/colors/colors_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hal/device_parameters.h"
#include "hal/replay/picture.h"
#include "tools/programs/calibrate/colors/auto_detect.h"
#include "tools/programs/calibrate/colors/click_shadow.h"
#include "tools/programs/calibrate/colors/color_calibration.h"
#include "tools/programs/calibrate/colors/color_fit.h"
#include "tools/programs/calibrate/colors/colors_report.h"
#include "tools/programs/calibrate/colors/field_reference.h"
#include "tools/programs/calibrate/colors/other_light.h"
#include "tools/programs/calibrate/venue/confirmation.h"
#include "tools/programs/calibrate/venue/venue_draft.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

namespace fs = std::filesystem;

}  // namespace

void ColorsCommand::add_options(CLI::App& app) {
  app.add_option("--picture", pictures,
                 "Picture of standing robots and ball: detects the colors without clicks; repeatable")
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--samples", samples,
                 "JSON file of clicks: {\"samples\":[{\"image\",\"color\",\"u\",\"v\"}]}, or \"box\":[u0,v0,u1,v1]")
      ->type_name("FILE");
  app.add_option("--click", clicked,
                 "COLOR,U,V: pixel of a patch of this color in the first --picture, or COLOR,U,V,PICTURE; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--venue", venue, "Venue file; its camera model, light map and region of interest are used")
      ->required()
      ->type_name("FILE");
  app.add_option("--images", images, "Folder of the pictures in the JSON file (default: the folder of the JSON file)")
      ->type_name("DIR");
  app.add_option("--team", team, "Team file: each of its colors must have a click or be detected")->type_name("FILE");
  std::vector<std::string> formats;
  formats.reserve(hal::kCameraFormats.size());
  for (const Choice<hal::CameraFormat>& choice : hal::kCameraFormats) formats.emplace_back(choice.word);
  app.add_option("--format", format, "Format of the camera, as camera.format in board.toml")->check(one_of(formats));
  app.add_option("--patch-radius", patch_radius_px, "Greatest distance of a patch's pixels from the click, px")
      ->check(CLI::Range(3, 200));
  app.add_option("--preview", preview, "Folder for pictures of the detected patches and of classified pixels")
      ->type_name("DIR");
  app.add_flag("--yes", yes, "Accept colors that were detected without clicks, without asking");
  app.add_flag("--accept", accept,
               "Write the colors although the self-check missed robots or the ball in the pictures");
  app.add_option("--odd-color", odd_colors, "Color whose patches do not look like its name; repeatable")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_examples(
      app,
      {{"touchline-calibrate colors --picture robots.png --venue venue.toml --team team.toml --format yuyv",
        "find robots and ball, and ask whether they are right"},
       {"touchline-calibrate colors --picture robots.png --click orange,312,200 --venue venue.toml --team team.toml",
        "say where one patch of a color is"}});
}

// The default is a folder next to the venue file.
std::string ColorsCommand::preview_folder() const {
  if (!preview.empty()) return preview;
  const fs::path file(venue);
  return (file.parent_path() / (file.stem().string() + "-colors")).string();
}

// Reads clicks and pictures.
Result<void> ColorsCommand::read_input(ColorFitInput& input) const {
  if (samples.empty() && pictures.empty()) {
    return failure(ErrorCode::kNotFound, "either --picture or --samples is needed");
  }
  const auto pixel_format = format_of(format);
  if (!pixel_format) return failure(ErrorCode::kUnsupported, "--format: %s is unknown", format.c_str());
  if (!samples.empty()) {
    TOUCHLINE_TRY_ASSIGN(input.clicks, read_clicks(samples));
  }
  // Names of pictures in --click are used as in --picture; names in the JSON file are relative to its folder.
  const std::size_t from_file = input.clicks.size();
  for (const std::string& text : clicked) {
    TOUCHLINE_TRY_ASSIGN(Click click, parse_click(text, pictures.empty() ? "" : pictures.front()));
    if (click.image.empty()) return failure(ErrorCode::kNotFound, "--click %s: --picture is missing", text.c_str());
    input.clicks.push_back(std::move(click));
  }
  const auto load = [&](const std::string& path, const std::string& name) -> Result<void> {
    if (input.pictures.count(name) > 0) return {};
    TOUCHLINE_TRY_ASSIGN(input.pictures[name], CameraPicture::load(path, *pixel_format));
    return {};
  };
  const fs::path root = images.empty() ? fs::path(samples).parent_path() : fs::path(images);
  std::map<std::string, std::string> name_of;  // loads each picture once, whatever its name
  std::error_code error;
  for (std::size_t i = 0; i < input.clicks.size(); ++i) {
    Click& click = input.clicks[i];
    const std::string path = i < from_file ? (root / click.image).string() : click.image;
    const auto [known, is_new] = name_of.try_emplace(fs::weakly_canonical(path, error).string(), click.image);
    click.image = known->second;
    if (is_new) TOUCHLINE_TRY(load(path, click.image));
  }
  for (const std::string& path : pictures) {
    if (name_of.count(fs::weakly_canonical(path, error).string()) == 0) TOUCHLINE_TRY(load(path, path));
  }
  return {};
}

// Checks that all pictures have the size for which the camera model was made.
Result<void> ColorsCommand::check_size(const VenueDraft& draft, const ColorFitInput& input) const {
  if (!has_camera_model(draft)) return {};
  const config::PictureEntry& expected = draft.file.picture;
  for (const auto& [image, picture] : input.pictures) {
    const Frame frame = picture.frame();
    if (frame.width_px == expected.width_px && frame.height_px == expected.height_px) continue;
    return failure(
        ErrorCode::kInconsistent,
        "%s is %u x %u, but the camera model of %s is for pictures of %u x %u: take the picture as the camera "
        "delivers it (touchline-calibrate picture), or calibrate the field anew",
        image.c_str(), frame.width_px, frame.height_px, venue.c_str(), expected.width_px, expected.height_px);
  }
  return {};
}

// Replaces the clicks by the patches that were detected with their help, after a person has confirmed them.
Result<void> ColorsCommand::detect_colors(const VenueDraft& draft, const TeamColors& wanted, ColorFitInput& input,
                                          VisibleByPicture& visible) const {
  if (team.empty()) return failure(ErrorCode::kNotFound, "--picture needs --team, which names the colors to detect");
  TOUCHLINE_TRY_ASSIGN(const DetectedColors found, detect_with_clicks({venue, team, draft, wanted}, input));
  print_detected(found);
  if (const std::string left_out = describe_left_out(found, input); !left_out.empty()) {
    std::printf("%s\n", left_out.c_str());
  }
  if (const std::string scales = describe_scales(found.scales); !scales.empty()) std::printf("%s\n", scales.c_str());
  if (!found.unlisted.empty()) std::printf("%s\n", found.unlisted.c_str());
  print_unused(input.clicks, found.uses);
  const std::string folder = preview_folder();
  std::error_code error;
  fs::create_directories(folder, error);
  for (const auto& [image, picture] : input.pictures) {
    const std::string path = (fs::path(folder) / (fs::path(image).stem().string() + "-found.png")).string();
    TOUCHLINE_TRY(write_detection_picture(path, found, image, picture));
  }
  std::printf("pictures of the result are in %s\n", folder.c_str());
  TOUCHLINE_TRY_ASSIGN(visible, take_detected(found, input));
  const bool all_clicked = std::all_of(found.input.colors.begin(), found.input.colors.end(),
                                       [](const WantedColor& color) { return color.clicked; });
  if (!all_clicked && !yes && !confirmed("are these colors right?")) {
    return failure(ErrorCode::kInconsistent,
                   "not confirmed, nothing was written: check the pictures in %s, then run this again with --yes",
                   folder.c_str());
  }
  return {};
}

Result<void> ColorsCommand::check_names(const ColorFit& fit) const {
  std::string text;
  for (const OddColor& odd : find_odd_colors(fit, odd_colors)) {
    text += formatted("\n  %s: the patches found look %s (%.0f %.0f %.0f); if they are right, add --odd-color %s",
                      odd.name.c_str(), odd.looks.c_str(), odd.rgb[0], odd.rgb[1], odd.rgb[2], odd.name.c_str());
  }
  if (text.empty()) return {};
  return Error{ErrorCode::kInconsistent, "nothing was written, because colors do not look like their names:" + text};
}

// Runs the pipeline with the new colors on the pictures that they were learned from. The venue file is only replaced if
// everything was recognized, or if the person accepts it.
Result<void> ColorsCommand::check_result(const ColorFitInput& input, const std::vector<Section>& sections,
                                         const VisibleByPicture& visible) const {
  const fs::path file(venue);
  const std::string unaccepted =
      (file.parent_path() / (file.stem().string() + "-unaccepted" + file.extension().string())).string();
  TOUCHLINE_TRY(write_copy(venue, sections, unaccepted));
  const std::string folder = preview_folder();
  TOUCHLINE_TRY_ASSIGN(SelfCheck check, self_check(unaccepted, team, input.pictures, visible, folder));
  TOUCHLINE_TRY(check_other_light(unaccepted, team, input.pictures, visible, check));
  std::printf("%spictures of the self-check are in %s\n", check.text().c_str(), folder.c_str());
  if (!check.passed() && !accept) {
    if (const std::string absent = check.absent(); !absent.empty()) {
      return failure(
          ErrorCode::kInconsistent,
          "all robots that were found are recognized, but no picture shows %s: %s is unchanged, the new colors are "
          "in %s. Show a further picture (--picture) with the missing robots; or, if they stand in glare or shade, "
          "click on their patches (--click COLOR,U,V); or write the colors as they are (--accept)",
          absent.c_str(), venue.c_str(), unaccepted.c_str());
    }
    if (const OtherLightResult* const other = check.fragile_in(); other != nullptr) {
      return failure(ErrorCode::kInconsistent,
                     "only %zu of %zu robots are recognized %s: the boxes of the colors leave hardly any margin. %s is "
                     "unchanged, the "
                     "new colors are in %s. Show further pictures (--picture) in other light, measure patches that "
                     "differ from the layout, replace colors that are close to others; or write the colors as they are "
                     "(--accept)",
                     other->robots, check.robots_explained(), other->light.c_str(), venue.c_str(), unaccepted.c_str());
    }
    return failure(ErrorCode::kInconsistent,
                   "not everything was recognized: %s is unchanged, the new colors are in %s. Show a further picture "
                   "(--picture) in which the missing objects stand elsewhere, apart from all others; or click on their "
                   "patches (--click COLOR,U,V); or write the colors as they are (--accept)",
                   venue.c_str(), unaccepted.c_str());
  }
  std::error_code error;
  fs::remove(unaccepted, error);
  return {};
}

Result<void> ColorsCommand::run() const {
  // Checks the team file first, because no pictures help if no colors can fit it.
  TeamColors wanted;
  if (!team.empty()) {
    TOUCHLINE_TRY_ASSIGN(wanted, read_team_colors(team));
  }
  TOUCHLINE_TRY_ASSIGN(const VenueDraft draft, read_draft(venue));
  ColorFitInput input;
  TOUCHLINE_TRY(read_input(input));
  TOUCHLINE_TRY(check_size(draft, input));
  input.light = draft.light;
  input.region_of_interest = draft.region_of_interest;
  input.growth.radius_px = patch_radius_px;
  TOUCHLINE_TRY_ASSIGN(const std::vector<ShadowedClick> shadowed,
                       clicks_in_shadow(input.clicks, input.pictures, input.light, input.region_of_interest));
  for (const ShadowedClick& one : shadowed) {
    std::printf("%s\n", describe_shadow(one, input.clicks, input.light.columns > 0).c_str());
  }
  // Without a camera model or a team file, colors can be learned from clicks only.
  VisibleByPicture visible;
  const bool can_detect = !team.empty() && has_camera_model(draft);
  if (can_detect || !pictures.empty()) TOUCHLINE_TRY(detect_colors(draft, wanted, input, visible));
  if (!team.empty()) TOUCHLINE_TRY(check_all_colors(team, wanted, input.clicks));
  TOUCHLINE_TRY_ASSIGN(const ColorFit fit, fit_colors(input));
  print_report(input, fit);
  TOUCHLINE_TRY(check_names(fit));

  // The check needs no reference of the field.
  std::vector<Section> sections = color_sections(draft, fit);
  if (can_detect) TOUCHLINE_TRY(check_result(input, sections, visible));
  TOUCHLINE_TRY_ASSIGN(sections[0], write_field_reference(venue, draft, input, fit));
  TOUCHLINE_TRY(write_sections(venue, sections));
  std::printf("%s: %zu colors in %zu boxes written\n", venue.c_str(), fit.names.size(), fit.learned.boxes.size());
  if (preview.empty()) return {};
  std::error_code error;
  fs::create_directories(preview, error);
  for (const auto& [image, picture] : input.pictures) {
    hal::Picture drawn;
    drawn.width_px = picture.frame().width_px;
    drawn.height_px = picture.frame().height_px;
    drawn.rgb8 = preview_rgb(input, fit, picture);
    const std::string path = (fs::path(preview) / (fs::path(image).stem().string() + ".png")).string();
    TOUCHLINE_TRY(hal::write_picture(path, drawn));
  }
  return {};
}

}  // namespace touchline::calibrate
