// The include rules hold, and the check finds each kind of planted violation.
#include <gtest/gtest.h>

#include "tests/checks/inclusion_rule.h"

namespace touchline::checks {
namespace {

TEST(InclusionRule, HoldsInTheWholeRepository) {
  const Findings findings = check_inclusion(read_sources(TOUCHLINE_SOURCE_DIR));
  for (const Violation& violation : findings.violations) {
    ADD_FAILURE() << violation.file << ":" << violation.line << ": " << violation.reason;
  }
  // Guards against passing because no files were read.
  EXPECT_GT(findings.files, 150U);
  EXPECT_GT(findings.includes, 500U);
}

TEST(InclusionRule, ReadsTheRobotsHeaderAndSketches) {
  std::size_t headers = 0, sketches = 0;
  for (const SourceFile& file : read_sources(TOUCHLINE_SOURCE_DIR)) {
    headers += file.path == "tools/robot/touchline_robot.h" ? 1U : 0U;
    sketches += file.path.ends_with(".ino") ? 1U : 0U;
  }
  EXPECT_EQ(headers, 1U);
  EXPECT_GE(sketches, 4U);
}

std::string violation_of(const std::string& path, const std::string& line) {
  const Findings findings = check_inclusion({{path, "#pragma once\n" + line + "\n"}});
  EXPECT_EQ(findings.includes, 1U) << line;
  if (findings.violations.empty()) return "";
  EXPECT_EQ(findings.violations[0].line, 2U);
  return findings.violations[0].reason;
}

TEST(InclusionRule, FindsViolationsBetweenFolders) {
  EXPECT_EQ(violation_of("core/color/x.h", "#include \"hal/camera.h\""), "core may not include hal");
  EXPECT_EQ(violation_of("core/types.h", "#include \"firmware/loop.h\""), "core may not include firmware");
  EXPECT_EQ(violation_of("hal/mock/x.cpp", "#include \"firmware/loop.h\""), "hal may not include firmware");
  EXPECT_EQ(violation_of("hal/camera.h", "  #  include \"hal/mock/arena.h\""), "hal/ may not include hal/mock");
  EXPECT_EQ(violation_of("hal/mock/x.h", "#include \"hal/linux/x.h\""), "hal/mock/ may not include hal/linux");
  EXPECT_EQ(violation_of("firmware/x.h", "#include \"tools/programs/latency/x.h\""), "firmware may not include tools");
  EXPECT_EQ(violation_of("tools/x.h", "#include \"tests/checks/x.h\""), "tools may not include tests");
  EXPECT_EQ(violation_of("firmware/x.h", "#include \"x.h\""), "\"x.h\" must be written from the repository's root");
}

TEST(InclusionRule, FindsIncludesOfLaterStages) {
  EXPECT_EQ(violation_of("core/color/x.h", "#include \"core/region/x.h\""), "color comes before region");
  EXPECT_EQ(violation_of("core/track/x.h", "#include \"core/control/x.h\""), "track comes before control");
  EXPECT_EQ(violation_of("core/marker/x.h", "#include \"core/subpixel/x.h\""), "marker comes before subpixel");
  EXPECT_EQ(violation_of("core/geometry/x.h", "#include \"core/marker/x.h\""), "geometry comes before marker");
  EXPECT_EQ(violation_of("core/types.h", "#include \"core/color/x.h\""),
            "core/*.h are used by all stages and may not include core/color");
  EXPECT_EQ(violation_of("core/track/x.h", "#include \"core/helper/x.h\""), "core/helper is not in the list of stages");
  EXPECT_EQ(violation_of("core/helper/x.h", "#include \"core/track/x.h\""), "core/helper is not in the list of stages");
  EXPECT_EQ(violation_of("core/radio/x.h", "#include \"core/pipeline.h\""), "no stage may include the pipeline");
  EXPECT_EQ(violation_of("core/radio/x.h", "#include \"core/step_inputs.h\""), "no stage may include the pipeline");
  EXPECT_EQ(violation_of("core/adaptation.h", "#include \"core/pipeline.h\""), "no stage may include the pipeline");
}

TEST(InclusionRule, FindsIncludesOfEarlierStagesThatAStageDoesNotNeed) {
  EXPECT_EQ(violation_of("core/control/x.h", "#include \"core/marker/matcher.h\""), "control may not include marker");
  EXPECT_EQ(violation_of("core/control/x.h", "#include \"core/track/tracker.h\""), "control may not include track");
  EXPECT_EQ(violation_of("core/track/x.h", "#include \"core/marker/x.h\""), "track may not include marker");
  EXPECT_EQ(violation_of("core/geometry/x.h", "#include \"core/light/x.h\""), "geometry may not include light");
}

TEST(InclusionRule, FindsHeadersThatTheCoreMayNotUse) {
  EXPECT_EQ(violation_of("core/color/x.h", "#include <vector>"), "the core may not use <vector>");
  EXPECT_EQ(violation_of("core/x.cpp", "#include <sys/mman.h>"), "the core may not use <sys/mman.h>");
  EXPECT_EQ(violation_of("core/x.cpp", "#include<iostream>"), "the core may not use <iostream>");
}

TEST(InclusionRule, FindsWhatARobotDoesNotHave) {
  const std::string copied = "tools/robot is copied to robots and may not include files of Touchline";
  EXPECT_EQ(violation_of("tools/robot/x.h", "#include \"core/radio/packet.h\""), copied);
  EXPECT_EQ(violation_of("tools/robot/examples/x/x.ino", "#include \"tools/robot/touchline_robot.h\""), copied);
  const std::string standard = "the robots' header may use only <stdint.h>, because AVR has no C++ library";
  EXPECT_EQ(violation_of("tools/robot/x.h", "#include <cstdint>"), standard);
  EXPECT_EQ(violation_of("tools/robot/x.h", "#include <Arduino.h>"), standard);
  EXPECT_EQ(violation_of("tools/robot/x.h", "#include <stdint.h>"), "");
  EXPECT_EQ(violation_of("tools/robot/examples/x/x.ino", "#include <Arduino.h>"), "");
  EXPECT_EQ(violation_of("core/x.h", "#include \"tools/robot/touchline_robot.h\""), "core may not include tools");
}

TEST(InclusionRule, AcceptsAllowedIncludes) {
  EXPECT_EQ(violation_of("core/marker/x.h", "#include \"core/region/x.h\""), "");
  EXPECT_EQ(violation_of("core/marker/x.h", "#include \"core/geometry/x.h\""), "");
  EXPECT_EQ(violation_of("core/control/x.h", "#include \"core/geometry/field_area.h\""), "");
  EXPECT_EQ(violation_of("core/pipeline.h", "#include \"core/radio/x.h\""), "");
  EXPECT_EQ(violation_of("core/step_inputs.h", "#include \"core/control/x.h\""), "");
  EXPECT_EQ(violation_of("core/adaptation.cpp", "#include \"core/color/x.h\""), "");
  EXPECT_EQ(violation_of("core/track/x.h", "#include <Eigen/Core>"), "");
  EXPECT_EQ(violation_of("hal/linux/x.h", "#include <linux/videodev2.h>"), "");
  EXPECT_EQ(violation_of("tests/x.h", "#include \"tools/programs/latency/x.h\""), "");
}

}  // namespace
}  // namespace touchline::checks
