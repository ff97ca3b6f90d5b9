#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/programs/calibrate/field_report.h"
#include "tools/programs/calibrate/venue_draft.h"

namespace CLI {
class App;
}

namespace touchline::calibrate {

struct ColorFitInput;
struct VenueDraft;

/// Each command reads its options from CLI11, does its work, prints its report to standard output and what is wrong to
/// standard error. Exit code 0: the venue file was written; 1: it was refused, and the file is as it was.
struct FieldCommand {
  std::string venue, preset, drawing, kind = "full", preview, report;
  std::vector<std::string> pictures;
  bool refine = true;
  std::vector<std::string> corners, points, region;
  double length_m = 0, width_m = 0, camera_height_m = 0;
  void add_options(CLI::App& app);
  int run() const;

 private:
  bool choose_drawing(const VenueDraft& draft, FieldDrawing& out, std::optional<HeightPrior>& height,
                      std::string& reason) const;
  bool find_camera(const std::vector<hal::Picture>& photographs, const FieldDrawing& drawn,
                   const std::optional<HeightPrior>& height, FieldFitInput& input, FieldReport& found,
                   std::string& reason) const;
  bool write_previews(const hal::Picture& photograph, const FieldReport& found, const FieldParameters& field,
                      const std::vector<FloorPoint>& given, std::string& reason) const;
};

/// Takes pictures with the board's camera instead of writing a venue file; no robot is driven.
struct PictureCommand {
  std::string board, out;
  std::vector<std::string> overrides;
  unsigned count = 1;
  double every_s = 1.0, after_s = 1.0;
  void add_options(CLI::App& app);
  int run() const;
};

struct LightCommand {
  std::vector<std::string> pictures;
  std::string venue, surface;
  bool keep_normal = false;
  void add_options(CLI::App& app);
  int run() const;
};

struct ColorsCommand {
  std::string samples, venue, team, images, format = "rgb24", preview;
  std::vector<std::string> pictures;
  bool yes = false;
  int patch_radius_px = 24;
  void add_options(CLI::App& app);
  int run() const;

 private:
  [[nodiscard]] std::string preview_folder() const;
  bool read_input(ColorFitInput& input, std::string& reason) const;
  bool find_without_clicks(const VenueDraft& draft, ColorFitInput& input, std::string& reason) const;
};

/// "1.5,-2" -> {1.5, -2}; none unless there are exactly `count` finite numbers.
std::optional<std::vector<double>> numbers_of(const std::string& text, std::size_t count);

/// Prints "touchline-calibrate: MESSAGE" to standard error. Returns 1.
int refuse(const std::string& message);

}  // namespace touchline::calibrate
