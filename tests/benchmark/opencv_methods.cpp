#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/benchmark/benchmark_case.h"
#include "tests/region/region_comparison.h"

// Solves the same task with OpenCV, in the two ways that a user would choose.
namespace touchline::testing {
namespace {

cv::Mat view_of(const Frame& frame) {
  // the cast is safe, because OpenCV only reads
  return {frame.height_px, frame.width_px, CV_8UC3, const_cast<std::uint8_t*>(frame.plane[0]), frame.stride_bytes[0]};
}

// First way: for each color inRange, then the connected components with area, box and centroid.
struct PerColor {
  ColorBoxes boxes;
  cv::Mat mask{}, labels{}, stats{}, centroids{};
  std::size_t regions = 0, area = 0;

  void scan(const Frame& frame) {
    const cv::Mat picture = view_of(frame);
    regions = area = 0;
    for (const ColorBox& box : boxes) {
      cv::inRange(picture, cv::Scalar(box.low[0], box.low[1], box.low[2]),
                  cv::Scalar(box.high[0], box.high[1], box.high[2]), mask);
      const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 4);
      for (int i = 1; i < count; ++i) area += static_cast<std::size_t>(stats.at<int>(i, cv::CC_STAT_AREA));
      regions += static_cast<std::size_t>(count - 1);
    }
  }
};

// Second way: the paper's three tables, then one labeling of all colored pixels. In it, regions of different colors
// that touch become one.
struct Tables {
  explicit Tables(const ColorBoxes& boxes) : table(1, 256, CV_16UC3, cv::Scalar::all(0)) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (int channel = 0; channel < 3; ++channel) {
        const auto c = static_cast<std::size_t>(channel);
        for (int value = boxes[i].low[c]; value <= boxes[i].high[c]; ++value) {
          std::uint16_t& bits = table.at<cv::Vec3w>(0, value)[channel];
          bits = static_cast<std::uint16_t>(bits | 1u << i);
        }
      }
    }
  }

  void scan(const Frame& frame) {
    cv::LUT(view_of(frame), table, classes);
    cv::split(classes, channels);
    cv::bitwise_and(channels[0], channels[1], channels[0]);
    cv::bitwise_and(channels[0], channels[2], channels[0]);
    cv::compare(channels[0], 0, mask, cv::CMP_NE);
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 4);
    regions = static_cast<std::size_t>(count - 1);
    area = 0;
    for (int i = 1; i < count; ++i) area += static_cast<std::size_t>(stats.at<int>(i, cv::CC_STAT_AREA));
  }

  cv::Mat table, classes{}, mask{}, labels{}, stats{}, centroids{};
  std::array<cv::Mat, 3> channels{};
  std::size_t regions = 0, area = 0;
};

template <class Candidate>
Result<void> add(BenchmarkCase& benchmark, const char* name, std::shared_ptr<Candidate> candidate, std::size_t regions,
                 std::size_t area) {
  candidate->scan(benchmark.picture.frame());
  benchmark.methods.push_back({name, [&benchmark, candidate] { candidate->scan(benchmark.next_frame()); }, {}});
  if (candidate->regions == regions && candidate->area == area) return {};
  return failure(ErrorCode::kInconsistent, "%s finds %zu regions of %zu pixels instead of %zu of %zu", name,
                 candidate->regions, candidate->area, regions, area);
}

}  // namespace

Result<void> add_opencv(BenchmarkCase& benchmark, const ColorGrid& colors) {
  cv::setNumThreads(1);
  const auto area = static_cast<std::size_t>(
      std::count_if(colors.color.begin(), colors.color.end(), [](ColorId color) { return color != kBackground; }));
  ColorGrid joined = colors;
  for (ColorId& color : joined.color) color = std::min<ColorId>(color, 1);
  TOUCHLINE_TRY(add(benchmark, "OpenCV table", std::make_shared<Tables>(benchmark.parameters.boxes),
                    expected_regions(joined).size(), area));
  if (!benchmark.slow_methods) return {};
  return add(benchmark, "OpenCV inRange", std::make_shared<PerColor>(PerColor{benchmark.parameters.boxes}),
             expected_regions(colors).size(), area);
}

}  // namespace touchline::testing
