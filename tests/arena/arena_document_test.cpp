// docs/arena.md must list all scenes and faults.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hal/mock/arena_parameters.h"
#include "tools/programs/arena/scenes.h"

namespace touchline::arena {
namespace {

class ArenaDocument : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ostringstream all;
    all << std::ifstream(TOUCHLINE_DOCS "/arena.md").rdbuf();
    text_ = all.str();
    ASSERT_FALSE(text_.empty());
  }
  [[nodiscard]] bool has(const std::string& part) const { return text_.find(part) != std::string::npos; }

  std::string text_;
};

TEST_F(ArenaDocument, NamesEveryScene) {
  for (const SceneType& scene : scene_types()) {
    const std::string row = "| `" + std::string(scene.name) + "` | " + std::to_string(scene.pictures) + " |";
    EXPECT_TRUE(has(row)) << row;
  }
}

TEST_F(ArenaDocument, NamesEveryFault) {
  for (const auto& fault : hal::mock::kFaultKinds) EXPECT_TRUE(has("`" + std::string(fault.word) + "`")) << fault.word;
}

}  // namespace
}  // namespace touchline::arena
