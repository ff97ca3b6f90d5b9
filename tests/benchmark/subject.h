#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/region/region_scanner.h"
#include "tests/color/owned_picture.h"
#include "tests/region/literal_labeling.h"

namespace touchline::testing {

/// One way to do the work, as often as it is called.
struct Method {
  std::string name;  // read, a kernel's word, paper, ...
  std::function<void()> work;
  std::vector<float> times_us;  // of CPU
};

/// One row of the table: a picture and what is measured on it.
struct Subject {
  std::string name;
  OwnedPicture picture;
  ScanParameters parameters;
  ColorGrid colors{};                  // what the parameters make of the picture; empty: not known yet
  std::vector<OwnedPicture> copies{};  // to be taken in turn, so that none is in a cache; may be empty
  bool all_peers = false;              // the slow ones as well
  std::size_t turn = 0;
  std::vector<Method> methods{};
  std::string found{};  // what the scan finds

  Frame next_frame();
};

// Names of pictures that are there twice, once without regions of one pixel, end with it.
inline constexpr char kSpecksLeftOut[] = ", specks left out";

/// The pictures whose names contain `part`.
std::vector<std::unique_ptr<Subject>> make_subjects(std::string_view part);
/// A picture of 640 x 480 with pixels of five colors, to be told apart from eight more classes that none has.
Subject crowded_subject(const ColorGrid& grid, std::uint32_t min_area_px);

/// Every byte of the picture is read, 128 at a time where the processor can.
std::uint64_t read_frame(const Frame& frame);

/// Gives the subject its methods, each of which has been checked: empty, or what was wrong.
std::string add_methods(Subject& subject);

/// OpenCV's: none where it was not found when this was built. Empty, or what was wrong.
std::string add_opencv(Subject& subject, const ColorGrid& colors);

}  // namespace touchline::testing
