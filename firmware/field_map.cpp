#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/status_text.h"

namespace touchline {
namespace {

// Ratio of height to width of a character cell in a terminal.
constexpr double kCellAspect = 2.0;
constexpr int kMaxRows = 40;

enum class Paint : std::uint8_t { kNone, kLine, kOwn, kOpponent, kBall };
constexpr std::array<const char*, 5> kAnsi{"", "\x1b[2m", "\x1b[1;36m", "\x1b[1;31m", "\x1b[1;33m"};

struct Cell {
  char letter = ' ';
  Paint paint = Paint::kNone;
};

// Holds the characters inside a border: columns run along x, rows along -y.
class Canvas {
 public:
  Canvas(const FieldParameters& field, int columns) : field_(field), columns_(std::max(columns, 12)) {
    const double cell_m = static_cast<double>(field.length_m) / (columns_ - 2);
    const double rows = static_cast<double>(field.width_m) / (cell_m * kCellAspect);
    rows_ = std::clamp(static_cast<int>(std::lround(rows)), 3, kMaxRows) + 2;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    draw_lines();
  }

  void put(FieldPoint point, int right, int down, char letter, Paint paint) {
    const double x = static_cast<double>(point.x_m) / static_cast<double>(field_.length_m) + 0.5;
    const double y = 0.5 - static_cast<double>(point.y_m) / static_cast<double>(field_.width_m);
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    const double column = std::floor(x * (columns_ - 2)) + 1 + right, row = std::floor(y * (rows_ - 2)) + 1 + down;
    at(static_cast<int>(std::clamp(column, 0.0, columns_ - 1.0)),
       static_cast<int>(std::clamp(row, 0.0, rows_ - 1.0))) = {letter, paint};
  }

  [[nodiscard]] std::string text(bool color) const {
    std::string out;
    for (int row = 0; row < rows_; ++row) {
      Paint paint = Paint::kNone;
      for (int column = 0; column < columns_; ++column) {
        const Cell& cell = cells_[index(column, row)];
        if (color && cell.paint != paint) {
          if (paint != Paint::kNone) out += "\x1b[0m";
          out += kAnsi[static_cast<std::size_t>(cell.paint)];
          paint = cell.paint;
        }
        out += cell.letter;
      }
      if (color && paint != Paint::kNone) out += "\x1b[0m";
      out += '\n';
    }
    return out;
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  Cell& at(int column, int row) { return cells_[index(column, row)]; }

  void draw_lines() {
    const double goal = static_cast<double>(field_.goal_width_m) / static_cast<double>(field_.width_m);
    for (int row = 0; row < rows_; ++row) {
      const bool in_goal = std::abs((row + 0.5) / rows_ - 0.5) * 2.0 < goal;
      at(columns_ / 2, row) = {'.', Paint::kLine};
      at(0, row) = at(columns_ - 1, row) = {in_goal ? ' ' : '|', Paint::kLine};
    }
    for (int column = 0; column < columns_; ++column) {
      const char letter = column == 0 || column == columns_ - 1 ? '+' : '-';
      at(column, 0) = at(column, rows_ - 1) = {letter, Paint::kLine};
    }
  }

  FieldParameters field_;
  int columns_, rows_ = 0;
  std::vector<Cell> cells_;
};

// Marks the heading in the neighboring cell to which the robot points.
void put_heading(Canvas& canvas, const SeenRobot& robot, Paint paint) {
  struct Direction {
    int right, down;
    char letter;
  };
  // Directions in steps of 45 degrees, counter-clockwise from x.
  static constexpr std::array<Direction, 8> kDirections{
      {{1, 0, '-'}, {1, -1, '/'}, {0, -1, '|'}, {-1, -1, '\\'}, {-1, 0, '-'}, {-1, 1, '/'}, {0, 1, '|'}, {1, 1, '\\'}}};
  const double eighths = static_cast<double>(robot.pose.theta_rad) / (std::numbers::pi / 4.0);
  if (!std::isfinite(eighths)) return;
  const auto& direction = kDirections[static_cast<std::size_t>(std::lround(eighths) & 7)];
  canvas.put(robot.pose.position, direction.right, direction.down, direction.letter, paint);
}

}  // namespace

std::string field_map(const StatusReport& status, const FieldParameters& field, int columns, bool color) {
  Canvas canvas(field, columns);
  for (const SeenRobot& robot : status.robots) {
    if (robot.team == Team::kOwn) put_heading(canvas, robot, Paint::kOwn);
  }
  for (const SeenRobot& robot : status.robots) {
    const bool own = robot.team == Team::kOwn;
    const char digit = robot.id >= 0 ? static_cast<char>('0' + robot.id % 10) : '?';
    canvas.put(robot.pose.position, 0, 0, own ? digit : 'x', own ? Paint::kOwn : Paint::kOpponent);
  }
  if (status.ball_seen) canvas.put(status.ball, 0, 0, 'o', Paint::kBall);
  return canvas.text(color);
}

}  // namespace touchline
