// The rule of inclusion holds, and the check of it is alive: each kind of breach, planted, is found.
#include <gtest/gtest.h>

#include "tests/checks/inclusion_rule.h"

namespace touchline::checks {
namespace {

TEST(InclusionRule, HoldsInTheWholeRepository) {
  const Findings findings = check_inclusion(read_sources(TOUCHLINE_SOURCE_DIR));
  for (const Violation& violation : findings.violations) {
    ADD_FAILURE() << violation.file << ":" << violation.line << ": " << violation.reason;
  }
  // Looking at nothing finds nothing.
  EXPECT_GT(findings.files, 150U);
  EXPECT_GT(findings.includes, 500U);
}

std::string breach(const std::string& path, const std::string& line) {
  const Findings findings = check_inclusion({{path, "#pragma once\n" + line + "\n"}});
  EXPECT_EQ(findings.includes, 1U) << line;
  if (findings.violations.empty()) return "";
  EXPECT_EQ(findings.violations[0].line, 2U);
  return findings.violations[0].reason;
}

TEST(InclusionRule, FindsBreachesBetweenFolders) {
  EXPECT_EQ(breach("core/color/x.h", "#include \"hal/camera.h\""), "core may not include hal");
  EXPECT_EQ(breach("core/types.h", "#include \"firmware/loop.h\""), "core may not include firmware");
  EXPECT_EQ(breach("hal/mock/x.cpp", "#include \"firmware/loop.h\""), "hal may not include firmware");
  EXPECT_EQ(breach("hal/camera.h", "  #  include \"hal/mock/arena.h\""), "hal/ may not include hal/mock");
  EXPECT_EQ(breach("hal/mock/x.h", "#include \"hal/linux/x.h\""), "hal/mock/ may not include hal/linux");
  EXPECT_EQ(breach("firmware/x.h", "#include \"tools/programs/latency/x.h\""), "firmware may not include tools");
  EXPECT_EQ(breach("tools/x.h", "#include \"tests/checks/x.h\""), "tools may not include tests");
  EXPECT_EQ(breach("firmware/x.h", "#include \"x.h\""), "\"x.h\" must be written from the repository's root");
}

TEST(InclusionRule, FindsStagesThatLookAhead) {
  EXPECT_EQ(breach("core/color/x.h", "#include \"core/region/x.h\""), "color comes before region");
  EXPECT_EQ(breach("core/track/x.h", "#include \"core/control/x.h\""), "track comes before control");
  EXPECT_EQ(breach("core/geometry/x.h", "#include \"core/marker/x.h\""), "geometry comes before marker");
  EXPECT_EQ(breach("core/light/x.h", "#include \"core/geometry/x.h\""), "light may not include geometry");
  EXPECT_EQ(breach("core/types.h", "#include \"core/color/x.h\""),
            "the values between stages know no stage, not color");
  EXPECT_EQ(breach("core/track/x.h", "#include \"core/helper/x.h\""), "core/helper is no stage");
  EXPECT_EQ(breach("core/radio/x.h", "#include \"core/pipeline.h\""), "only what drives the pipeline may include it");
  EXPECT_EQ(breach("core/adaptation.h", "#include \"core/pipeline.h\""),
            "only what drives the pipeline may include it");
}

TEST(InclusionRule, FindsWhatTheCoreMayNotUse) {
  EXPECT_EQ(breach("core/color/x.h", "#include <vector>"), "the core may not use <vector>");
  EXPECT_EQ(breach("core/x.cpp", "#include <sys/mman.h>"), "the core may not use <sys/mman.h>");
  EXPECT_EQ(breach("core/x.cpp", "#include<iostream>"), "the core may not use <iostream>");
}

TEST(InclusionRule, LetsThroughWhatIsMeantToBe) {
  EXPECT_EQ(breach("core/marker/x.h", "#include \"core/region/x.h\""), "");
  EXPECT_EQ(breach("core/marker/x.h", "#include \"core/geometry/x.h\""), "");
  EXPECT_EQ(breach("core/pipeline.h", "#include \"core/radio/x.h\""), "");
  EXPECT_EQ(breach("core/adaptation.cpp", "#include \"core/color/x.h\""), "");
  EXPECT_EQ(breach("core/track/x.h", "#include <Eigen/Core>"), "");
  EXPECT_EQ(breach("hal/linux/x.h", "#include <linux/videodev2.h>"), "");
  EXPECT_EQ(breach("tests/x.h", "#include \"tools/programs/latency/x.h\""), "");
}

}  // namespace
}  // namespace touchline::checks
