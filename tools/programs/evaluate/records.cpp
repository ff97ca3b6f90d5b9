#include "tools/programs/evaluate/records.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

namespace touchline::evaluate {
namespace {

using nlohmann::json;

// Reads the values below one place of a JSON document. It keeps the first error and continues with default values.
class JsonReader {
 public:
  JsonReader(const json& value, std::string path, Result<void>& result)
      : value_(&value), path_(std::move(path)), result_(&result) {}

  [[nodiscard]] bool null() const { return value_->is_null(); }
  [[nodiscard]] bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  [[nodiscard]] JsonReader at(const char* key) const {
    static const json nothing;
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (!value_->is_object()) {
      complain(path_.empty() ? "the line is not an object" : path_ + " is not an object");
    } else if (!value_->contains(key)) {
      complain(path + " is missing");
    } else {
      return {(*value_)[key], path, *result_};
    }
    return {nothing, path, *result_};
  }
  [[nodiscard]] std::vector<JsonReader> list(const char* key) const {
    const JsonReader node = at(key);
    std::vector<JsonReader> nodes;
    if (!node.value_->is_array()) {
      node.complain(node.path_ + " is not a list");
      return nodes;
    }
    for (const json& entry : *node.value_) {
      nodes.push_back({entry, node.path_ + "[" + std::to_string(nodes.size()) + "]", *result_});
    }
    return nodes;
  }
  [[nodiscard]] double number(const char* key) const { return at(key).as_number(); }
  [[nodiscard]] std::optional<double> number_or_null(const char* key) const {
    const JsonReader node = at(key);
    return node.null() ? std::nullopt : std::optional(node.as_number());
  }
  [[nodiscard]] std::int64_t integer(const char* key) const {
    const JsonReader node = at(key);
    if (node.value_->is_number_integer()) return node.value_->get<std::int64_t>();
    node.complain(node.path_ + " is not an integer");
    return 0;
  }
  [[nodiscard]] std::string text(const char* key) const {
    const JsonReader node = at(key);
    if (node.value_->is_string()) return node.value_->get<std::string>();
    node.complain(node.path_ + " is not a text");
    return {};
  }
  [[nodiscard]] Vector2 pair(const char* key) const {
    const std::vector<JsonReader> entries = list(key);
    if (entries.size() == 2) return {entries[0].as_number(), entries[1].as_number()};
    at(key).complain(at(key).path_ + " is not a pair of numbers");
    return {};
  }
  /// Returns nullopt if there is no such key.
  [[nodiscard]] std::optional<double> probability(const char* key) const {
    if (!has(key)) return std::nullopt;
    const double value = number(key);
    if (!(value >= 0.0 && value <= 1.0)) at(key).complain(at(key).path_ + " is not within 0 to 1");
    return value;
  }
  void complain(const std::string& what) const {
    if (result_->ok()) *result_ = failure(ErrorCode::kInconsistent, "%s", what.c_str());
  }

 private:
  [[nodiscard]] double as_number() const {
    if (value_->is_number()) return value_->get<double>();
    complain(path_ + " is not a number");
    return 0.0;
  }
  const json* value_;
  std::string path_;
  Result<void>* result_;
};

const std::string& renamed(const NameMap& names, const std::string& name) {
  const auto found = names.find(name);
  return found == names.end() ? name : found->second;
}

Result<std::ifstream> open_file(const std::string& path) {
  errno = 0;
  std::error_code ignored;
  std::ifstream file(path);
  if (file && !std::filesystem::is_directory(path, ignored)) return file;
  return failure(ErrorCode::kIo, "%s: %s", path.c_str(), std::strerror(errno != 0 ? errno : EISDIR));
}

Result<std::vector<FrameRecord>> read_lines(const std::string& path,
                                            const std::function<FrameRecord(const JsonReader&)>& read) {
  TOUCHLINE_TRY_ASSIGN(std::ifstream file, open_file(path));
  std::vector<FrameRecord> records;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const json value = json::parse(line, nullptr, false);
    Result<void> result;
    if (value.is_discarded()) {
      result = failure(ErrorCode::kInconsistent, "is not JSON");
    } else {
      records.push_back(read(JsonReader(value, "", result)));
    }
    if (!result.ok()) return prefixed(path + ":" + std::to_string(number), std::move(result).error());
  }
  if (records.empty()) return failure(ErrorCode::kInconsistent, "%s: contains no frames", path.c_str());
  return records;
}

std::optional<BallRecord> ball_of(const JsonReader& node, bool with_pixels) {
  if (node.null()) return std::nullopt;
  BallRecord ball;
  ball.position_m = {node.number("x"), node.number("y")};
  if (with_pixels) ball.center_px = Vector2{node.number("u"), node.number("v")};
  ball.confidence = node.probability("confidence");
  return ball;
}

SceneRecord scene_of(const JsonReader& node, bool is_result, bool with_pixels, const NameMap& names) {
  SceneRecord scene;
  scene.ball = ball_of(node.at("ball"), with_pixels);
  for (const JsonReader& entry : node.list("robots")) {
    RobotRecord robot;
    robot.team = renamed(names, entry.text("team"));
    if (!entry.at("id").null()) robot.id = static_cast<int>(entry.integer("id"));
    robot.position_m = {entry.number("x"), entry.number("y")};
    robot.theta_rad = entry.number_or_null("theta");
    robot.confidence = entry.probability("confidence");
    if (is_result && with_pixels) {
      for (const JsonReader& patch : entry.list("patches")) {
        robot.patches.push_back({patch.text("role") == "identification",
                                 renamed(names, patch.text("color")),
                                 {patch.number("u"), patch.number("v")}});
      }
    }
    scene.robots.push_back(std::move(robot));
  }
  return scene;
}

}  // namespace

Result<std::vector<FrameRecord>> read_truth(const std::string& path) {
  const auto read = [](const JsonReader& line) {
    FrameRecord record;
    // Pictures are identified by their file, and frames of a video by their number.
    if (line.has("file") || !line.has("frame")) record.file = line.text("file");
    if (line.has("frame")) record.frame = line.integer("frame");
    if (line.has("t")) record.t_s = line.number("t");
    record.sightings = record.tracks = scene_of(line, false, false, {});
    return record;
  };
  return read_lines(path, read);
}

Result<std::vector<FrameRecord>> read_result(const std::string& path, const NameMap& names) {
  const auto read = [&names](const JsonReader& line) {
    FrameRecord record;
    record.file = line.text("file");
    record.frame = line.integer("frame");
    record.t_s = line.number("t");
    record.sightings = scene_of(line.at("sightings"), true, true, names);
    record.tracks = scene_of(line.at("tracks"), true, false, names);
    return record;
  };
  return read_lines(path, read);
}

Result<bool> is_result(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(std::ifstream file, open_file(path));
  std::string line;
  std::getline(file, line);
  const json value = json::parse(line, nullptr, false);
  return value.is_object() && value.contains("sightings");
}

Result<AnnotatedPicture> read_annotated(const std::string& path) {
  TOUCHLINE_TRY_ASSIGN(std::ifstream file, open_file(path));
  const json value = json::parse(file, nullptr, false);
  if (value.is_discarded()) return failure(ErrorCode::kInconsistent, "%s: is not JSON", path.c_str());
  Result<void> result;
  const JsonReader root(value, "", result);
  AnnotatedPicture out;
  out.name = std::filesystem::path(path).stem().string();
  // such as "../folder/picture.png" or "../video.mp4 frame 270"
  std::string image = root.text("image");
  const std::string mark = " frame ";
  if (const std::size_t place = image.find(mark); place != std::string::npos) {
    const std::string digits = image.substr(place + mark.size());
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) {
      root.complain("image has no frame number after \"frame\"");
    } else {
      out.frame = std::stoll(digits);
    }
    image.resize(place);
  }
  out.file = std::filesystem::path(image).filename().string();
  for (const JsonReader& object : root.list("objects")) {
    const std::string type = object.text("type");
    if (type == "ball") {
      out.balls_px.push_back(object.pair("centre"));
    } else if (type == "robot") {
      AnnotatedPicture::Robot robot;
      robot.team = object.text("team");
      if (object.has("team_patch") && !object.at("team_patch").null()) robot.team_px = object.pair("team_patch");
      if (object.has("id_patches") && !object.at("id_patches").null()) {
        for (const JsonReader& patch : object.list("id_patches")) {
          robot.identification.push_back({true, patch.text("colour"), patch.pair("centre")});
        }
      }
      out.robots.push_back(std::move(robot));
    } else {
      object.complain("type \"" + type + "\" is neither ball nor robot");
    }
  }
  if (!result.ok()) return prefixed(path, std::move(result).error());
  return out;
}

}  // namespace touchline::evaluate
